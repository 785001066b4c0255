/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the pulses alone tell of a run: the wires to a camera carry nothing else. */
#ifndef OPMS_SIMULATED_WIRED_RUN_HPP
#define OPMS_SIMULATED_WIRED_RUN_HPP

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace opms_host {

/** The first pulse after the preamble's coded gaps begins a run, and a gap that is no whole number
 * of periods ends it. */
class WiredRun {
public:
    explicit WiredRun(double period_s) : period_ns_(std::llround(period_s * 1e9)) {}

    /** @return Whether the pulse is the first of a run. */
    bool take(std::int64_t trigger_ns)
    {
        const std::int64_t gap = trigger_ns - last_ns_;
        last_ns_ = trigger_ns;
        if (is_awaited_) {
            is_awaited_ = false;
            is_running_ = true;
            zero_ns_ = trigger_ns;
            return true;
        }
        const std::int64_t off = std::llabs(std::llround(
            std::remainder(static_cast<double>(gap), static_cast<double>(period_ns_))));
        is_running_ = is_running_ && off < NEAR_NS;
        for (std::size_t i = 1; i < gaps_.size(); ++i) {
            gaps_[i - 1] = gaps_[i];
        }
        gaps_.back() = gap;
        is_awaited_ = !is_running_ && is_preamble();
        return false;
    }
    bool is_running() const { return is_running_; }
    double run_s(std::int64_t ns) const { return static_cast<double>(ns - zero_ns_) * 1e-9; }
    /** Pulses since the first one of the run, those that were missed included. */
    std::uint64_t pulse() const
    {
        return is_running_ ? static_cast<std::uint64_t>(
                                 std::llround(static_cast<double>(last_ns_ - zero_ns_) /
                                              static_cast<double>(period_ns_)))
                           : 0;
    }

private:
    static constexpr std::int64_t NEAR_NS = 2000;
    static constexpr std::array<std::int64_t, 5> PREAMBLE_MS = {100, 200, 100, 300, 100};

    bool is_preamble() const
    {
        for (std::size_t i = 0; i < gaps_.size(); ++i) {
            if (std::llabs(gaps_[i] - PREAMBLE_MS[i] * 1000000) > NEAR_NS) {
                return false;
            }
        }
        return true;
    }

    const std::int64_t period_ns_;
    std::int64_t last_ns_ = 0, zero_ns_ = 0;
    bool is_awaited_ = false, is_running_ = false;
    std::array<std::int64_t, 5> gaps_{};
};

}  // namespace opms_host
#endif
