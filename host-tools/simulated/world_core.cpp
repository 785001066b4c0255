/* SPDX-License-Identifier: Apache-2.0 */
#include "world_core.hpp"

#include <algorithm>

namespace opms_host {

namespace {

constexpr std::int64_t PRESS_NS = 20 * NS_PER_MS; /* of a finger on START */

}  // namespace

WorldCore::WorldCore(const WorldOptions &options)
    : options_(options), clock_(std::make_shared<WorldClock>(options.speed)),
      agenda_(clock_->now_ns()), truth_(options.truth_file, options.keep_truth),
      pictures_(std::make_unique<WorldPictures>(
          options, options.path_period_s > 0 ? options.path_period_s : pulse_period_s())),
      box_(agenda_, options.seed, options.box_drift_ppm, first_settings()),
      link_(agenda_, box_, stall_, options),
      camera_(agenda_, stall_, options, pictures_->count()),
      mishaps_({agenda_, box_, link_, camera_, stall_, truth_}, options),
      sensor_(options, pictures_->path(),
              pictures_->path().duration_s() / options.frames / pulse_period_s(),
              (options.start_delay_us + options.exposure_us / 2) * 1e-6)
{
    listen();
}

opms_settings_t WorldCore::first_settings() const
{
    opms_settings_t settings;
    opms_wire_default_settings(&settings);
    settings.strobe_enabled = options_.strobe;
    if (options_.period_us != 0) {
        settings.period_us = options_.period_us;
    }
    return settings;
}

double WorldCore::pulse_period_s() const
{
    return first_settings().period_us * 1e-6;
}

void WorldCore::listen()
{
    WorldBox::Listener box;
    box.on_pulse = [this](const BoxPulse &pulse) { on_pulse(pulse); };
    box.on_waiting = [this] { on_waiting(); };
    box.on_run = [this] { on_run(); };
    box.on_report = [this] { link_.wanted(); };
    box_.set_listener(std::move(box));
    WorldCamera::Listener camera;
    camera.on_strobe = [this](std::int64_t from, std::int64_t to) { box_.strobe(from, to); };
    camera.on_arrival = [this](TrueFrame &frame) { return on_arrival(frame); };
    camera_.set_listener(std::move(camera));
}

void WorldCore::on_pulse(const BoxPulse &pulse)
{
    const bool is_run = (pulse.flags & OPMS_TRIGGER_RUN) != 0;
    truth_.add(TrueTrigger{box_.boot_id(), box_.session_id(), pulse.number, is_run,
                           pulse.cycles * NS_PER_CYCLE, pulse.true_ns});
    CameraTrigger trigger;
    trigger.true_ns = pulse.true_ns;
    trigger.boot_id = box_.boot_id();
    trigger.session_id = box_.session_id();
    trigger.number = pulse.number;
    trigger.box_clock = box_.clock();
    if (is_run) {
        trigger.picture = (pulse.number - box_.first_run_number()) % pictures_->count();
        trigger.run_s = static_cast<double>(pulse.true_ns - run_began_ns_) * 1e-9;
        sensor_.advance_to(trigger.run_s);
    }
    camera_.trigger(trigger);
}

void WorldCore::on_waiting()
{
    if (options_.start_after_s > 0) {
        const std::uint32_t session_id = box_.session_id();
        agenda_.after(static_cast<std::int64_t>(options_.start_after_s * 1e9), [this, session_id] {
            if (box_.state() == OPMS_BOX_WAITING && box_.session_id() == session_id) {
                box_.start_edge(PRESS_NS);
            }
        });
    }
}

void WorldCore::on_run()
{
    const std::int64_t edge = box_.start_edge_cycles();
    run_began_ns_ = box_.clock().true_ns(edge);
    truth_.add(TrueRun{box_.boot_id(), box_.session_id(), box_.first_run_number(),
                       edge * NS_PER_CYCLE, run_began_ns_});
    mishaps_.run_began();
    sensor_.run_began();
}

bool WorldCore::on_arrival(TrueFrame &frame)
{
    if (!has_free_buffer()) {
        ++no_buffer_;
        return false;
    }
    truth_.add(frame, pose(frame.picture));
    return true;
}

TruePose WorldCore::pose(std::uint32_t picture) const
{
    const PathPoint point = pictures_->point(picture);
    return {point.ground_detector, pictures_->bar_camera(picture), point.velocity_m_s};
}

void WorldCore::make_buffers(std::uint32_t count)
{
    const std::size_t bytes = static_cast<std::size_t>(pictures_->width_px()) *
                              static_cast<std::size_t>(pictures_->height_px());
    buffers_ = std::make_shared<WorldBuffers>(count, bytes, bell_);
    no_buffer_ = 0;
}

bool WorldCore::has_free_buffer()
{
    return !buffers_ || buffers_->lent() + camera_.queued_frames() < buffers_->count();
}

bool WorldCore::has_items(Consumer who)
{
    return who == Consumer::box ? !link_.items().empty() : !camera_.items().empty();
}

/** By the wall clock: what should have happened by now, happens. */
void WorldCore::catch_up()
{
    if (clock_->speed() == 0) {
        return;
    }
    const std::int64_t now = clock_->now_ns();
    while (agenda_.next_ns() <= now) {
        agenda_.run_next();
    }
    agenda_.pass_to(now);
}

bool WorldCore::all_wait()
{
    for (const Consumer who : {Consumer::box, Consumer::camera}) {
        const Waiting &one = waiting(who);
        if (one.is_present && (!one.is_waiting || one.is_woken || has_items(who) ||
                               one.deadline_ns <= agenda_.now_ns())) {
            return false;
        }
    }
    return true;
}

/** To what happens next, or to the end of somebody's patience. */
void WorldCore::jump()
{
    std::int64_t t = agenda_.next_ns();
    for (const Waiting &one : waiting_) {
        t = one.is_present ? std::min(t, one.deadline_ns) : t;
    }
    if (agenda_.next_ns() <= t) {
        agenda_.run_next();
    } else {
        agenda_.pass_to(t);
    }
    clock_->set(agenda_.now_ns());
    bell_->changed.notify_all();
}

bool WorldCore::step(std::int64_t limit_ns)
{
    const std::lock_guard<std::mutex> guard(bell_->mutex);
    if (clock_->speed() != 0 || !has_free_buffer()) {
        return false;
    }
    const bool is_within = agenda_.next_ns() <= limit_ns;
    if (is_within) {
        agenda_.run_next();
    } else {
        agenda_.pass_to(limit_ns);
    }
    clock_->set(agenda_.now_ns());
    return is_within;
}

WorldCore::Real::time_point WorldCore::wake_time(const Waiting &me,
                                                 Real::time_point give_up) const
{
    if (clock_->speed() == 0) {
        return give_up;
    }
    return clock_->real_time_of(std::min(me.deadline_ns, agenda_.next_ns()));
}

bool WorldCore::wait_for(Consumer who, std::uint32_t timeout_ms, const std::function<bool()> &take)
{
    Lock lock(bell_->mutex);
    const Real::time_point give_up = Real::now() + std::chrono::milliseconds(timeout_ms);
    catch_up();
    Waiting &me = waiting(who);
    me.deadline_ns = agenda_.now_ns() + timeout_ms * NS_PER_MS;
    bool got = false;
    for (;;) {
        catch_up();
        got = take();
        const bool is_over = clock_->speed() == 0 && Real::now() >= give_up;
        if (got || me.is_woken || agenda_.now_ns() >= me.deadline_ns || is_over) {
            break;
        }
        me.is_waiting = true;
        if (clock_->speed() == 0 && has_free_buffer() && all_wait()) {
            jump();
        } else {
            bell_->changed.wait_until(lock, wake_time(me, give_up));
        }
    }
    me.is_woken = me.is_woken && got;
    me.is_waiting = false;
    return got;
}

void WorldCore::wake(Consumer who)
{
    const std::lock_guard<std::mutex> guard(bell_->mutex);
    waiting(who).is_woken = true;
    bell_->changed.notify_all();
}

void WorldCore::leave(Consumer who)
{
    const std::lock_guard<std::mutex> guard(bell_->mutex);
    waiting(who) = Waiting();
    bell_->changed.notify_all();
}

}  // namespace opms_host
