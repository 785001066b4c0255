/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The host's clocks, so that a simulated scan can run in its own time. */
#ifndef OPMS_LIVE_HOST_CLOCK_HPP
#define OPMS_LIVE_HOST_CLOCK_HPP

#include <chrono>
#include <cstdint>

namespace opms_host {

/** Any thread, any time. */
class HostClock {
public:
    virtual ~HostClock() = default;
    /** Monotonic (CLOCK_MONOTONIC on a real host); every `_host_ns` is of this clock. */
    virtual int64_t now_ns() const = 0;
    /** Since 1970 UTC. */
    virtual int64_t wall_ns() const = 0;
};

/** The machine's own. */
class SystemClock : public HostClock {
public:
    int64_t now_ns() const override
    {
        return since_epoch_ns(std::chrono::steady_clock::now());
    }
    int64_t wall_ns() const override
    {
        return since_epoch_ns(std::chrono::system_clock::now());
    }

private:
    template <typename Time> static int64_t since_epoch_ns(Time time)
    {
        return std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch())
            .count();
    }
};

}  // namespace opms_host
#endif
