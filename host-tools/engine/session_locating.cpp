/* SPDX-License-Identifier: Apache-2.0 */
/* The thread that locates. */
#include "session_impl.hpp"

#include <algorithm>

namespace opms_host {
namespace {

/** A display may hold a picture only while the camera has buffers to spare. */
bool has_spare_buffers(const SourceCounters &counters)
{
    if (counters.buffers == 0) {
        return true; /* a source that does not count them */
    }
    const std::uint32_t spare =
        counters.buffers > counters.lent ? counters.buffers - counters.lent : 0;
    return spare >= std::max(1U, counters.buffers / 4);
}

}  // namespace

void LiveSession::Impl::locating_loop()
{
    Work work;
    while (queue_.pop(work)) {
        locate(work);
        work = Work();
    }
}

void LiveSession::Impl::locate(const Work &work)
{
    if (work.number == 1) {
        locator_->forget();
    }
    auto pose = std::make_unique<PoseRecord>();
    pose->number = work.number;
    pose->arrival_host_ns = work.frame->arrival_host_ns;
    BarInPicture bar;
    check_size(work.frame->image);
    locator_->locate(*work.frame, *pose, bar);
    control_light(*work.frame, bar, *pose);
    tell_blur(*pose);
    pose->located_host_ns = devices_.clock->now_ns();
    show(work.frame, *pose);
    const Lock lock(mutex_);
    if (work.number != 0) {
        core_.take_located(std::move(pose));
    }
    changed_.notify_all();
}

/** A camera that came later, or was set otherwise, may not be the one that was calibrated. */
void LiveSession::Impl::check_size(const opms_image_t &image)
{
    if (options_.mode != SessionMode::position) {
        return;
    }
    const opms_lens_t &lens = options_.camera->lens;
    if (image.width_px != lens.width_px || image.height_px != lens.height_px) {
        const Lock lock(mutex_);
        core_.tell_often(Severity::error, "camera.wrong_size",
                         "pictures of " + std::to_string(image.width_px) + " x " +
                             std::to_string(image.height_px) +
                             " px do not fit the camera file: nothing is located");
    }
}

/** A control for the camera as it is now. */
void LiveSession::Impl::fit_light()
{
    const SourceTraits traits = devices_.source->traits();
    if (!options_.automatic_exposure || traits.exposure_max_us <= 0) {
        light_ = nullptr;
    } else if (light_) {
        light_->forget();
    } else {
        std::string error;
        const bool given = options_.exposure.struct_size != 0;
        light_ = LightLoop::create(given ? options_.exposure : light_options(traits), error);
        if (!light_) {
            const Lock lock(mutex_);
            core_.tell(Severity::error, "light.off", error);
        }
    }
}

/** Whether the camera says how long it exposed. Right after a change some do not. */
bool LiveSession::Impl::is_reported(const Frame &frame)
{
    constexpr std::uint32_t MANY = 30;
    if (frame.exposure_us > 0) {
        frames_not_reported_ = 0;
        return true;
    }
    if (++frames_not_reported_ == MANY) {
        const Lock lock(mutex_);
        core_.tell(Severity::warning, "light.not_reported",
                   "the camera does not report its exposure: it is not controlled");
    }
    return false;
}

void LiveSession::Impl::control_light(const Frame &frame, const BarInPicture &bar,
                                      PoseRecord &pose)
{
    if (camera_is_new_.exchange(false)) {
        fit_light();
    }
    if (!light_ || (frame.flags & OPMS_FRAME_DAMAGED)) {
        return;
    }
    if (!is_reported(frame)) {
        return;
    }
    const bool shall_set = light_->take(frame, bar.squares_expected, bar.speed_px_s, pose);
    tell_light(pose);
    if (!shall_set) {
        return;
    }
    const double exposure_us = pose.exposure.exposure_us, gain_db = pose.exposure.gain_db;
    std::string error;
    const bool is_set = devices_.source->set_exposure(exposure_us, gain_db, error);
    const Lock lock(mutex_);
    if (is_set) {
        asked_exposure_us_ = exposure_us;
        asked_gain_db_ = gain_db;
    } else {
        light_->forget();
        core_.tell_often(Severity::warning, "camera.exposure_refused", error);
    }
}

/** Tell when the limits of the camera are reached, and when it is well again. */
void LiveSession::Impl::tell_light(const PoseRecord &pose)
{
    const opms_exposure_state_t now = pose.exposure.state;
    const bool is_limit = now == OPMS_EXPOSURE_TOO_DARK || now == OPMS_EXPOSURE_TOO_BRIGHT;
    const bool was_limit =
        told_light_ == OPMS_EXPOSURE_TOO_DARK || told_light_ == OPMS_EXPOSURE_TOO_BRIGHT;
    if (now == told_light_ || !(is_limit || (was_limit && now == OPMS_EXPOSURE_HOLDING))) {
        return;
    }
    told_light_ = now;
    const Lock lock(mutex_);
    if (now == OPMS_EXPOSURE_TOO_DARK) {
        core_.tell_often(Severity::warning, "light.too_dark",
                         "too dark: exposure and gain are at their limits");
    } else if (now == OPMS_EXPOSURE_TOO_BRIGHT) {
        core_.tell_often(Severity::warning, "light.too_bright",
                         "too bright: exposure and gain are at their limits");
    } else {
        core_.tell_often(Severity::info, "light.well", "the light is well again");
    }
}

/** Tell what a person could do about the blur, once it has stood for ten pictures. */
void LiveSession::Impl::tell_blur(const PoseRecord &pose)
{
    constexpr std::uint32_t STANDS = 10;
    if (pose.blur == BlurVerdict::unknown) {
        return;
    }
    blur_seen_ = pose.blur == seen_blur_ ? blur_seen_ + 1 : 1;
    seen_blur_ = pose.blur;
    if (blur_seen_ < STANDS || pose.blur == told_blur_) {
        return;
    }
    const bool is_first = told_blur_ == BlurVerdict::unknown;
    told_blur_ = pose.blur;
    const Lock lock(mutex_);
    switch (pose.blur) {
    case BlurVerdict::unknown: break;
    case BlurVerdict::sharp:
        if (!is_first) {
            core_.tell(Severity::info, "blur.sharp", "the pictures are sharp again");
        }
        break;
    case BlurVerdict::focus:
        core_.tell(Severity::warning, "blur.focus", "out of focus: turn the lens");
        break;
    case BlurVerdict::motion:
        core_.tell(Severity::warning, "blur.motion", "blurred by motion: move slower");
        break;
    case BlurVerdict::aperture:
        core_.tell(Severity::warning, "blur.aperture",
                   "sharp in places alone: close the aperture");
        break;
    }
}

/** Pictures for a display come last: they go where the camera needs its buffers. */
void LiveSession::Impl::show(const FramePtr &frame, const PoseRecord &pose)
{
    const auto shown = std::make_shared<const PoseRecord>(pose);
    if (has_spare_buffers(devices_.source->counters())) {
        newest_.set(frame, shown);
        publisher_.picture(frame, shown, locator_->grid());
    } else {
        newest_.set(nullptr, shown);
        publisher_.drop_picture();
        publisher_.count_dropped();
    }
}

}  // namespace opms_host
