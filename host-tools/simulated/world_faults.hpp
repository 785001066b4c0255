/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * When the faults of WorldOptions::faults hit. */
#ifndef OPMS_SIMULATED_WORLD_FAULTS_HPP
#define OPMS_SIMULATED_WORLD_FAULTS_HPP

#include <algorithm>
#include <array>
#include <cstdint>

#include "world_options.hpp"
#include "world_random.hpp"

namespace opms_host {

/** Faults come in bursts of 1 to 20, short ones more often; each kind by itself, so that they
 * overlap as they like. */
class FaultDice {
public:
    FaultDice(const FaultRates &rates, std::uint64_t seed, Chance use)
        : rates_(rates), random_(seed, use)
    {
    }
    WorldRandom &random() { return random_; }
    /** Is the next of its events hit? */
    bool hits(Fault fault)
    {
        constexpr double LONGEST = 20, MEAN = (LONGEST - 1) / 2.995732;  // log-uniform
        const double share = rates_[fault];
        std::uint32_t &left = left_[static_cast<std::size_t>(fault)];
        if (share <= 0) {
            return false;
        }
        if (left == 0) {
            const double rate = share / MEAN;
            if (!random_.chance(rate / (1 - share + rate))) {
                return false;
            }
            left = static_cast<std::uint32_t>(random_.log_uniform(1, LONGEST));
        }
        --left;
        ++counts_[static_cast<std::size_t>(fault)];
        return true;
    }
    std::uint64_t count(Fault fault) const { return counts_[static_cast<std::size_t>(fault)]; }

private:
    const FaultRates rates_;
    WorldRandom random_;
    std::array<std::uint32_t, FAULT_KINDS> left_{};
    std::array<std::uint64_t, FAULT_KINDS> counts_{};
};

/** Nothing is read by the host until this time. */
class HostStall {
public:
    void until(std::int64_t t_ns) { until_ns_ = std::max(until_ns_, t_ns); }
    std::int64_t until_ns() const { return until_ns_; }

private:
    std::int64_t until_ns_ = 0;
};

}  // namespace opms_host
#endif
