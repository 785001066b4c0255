/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The simulated world itself: all its parts behind one lock, and the passing of time. */
#ifndef OPMS_SIMULATED_WORLD_CORE_HPP
#define OPMS_SIMULATED_WORLD_CORE_HPP

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "buried_sensor.hpp"
#include "world_box.hpp"
#include "world_buffers.hpp"
#include "world_camera.hpp"
#include "world_clock.hpp"
#include "world_link.hpp"
#include "world_mishaps.hpp"
#include "world_pictures.hpp"
#include "world_truth.hpp"

namespace opms_host {

/** Who waits for the world. */
enum class Consumer { box, camera };

/** Time passes by the wall clock, N times as fast, or, with speed 0, from one happening to the next
 * as soon as all consumers wait. Calls from any thread at any time. */
class WorldCore {
public:
    /** Throws std::runtime_error. */
    explicit WorldCore(const WorldOptions &options);

    const WorldOptions &options() const { return options_; }
    const std::shared_ptr<WorldClock> &clock() const { return clock_; }
    WorldPictures &pictures() { return *pictures_; }

    /** Do something at the world's present, under its lock. */
    template <typename Work> auto now(Work work)
    {
        const std::lock_guard<std::mutex> guard(bell_->mutex);
        catch_up();
        bell_->changed.notify_all();  // they wake when the lock is free
        return work(*this);
    }
    /** Wait until @p take gets something, @p timeout_ms have passed in the world (and, with speed
     * 0, not more than that in ours), or a wake(). @return Whether it got something. */
    bool wait_for(Consumer who, std::uint32_t timeout_ms, const std::function<bool()> &take);
    void wake(Consumer who);
    /** It will wait: with speed 0, no time passes without it. Within now(). */
    void join(Consumer who) { waiting(who).is_present = true; }
    /** It will not wait any more: time need not wait for it. */
    void leave(Consumer who);
    /** As SimulatedWorld::step(). */
    bool step(std::int64_t limit_ns);

    /** Buffers for @p count pictures; those of earlier calls stay with their users. */
    void make_buffers(std::uint32_t count);
    const std::shared_ptr<WorldBuffers> &buffers() const { return buffers_; }
    std::uint64_t no_buffer() const { return no_buffer_; }
    TruePose pose(std::uint32_t picture) const;

    // For what is done within now() or take: the lock is held.
    Agenda &agenda() { return agenda_; }
    WorldBox &box() { return box_; }
    WorldLink &link() { return link_; }
    WorldCamera &camera() { return camera_; }
    WorldTruth &truth() { return truth_; }

private:
    struct Waiting {
        bool is_present = false, is_waiting = false, is_woken = false;
        std::int64_t deadline_ns = 0;
    };
    using Lock = std::unique_lock<std::mutex>;
    using Real = std::chrono::steady_clock;

    opms_settings_t first_settings() const;
    double pulse_period_s() const;
    void listen();
    void on_pulse(const BoxPulse &pulse);
    void on_waiting();
    void on_run();
    bool on_arrival(TrueFrame &frame);
    Waiting &waiting(Consumer who) { return waiting_[static_cast<std::size_t>(who)]; }
    bool has_items(Consumer who);
    bool all_wait();
    bool has_free_buffer();
    void catch_up();
    void jump();
    Real::time_point wake_time(const Waiting &me, Real::time_point give_up) const;

    const WorldOptions options_;
    const std::shared_ptr<WorldClock> clock_;
    const std::shared_ptr<WorldBell> bell_ = std::make_shared<WorldBell>();
    Agenda agenda_;
    HostStall stall_;
    WorldTruth truth_;
    std::unique_ptr<WorldPictures> pictures_;
    WorldBox box_;
    WorldLink link_;
    WorldCamera camera_;
    WorldMishaps mishaps_;
    BuriedSensor sensor_;
    std::shared_ptr<WorldBuffers> buffers_;
    std::uint64_t no_buffer_ = 0;
    std::int64_t run_began_ns_ = 0; /**< 0: not yet */
    std::array<Waiting, 2> waiting_{};
};

}  // namespace opms_host
#endif
