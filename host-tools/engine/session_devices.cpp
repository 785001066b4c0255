/* SPDX-License-Identifier: Apache-2.0 */
/* The threads of box and camera. */
#include "session_impl.hpp"

#include <chrono>
#include <cmath>

namespace opms_host {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t BOX_WAIT_MS = 20, CAMERA_WAIT_MS = 100;
constexpr std::int64_t WATCH_EVERY_NS = 1'000'000'000;

}  // namespace

void LiveSession::Impl::box_loop()
{
    bool more = devices_.box != nullptr;
    while (!quit_) {
        opms_box_item_t item{};
        if (more) {
            more = devices_.box->poll(BOX_WAIT_MS, item);
        } else {
            Lock lock(mutex_);
            changed_.wait_for(lock, 20ms, [this] { return quit_.load(); });
        }
        take_box_item(item);
        disarm_forgotten_box();
    }
}

void LiveSession::Impl::take_box_item(const opms_box_item_t &item)
{
    const Lock lock(mutex_);
    if (item.kind != OPMS_ITEM_NONE) {
        core_.take_box_item(item);
    }
    if (item.kind == OPMS_ITEM_LINK && item.as.link.change == OPMS_LINK_REBOOTED) {
        disarm_wanted_ = false; /* it is idle now */
    }
    core_.advance();
    const std::string over = core_.over();
    if (!over.empty()) {
        request_finish(over, false);
    }
    changed_.notify_all();
}

/** A box that was away when its scan was stopped still sends pulses: stop it now. */
void LiveSession::Impl::disarm_forgotten_box()
{
    {
        const Lock lock(mutex_);
        if (!disarm_wanted_ || core_.has_scan() || !core_.is_box_connected()) {
            return;
        }
        disarm_wanted_ = false;
    }
    std::string error;
    const bool done = devices_.box->disarm(error);
    const Lock lock(mutex_);
    if (!done) {
        core_.tell(Severity::warning, "box.not_disarmed", error);
    }
}

bool LiveSession::Impl::start_source()
{
    SourceStart start = options_.source;
    start.hardware_trigger = hardware_trigger_;
    std::string error;
    if (devices_.source->start(start, error)) {
        return true;
    }
    Lock lock(mutex_);
    core_.tell_often(Severity::warning, "camera.waiting", error);
    changed_.wait_for(lock, 1s, [this] { return quit_.load(); });
    return false;
}

void LiveSession::Impl::camera_loop()
{
    while (!quit_ && !start_source()) {
    }
    {
        const Lock lock(mutex_);
        core_.set_camera_connected(!quit_);
    }
    const bool is_live = devices_.source->traits().live;
    while (!quit_ && !source_ended_) {
        if (!is_live) {
            wait_for_scan();
        }
        SourceItem item;
        devices_.source->wait(CAMERA_WAIT_MS, item);
        take_source_item(item);
        watch_source();
    }
}

/** A replay begins with the scan. */
void LiveSession::Impl::wait_for_scan()
{
    Lock lock(mutex_);
    changed_.wait(lock, [this] { return quit_ || core_.is_accepting(); });
}

void LiveSession::Impl::take_source_item(const SourceItem &item)
{
    if (item.kind == SourceItemKind::frame) {
        take_frame(item.frame);
        return;
    }
    if (item.kind == SourceItemKind::back) {
        camera_is_new_ = true;
        set_exposure_again();
    }
    const Lock lock(mutex_);
    switch (item.kind) {
    case SourceItemKind::lost:
        core_.tell(Severity::warning, "camera.lost", item.text);
        core_.set_camera_connected(false);
        break;
    case SourceItemKind::back:
        core_.tell(Severity::info, "camera.back", item.text);
        core_.set_camera_connected(true);
        break;
    case SourceItemKind::failed:
        core_.tell_often(Severity::error, "camera.failed", item.text);
        break;
    case SourceItemKind::end:
        source_ended_ = true;
        core_.tell(Severity::info, "camera.ended", "all pictures have been played");
        request_finish("camera.ended", true);
        break;
    case SourceItemKind::none:
    case SourceItemKind::frame: break;
    }
}

/** Whether a picture is of the scan. Of single pictures, only one that was taken since it was asked
 * for. */
bool LiveSession::Impl::is_wanted(const Frame &frame)
{
    if (!core_.is_accepting()) {
        return false;
    }
    if (!singles_only_) {
        return true;
    }
    if (singles_wanted_ == 0 || frame.arrival_host_ns < single_since_ns_) {
        return false;
    }
    --singles_wanted_;
    return true;
}

void LiveSession::Impl::take_frame(const FramePtr &frame)
{
    Work work{frame, 0};
    {
        const Lock lock(mutex_);
        core_.set_camera_connected(true);
        if (is_wanted(*frame)) {
            work.number = core_.take_frame(frame);
            count_picture();
            changed_.notify_all();
        }
    }
    if (work.number == 0) {
        queue_.push_if_empty(std::move(work));
    } else if (publisher_.wait_for_room()) {
        queue_.push(std::move(work));
    }
}

/** The last picture that was ordered ends the scan. Pulses that the box has sent by then bring some
 * more: they are taken, so that no pulse is told to have no picture. */
void LiveSession::Impl::count_picture()
{
    if (options_.picture_count > 0 && core_.pictures() >= options_.picture_count) {
        if (!core_.scan_has_box()) {
            core_.stop_accepting();
        }
        request_finish("picture_count", true);
    }
}

/** What the source had to leave out since the last look. */
void LiveSession::Impl::watch_source()
{
    const std::int64_t now_ns = devices_.clock->now_ns();
    if (now_ns - watched_ns_ < WATCH_EVERY_NS) {
        return;
    }
    watched_ns_ = now_ns;
    const SourceCounters counters = devices_.source->counters();
    const auto more = [](std::uint64_t now, std::uint64_t then) {
        return now > then ? std::to_string(now - then) : std::string();
    };
    const Lock lock(mutex_);
    core_.set_source_counters(counters);
    const std::string no_buffer = more(counters.no_buffer, told_counters_.no_buffer);
    if (!no_buffer.empty()) {
        core_.tell(Severity::warning, "frames.no_buffer",
                   no_buffer + " picture(s) lost: all buffers were in use");
    }
    const std::string damaged = more(counters.damaged, told_counters_.damaged);
    if (!damaged.empty()) {
        core_.tell(Severity::warning, "frames.damaged", damaged + " picture(s) incomplete");
    }
    const std::string failed = more(counters.failed, told_counters_.failed);
    if (!failed.empty()) {
        core_.tell(Severity::warning, "frames.failed", failed + " picture(s) could not be read");
    }
    told_counters_ = counters;
}

/** A camera that was away has forgotten it. */
void LiveSession::Impl::set_exposure_again()
{
    double exposure_us = NOT_KNOWN, gain_db = NOT_KNOWN;
    {
        const Lock lock(mutex_);
        exposure_us = asked_exposure_us_;
        gain_db = asked_gain_db_;
    }
    std::string error;
    if (std::isfinite(exposure_us) &&
        !devices_.source->set_exposure(exposure_us, gain_db, error)) {
        const Lock lock(mutex_);
        core_.tell_often(Severity::warning, "camera.exposure_refused", error);
    }
}

}  // namespace opms_host
