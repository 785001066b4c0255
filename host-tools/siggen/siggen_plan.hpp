/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the signal generator sends and when: options -> a list of level changes. */
#ifndef OPMS_SIGGEN_SIGGEN_PLAN_HPP
#define OPMS_SIGGEN_SIGGEN_PLAN_HPP

#include <cstdint>
#include <string>
#include <vector>

namespace opms::siggen {

struct PlanOptions {
    std::int64_t count = 1;
    std::int64_t period_ns = 0;
    std::int64_t width_ns = 0;
    /** Widths of pulses that the box's debounce must reject; one is sent half a period before each
     * START, in turn. */
    std::vector<std::int64_t> glitch_ns;
};

/** START changes its level. Times count from the beginning of the run. */
struct Change {
    std::int64_t t_ns;
    bool active;
    bool glitch; /**< belongs to a glitch, not to a START pulse */
};

struct Plan {
    std::vector<Change> changes; /**< in order */
    std::int64_t end_ns = 0;     /**< one period after the last START: how long edges are awaited */
};

/** @return "" or what is wrong with the options, to be told to a user. */
std::string plan_check(const PlanOptions &options);

/** Options that plan_check() has nothing against. */
Plan plan_make(const PlanOptions &options);

}  // namespace opms::siggen

#endif
