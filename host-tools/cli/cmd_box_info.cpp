/* SPDX-License-Identifier: Apache-2.0 */
/* opms box info: what a box is, and how it is. */
#include <chrono>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "box_device.hpp"
#include "box_json.hpp"
#include "cmd_box.hpp"
#include "commands.hpp"
#include "result_stream.hpp"

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds STATUS_PATIENCE(3000); /* it comes once a second */

struct InfoArguments {
    std::string box = "hid";
    bool json = false;
};

bool wait_status(const BoxDevice &device, opms_status_report_t &status)
{
    const Clock::time_point deadline = Clock::now() + STATUS_PATIENCE;
    opms_box_item_t item = {};
    while (Clock::now() < deadline &&
           opms_box_poll(device.get(), 100, &item, nullptr) == OPMS_OK) {
        if (item.kind == OPMS_ITEM_STATUS) {
            status = item.as.status;
            return true;
        }
    }
    return false;
}

bool write_text(const opms_identity_report_t &identity, const opms_status_report_t &status,
                const opms_settings_report_t &settings)
{
    ResultStream out;
    const auto line = [&](const char *name, const std::string &text) {
        out.write_line(box_text("%-10s", name) + text);
    };
    line("box", box_id_text(identity) + box_text(", hardware %u", identity.hardware_version));
    line("firmware", box_firmware_text(identity) +
                         box_text(", protocol %d", OPMS_WIRE_PROTOCOL));
    line("state", std::string(opms_box_state_name(status.state)) +
                      box_text(", up for %.1f s since %s",
                               static_cast<double>(status.uptime_us) / 1e6,
                               box_reset_text(status.reset_cause)));
    line("session", box_text("%u, last pulse %u", status.session_id, status.trigger_number));
    line("counted", box_text("%u glitches, %u starts refused, %u strobes missing, %u pulses "
                             "dropped, %u requests refused, %u endpoints healed",
                             status.glitches, status.starts_refused, status.strobes_missing,
                             status.dropped, status.commands_refused, status.reenumerations));
    line("settings", box_text("period %.3f ms, width %u us, debounce %.3f us, preamble ",
                              settings.settings.period_us / 1e3, settings.settings.width_us,
                              box_debounce_us(settings.settings)) +
                         box_preamble_text(settings.settings) +
                         (settings.stored ? "" : " (defaults: none are in flash)"));
    return !out.failed();
}

bool write_json(const opms_identity_report_t &identity, const opms_status_report_t &status,
                const opms_settings_report_t &settings)
{
    ResultStream out;
    const BoxJson row = {{"schema", "opms.box.info/1"},
                         {"identity", box_identity_json(identity)},
                         {"status", box_status_json(status)},
                         {"settings", box_settings_json(settings.settings)},
                         {"settings_stored", settings.stored}};
    return out.write_line(row.dump());
}

int info(const InfoArguments &arguments)
{
    int exit_code = EXIT_CODE_OK;
    const auto device = BoxDevice::open(arguments.box, 0, exit_code);
    if (!device) {
        return exit_code;
    }
    opms_error_t error = {};
    opms_settings_report_t settings = {};
    const opms_status_t got = opms_box_get_settings(device->get(), 0, &settings, &error);
    if (got != OPMS_OK) {
        box_talk(error.message);
        return box_exit_code(got);
    }
    opms_status_report_t status = {};
    if (!wait_status(*device, status)) {
        box_talk("the box sends no STATUS, which is due each second");
        return EXIT_CODE_DEVICE;
    }
    const bool written = arguments.json ? write_json(device->identity(), status, settings)
                                        : write_text(device->identity(), status, settings);
    return written ? EXIT_CODE_OK : EXIT_CODE_INPUT;
}

} // namespace

void add_box_info(CLI::App &box, int &exit_code)
{
    const auto arguments = std::make_shared<InfoArguments>();
    CLI::App *cmd = box.add_subcommand("info", "What is this box, and how is it?");
    add_box_option(*cmd, arguments->box);
    cmd->add_flag("--json", arguments->json, "One JSON object (schema opms.box.info/1)");
    cmd->callback([arguments, &exit_code] { exit_code = info(*arguments); });
}
