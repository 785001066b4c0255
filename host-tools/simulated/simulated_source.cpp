/* SPDX-License-Identifier: Apache-2.0 */
#include "simulated_source.hpp"

#include <cmath>

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
    traits.profile =
        core_->now([](WorldCore &world) { return world.camera().profile(); });
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
        item.frame = make_frame(truth, std::move(pixels));
    }
}

FramePtr SimulatedSource::make_frame(const TrueFrame &truth,
                                     std::shared_ptr<std::uint8_t> pixels) const
{
    const WorldOptions &options = core_->options();
    PictureExposure exposure;
    exposure.index = truth.picture;
    exposure.is_hidden = truth.is_hidden;
    exposure.is_damaged = truth.is_damaged;
    const double amplified = std::pow(10, truth.gain_db / 20);
    exposure.factor = truth.light * amplified * truth.exposure_us / options.exposure_us *
                      std::pow(10, -options.gain_db / 20);
    exposure.noise = options.noise * amplified;
    exposure.seed = options.seed + truth.exposure_number;
    core_->pictures().expose(exposure, pixels.get());

    auto frame = std::make_shared<Frame>();
    frame->image = {pixels.get(), core_->pictures().width_px(), core_->pictures().height_px(),
                    core_->pictures().width_px(), OPMS_PIXEL_GREY8, 0};
    frame->frame_id = truth.frame_id;
    frame->camera_time_ticks = truth.camera_time_ticks;
    frame->arrival_host_ns = truth.arrival_host_ns;
    frame->flags = 0;
    if (truth.is_damaged) {
        frame->flags |= OPMS_FRAME_DAMAGED;
    }
    if (!options.camera_time) {
        frame->flags |= OPMS_FRAME_NO_TIME;
    }
    frame->exposure_us = truth.exposure_us;
    frame->gain_db = truth.gain_db;
    frame->memory = std::move(pixels);
    return frame;
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
