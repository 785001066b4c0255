/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A wait by the host's clock must end although that clock may stand still: a simulated one that
 * nobody drives. */
#ifndef OPMS_ENGINE_STANDSTILL_GUARD_HPP
#define OPMS_ENGINE_STANDSTILL_GUARD_HPP

#include <chrono>
#include <cstdint>

namespace opms_host {

/** One thread at a time. */
class StandstillGuard {
public:
    /** Whether the clock has stood at this time for 5 s of the machine's own. */
    bool stands_still(std::int64_t now_ns)
    {
        const auto now = std::chrono::steady_clock::now();
        if (now_ns != last_ns_) {
            last_ns_ = now_ns;
            moved_ = now;
        }
        return now - moved_ > std::chrono::seconds(5);
    }

private:
    std::int64_t last_ns_ = -1;
    std::chrono::steady_clock::time_point moved_{};
};

}  // namespace opms_host
#endif
