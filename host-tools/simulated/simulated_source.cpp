/* SPDX-License-Identifier: Apache-2.0 */
#include "simulated_source.hpp"

#include <cmath>

#include "world_frame.hpp"

namespace opms_host {

namespace {

constexpr std::uint32_t BUFFERS_MIN = 2, BUFFERS_MAX = 1024;

}  // namespace

SimulatedSource::~SimulatedSource()
{
    stop();
}

SourceTraits SimulatedSource::traits() const
{
    SourceTraits traits;
    traits.name = "simulated";
    traits.model = "OPMS simulated camera, seed " + std::to_string(core_->options().seed);
    traits.width_px = core_->pictures().width_px();
    traits.height_px = core_->pictures().height_px();
    traits.profile = world_camera_profile(core_->options());
    traits.can_trigger = true;
    traits.exposure_min_us = EXPOSURE_MIN_US;
    traits.exposure_max_us = EXPOSURE_MAX_US;
    traits.gain_max_db = GAIN_MAX_DB;
    return traits;
}

bool SimulatedSource::start(const SourceStart &start, std::string &error)
{
    if (start.buffers < BUFFERS_MIN || start.buffers > BUFFERS_MAX) {
        error = "a source needs 2 to 1024 buffers";
        return false;
    }
    if (!start.hardware_trigger && !(start.frame_rate_hz > 0 && start.frame_rate_hz <= 1000)) {
        error = "the frame rate must be above 0 and at most 1000 Hz";
        return false;
    }
    return core_->now([&](WorldCore &world) {
        if (world.camera().is_streaming()) {
            error = "the simulated camera has been started already";
            return false;
        }
        delivered_ = damaged_ = 0;
        world.make_buffers(start.buffers);
        world.camera().start(start);
        world.join(Consumer::camera);
        return true;
    });
}

void SimulatedSource::stop()
{
    core_->now([](WorldCore &world) { world.camera().stop(); });
    core_->leave(Consumer::camera);
}

void SimulatedSource::wait(std::uint32_t timeout_ms, SourceItem &item)
{
    item = SourceItem();  // a frame in it goes back before the world is locked
    TrueFrame truth;
    std::shared_ptr<std::uint8_t> pixels;
    core_->wait_for(Consumer::camera, timeout_ms, [&] {
        WorldCamera &camera = core_->camera();
        if (camera.items().empty()) {
            return false;
        }
        const CameraItem taken = camera.take();
        item.kind = taken.kind;
        item.t_host_ns = taken.t_host_ns;
        item.text = taken.text;
        if (taken.kind == SourceItemKind::frame) {
            truth = taken.frame;
            pixels = core_->buffers()->lend();
            ++delivered_;
            damaged_ += truth.is_damaged ? 1 : 0;
        }
        return true;
    });
    if (item.kind == SourceItemKind::frame) {
        item.frame =
            world_frame(core_->pictures(), core_->options(), truth, std::move(pixels));
    }
}

void SimulatedSource::wake()
{
    core_->wake(Consumer::camera);
}

bool SimulatedSource::set_exposure(double exposure_us, double gain_db, std::string &error)
{
    if (!(exposure_us > 0) || !std::isfinite(exposure_us) || !std::isfinite(gain_db)) {
        error = "exposure and gain must be numbers, and the exposure above 0";
        return false;
    }
    core_->now([&](WorldCore &world) { world.camera().set_exposure(exposure_us, gain_db); });
    return true;
}

SourceCounters SimulatedSource::counters() const
{
    return core_->now([&](WorldCore &world) {
        SourceCounters counters;
        counters.delivered = delivered_;
        counters.damaged = damaged_;
        counters.no_buffer = world.no_buffer();
        if (world.buffers()) {
            counters.lent = world.buffers()->lent();
            counters.buffers = world.buffers()->count();
        }
        return counters;
    });
}

}  // namespace opms_host
