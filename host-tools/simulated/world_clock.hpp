/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The host's clocks of a simulated world. */
#ifndef OPMS_SIMULATED_WORLD_CLOCK_HPP
#define OPMS_SIMULATED_WORLD_CLOCK_HPP

#include <atomic>
#include <chrono>
#include <cstdint>

#include "host_clock.hpp"

namespace opms_host {

/** With speed 1 it reads what SystemClock reads, with N it runs N times as fast from then on, and
 * with 0 it stands where it was set last. */
class WorldClock : public HostClock {
public:
    /** Where a clock of speed 0 begins: always the same, so that its items are, too. */
    static constexpr std::int64_t FREE_START_NS = 1'000'000'000'000;
    using Real = std::chrono::steady_clock;

    explicit WorldClock(double speed)
        : speed_(speed), real_start_(Real::now()), wall_start_ns_(SystemClock().wall_ns()),
          start_ns_(speed > 0 ? SystemClock().now_ns() : FREE_START_NS), now_ns_(start_ns_)
    {
        if (speed == 1) {  // no offset at all between this clock and the system's
            real_start_ = Real::time_point();
            start_ns_ = 0;
            wall_start_ns_ -= now_ns_;
        }
    }

    double speed() const { return speed_; }
    std::int64_t now_ns() const override
    {
        if (speed_ == 0) {
            return now_ns_.load();
        }
        const auto real = Real::now() - real_start_;
        const auto real_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(real).count();
        return start_ns_ + (speed_ == 1 ? real_ns : scaled(real_ns, speed_));
    }
    std::int64_t wall_ns() const override { return wall_start_ns_ + now_ns() - start_ns_; }
    /** Speed 0 alone. */
    void set(std::int64_t now_ns) { now_ns_.store(now_ns); }
    /** When this clock will show @p t_ns; not for speed 0. */
    Real::time_point real_time_of(std::int64_t t_ns) const
    {
        const std::int64_t passed = t_ns - start_ns_;
        const std::int64_t real_ns = speed_ == 1 ? passed : scaled(passed, 1 / speed_);
        return real_start_ + std::chrono::nanoseconds(real_ns);
    }

private:
    static std::int64_t scaled(std::int64_t ns, double by)
    {
        return static_cast<std::int64_t>(static_cast<double>(ns) * by);
    }

    const double speed_;
    Real::time_point real_start_;
    std::int64_t wall_start_ns_, start_ns_;
    std::atomic<std::int64_t> now_ns_;
};

}  // namespace opms_host
#endif
