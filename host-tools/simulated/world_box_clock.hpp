/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The quartz of the simulated box. */
#ifndef OPMS_SIMULATED_WORLD_BOX_CLOCK_HPP
#define OPMS_SIMULATED_WORLD_BOX_CLOCK_HPP

#include <cmath>
#include <cstdint>

#include <opms/wire.h>

namespace opms_host {

constexpr std::int64_t NS_PER_CYCLE = 8;

inline opms_box_time_t box_time_of(std::int64_t cycles)
{
    return {static_cast<std::uint64_t>(cycles / OPMS_BOX_CYCLES_PER_US),
            static_cast<std::uint8_t>(cycles % OPMS_BOX_CYCLES_PER_US)};
}

/** True time (the world's) to the box's cycles since start-up and back. */
struct BoxClock {
    std::int64_t boot_ns = 0; /**< true time of its start-up */
    double drift = 0;         /**< how much faster it runs, relative */

    /** Not rounded to cycles. */
    double ns(std::int64_t true_ns) const
    {
        const auto passed = static_cast<double>(true_ns - boot_ns);
        return passed + passed * drift;
    }
    std::int64_t cycles(std::int64_t true_ns) const
    {
        return static_cast<std::int64_t>(std::floor(ns(true_ns) / NS_PER_CYCLE));
    }
    /** Of the cycle's beginning. */
    std::int64_t true_ns(std::int64_t cycles) const
    {
        const auto passed = static_cast<double>(cycles * NS_PER_CYCLE);
        const double true_passed = passed - passed * drift / (1 + drift);
        return boot_ns + static_cast<std::int64_t>(std::ceil(true_passed));
    }
};

}  // namespace opms_host
#endif
