/* SPDX-License-Identifier: Apache-2.0 */
#include "world_camera.hpp"

#include <algorithm>
#include <cmath>

#include "world_frame.hpp"

namespace opms_host {

namespace {

constexpr std::size_t PAST_FRAMES = 300;

}  // namespace

WorldCamera::WorldCamera(Agenda &agenda, HostStall &stall, const WorldOptions &options,
                         std::uint32_t pictures)
    : agenda_(agenda), stall_(stall), options_(options), pictures_(pictures),
      random_(options.seed, Chance::camera),
      trigger_dice_(options.faults, options.seed, Chance::camera_fault),
      frame_dice_(options.faults, options.seed, Chance::frame_fault), light_(options),
      powered_ns_(agenda.now_ns() - random_.ns_of_ms(1000, 100000)),
      commanded_{options.exposure_us, options.gain_db}
{
}

void WorldCamera::start(const SourceStart &start)
{
    start_ = start;
    if (!std::isnan(start.exposure_us)) {
        commanded_.exposure_us = start.exposure_us;
    }
    if (!std::isnan(start.gain_db)) {
        commanded_.gain_db = start.gain_db;
    }
    commands_.clear();
    is_streaming_ = true;
    begin_stream();
}

void WorldCamera::begin_stream()
{
    ++stream_;
    next_id_ = options_.first_frame_id;
    busy_until_ns_ = 0;
    if (!start_.hardware_trigger) {
        free_run();
    } else if (options_.faults.extra_first_frame) {
        agenda_.after(5 * NS_PER_MS, [this, stream = stream_] {
            if (stream == stream_) {
                CameraTrigger nothing;
                nothing.true_ns = agenda_.now_ns();
                expose(nothing);
            }
        });
    }
}

void WorldCamera::stop()
{
    ++stream_;
    is_streaming_ = false;
    const auto is_frame = [](const CameraItem &item) {
        return item.kind == SourceItemKind::frame;
    };
    items_.erase(std::remove_if(items_.begin(), items_.end(), is_frame), items_.end());
    queued_frames_ = 0;
}

void WorldCamera::free_run()
{
    const auto period_ns = static_cast<std::int64_t>(1e9 / std::max(start_.frame_rate_hz, 0.01));
    agenda_.after(period_ns, [this, stream = stream_] {
        if (stream == stream_) {
            CameraTrigger own;
            own.true_ns = agenda_.now_ns();
            own.picture = static_cast<std::uint32_t>(exposures_ % pictures_);
            expose(own);
            free_run();
        }
    });
}

void WorldCamera::say(SourceItemKind kind, const char *text)
{
    CameraItem item;
    item.kind = kind;
    item.t_host_ns = agenda_.now_ns();
    item.text = text;
    items_.push_back(item);
}

void WorldCamera::restart(std::int64_t length_ns)
{
    if (!is_streaming_ || is_down_) {
        return;
    }
    ++stream_;
    is_down_ = true;
    say(SourceItemKind::lost, "the simulated camera was unplugged; seeking it");
    agenda_.after(length_ns, [this] {
        is_down_ = false;
        powered_ns_ = agenda_.now_ns();
        if (is_streaming_) {
            say(SourceItemKind::back, "the simulated camera is back");
            begin_stream();
        }
    });
}

void WorldCamera::set_exposure(double exposure_us, double gain_db)
{
    commanded_ = {std::clamp(exposure_us, EXPOSURE_MIN_US, EXPOSURE_MAX_US),
                  std::clamp(gain_db, 0.0, GAIN_MAX_DB)};
}

/** What was commanded so many frames ago. */
WorldCamera::Setting WorldCamera::next_setting()
{
    if (commands_.empty()) {
        commands_.assign(options_.exposure_delay_frames, commanded_);
    }
    commands_.push_back(commanded_);
    const Setting setting = commands_.front();
    commands_.pop_front();
    return setting;
}

void WorldCamera::trigger(const CameraTrigger &trigger)
{
    if (!is_streaming_ || is_down_ || !start_.hardware_trigger ||
        trigger_dice_.hits(Fault::trigger_ignored)) {
        return;
    }
    expose(trigger);
    if (trigger_dice_.hits(Fault::frame_extra)) {
        CameraTrigger nothing;
        nothing.picture = trigger.picture;
        nothing.run_s = trigger.run_s;
        agenda_.after(trigger_dice_.random().ns_of_ms(3, 60), [this, nothing, stream = stream_] {
            if (stream == stream_) {
                CameraTrigger now = nothing;
                now.true_ns = agenda_.now_ns();
                expose(now);
            }
        });
    }
}

std::uint64_t WorldCamera::ticks(std::int64_t true_ns) const
{
    if (!options_.camera_time) {
        return 0;
    }
    const double passed_s = static_cast<double>(true_ns - powered_ns_) * 1e-9;
    const double rate_hz =
        static_cast<double>(options_.camera_tick_hz) * (1 + options_.camera_drift_ppm * 1e-6);
    return static_cast<std::uint64_t>(std::llround(passed_s * rate_hz));
}

/** A camera that still exposes does not see the trigger. */
void WorldCamera::expose(const CameraTrigger &trigger)
{
    const auto delay_ns = static_cast<std::int64_t>(options_.start_delay_us * NS_PER_US);
    const std::int64_t from = trigger.true_ns + delay_ns;
    if (from < busy_until_ns_) {
        return;
    }
    const Setting setting = next_setting();
    const std::int64_t to = from + static_cast<std::int64_t>(setting.exposure_us * NS_PER_US);
    busy_until_ns_ = to;
    TrueFrame frame;
    if (trigger_dice_.hits(Fault::id_reset)) {
        next_id_ = 1;
    } else if (trigger_dice_.hits(Fault::id_skip)) {
        next_id_ += static_cast<std::uint64_t>(trigger_dice_.random().whole(1, 20));
    }
    frame.exposure_number = ++exposures_;
    frame.frame_id = world_raw_id(options_, next_id_++);
    frame.camera_time_ticks = ticks(from);
    frame.boot_id = trigger.boot_id;
    frame.session_id = trigger.session_id;
    frame.trigger_number = trigger.number;
    frame.mid_host_ns = from + (to - from) / 2;
    if (trigger.number != 0) {
        frame.mid_box_ns = std::llround(trigger.box_clock.ns(frame.mid_host_ns));
    }
    frame.picture = trigger.picture;
    frame.is_hidden = trigger.true_ns < hidden_until_ns_;
    frame.exposure_us = setting.exposure_us;
    frame.gain_db = setting.gain_db;
    frame.light = light_.factor(trigger.run_s);
    agenda_.at(to, [this, from, to, frame, stream = stream_] {
        if (stream == stream_) {
            if (listener_.on_strobe && !trigger_dice_.hits(Fault::strobe_unseen)) {
                listener_.on_strobe(from, to);
            }
            deliver(frame);
        }
    });
}

void WorldCamera::deliver(const TrueFrame &exposed)
{
    WorldRandom &chance = frame_dice_.random();
    TrueFrame frame = exposed;
    frame.is_damaged = frame_dice_.hits(Fault::frame_damaged);
    std::int64_t delay = static_cast<std::int64_t>(options_.readout_ms * 1e6) +
                         random_.ns_of_ms(0, options_.transport_jitter_ms);
    const std::int64_t now = agenda_.now_ns();
    if (frame_dice_.hits(Fault::frame_stale) && !past_.empty()) {
        const std::int64_t newest = static_cast<std::int64_t>(past_.size()) - 1;
        const TrueFrame stale = past_[static_cast<std::size_t>(chance.whole(0, newest))];
        deliver_at(now + delay + chance.ns_of_ms(1, 50), stale);
    }
    past_.push_back(frame);
    if (past_.size() > PAST_FRAMES) {
        past_.pop_front();
    }
    if (frame_dice_.hits(Fault::frame_lost)) {
        past_.pop_back();
        return;
    }
    if (frame_dice_.hits(Fault::frame_repeated)) {
        deliver_at(now + delay + chance.ns_of_ms(5, 2000), frame);
    }
    if (frame_dice_.hits(Fault::frame_late)) {
        delay += static_cast<std::int64_t>(chance.log_uniform(20, 9000) * 1e6);
    }
    deliver_at(now + delay, frame);
}

void WorldCamera::deliver_at(std::int64_t t_ns, const TrueFrame &frame)
{
    agenda_.at(t_ns, [this, frame, stream = stream_] {
        if (stream == stream_) {
            arrive(frame);
        }
    });
}

void WorldCamera::arrive(TrueFrame frame)
{
    if (agenda_.now_ns() < stall_.until_ns()) {
        agenda_.at(stall_.until_ns(), [this, frame, stream = stream_] {
            if (stream == stream_) {
                arrive(frame);
            }
        });
        return;
    }
    last_arrival_ns_ = std::max(agenda_.now_ns(), last_arrival_ns_ + 1);
    frame.arrival_host_ns = last_arrival_ns_;
    if (listener_.on_arrival(frame)) {
        CameraItem item;
        item.t_host_ns = frame.arrival_host_ns;
        item.frame = frame;
        items_.push_back(item);
        ++queued_frames_;
    }
}

CameraItem WorldCamera::take()
{
    CameraItem item = items_.front();
    items_.pop_front();
    queued_frames_ -= item.kind == SourceItemKind::frame ? 1 : 0;
    return item;
}

}  // namespace opms_host
