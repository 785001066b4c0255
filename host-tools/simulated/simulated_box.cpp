/* SPDX-License-Identifier: Apache-2.0 */
#include "simulated_box.hpp"

namespace opms_host {

namespace {

constexpr std::int64_t PRESS_NS = 20 * NS_PER_MS; /* of a finger on START */

}  // namespace

SimulatedBox::SimulatedBox(std::shared_ptr<WorldCore> core) : core_(std::move(core))
{
    core_->now([](WorldCore &world) {
        world.link().open();
        world.join(Consumer::box);
    });
}

SimulatedBox::~SimulatedBox()
{
    core_->leave(Consumer::box);
}

bool SimulatedBox::poll(uint32_t timeout_ms, opms_box_item_t &item)
{
    item = {};
    core_->wait_for(Consumer::box, timeout_ms, [&] {
        auto &items = core_->link().items();
        if (items.empty()) {
            return false;
        }
        item = items.front();
        items.pop_front();
        return true;
    });
    return true;
}

void SimulatedBox::wake()
{
    core_->wake(Consumer::box);
}

bool SimulatedBox::arm(uint32_t session_id, std::string &error)
{
    return core_->now([&](WorldCore &world) { return world.link().arm(session_id, error); });
}

bool SimulatedBox::disarm(std::string &error)
{
    return core_->now([&](WorldCore &world) { return world.link().disarm(error); });
}

bool SimulatedBox::settings(opms_settings_report_t &report, std::string &error)
{
    return core_->now([&](WorldCore &world) {
        if (!world.link().is_connected()) {
            error = "the simulated box is unplugged";
            return false;
        }
        report = world.box().settings_report();
        return true;
    });
}

bool SimulatedBox::set_settings(const opms_settings_t &settings, std::string &error)
{
    return core_->now([&](WorldCore &world) { return world.link().set_settings(settings, error); });
}

bool SimulatedBox::identity(opms_identity_report_t &identity) const
{
    return core_->now([&](WorldCore &world) {
        identity = world.link().identity();
        return world.link().is_connected();
    });
}

bool SimulatedBox::press_start(std::string &error)
{
    return core_->now([&](WorldCore &world) {
        if (!world.box().is_on()) {
            error = "the simulated box is switched off";
            return false;
        }
        world.box().start_edge(PRESS_NS);
        return true;
    });
}

}  // namespace opms_host
