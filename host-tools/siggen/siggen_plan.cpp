/* SPDX-License-Identifier: Apache-2.0 */
#include "siggen_plan.hpp"

namespace opms::siggen {

namespace {

constexpr std::int64_t LEAD_NS = 20000000; /**< to be ready for the first change in time */
constexpr std::int64_t COUNT_MAX = 1000000;
constexpr std::int64_t PERIOD_MAX_NS = 3600LL * 1000000000;
constexpr std::int64_t WIDTH_MIN_NS = 1000;

}  // namespace

std::string plan_check(const PlanOptions &options)
{
    if (options.count < 1 || options.count > COUNT_MAX) {
        return "--count must be 1 to 1000000";
    }
    if (options.period_ns < 1000000 || options.period_ns > PERIOD_MAX_NS) {
        return "--period-ms must be 1 to 3600000";
    }
    const bool glitches = !options.glitch_ns.empty();
    const std::int64_t room_ns = glitches ? options.period_ns / 2 : options.period_ns;
    if (options.width_ns < WIDTH_MIN_NS || options.width_ns >= room_ns) {
        return std::string("--width-us must be at least 1 and shorter than ") +
               (glitches ? "half the period (glitches are sent in its middle)" : "the period");
    }
    for (const std::int64_t glitch_ns : options.glitch_ns) {
        if (glitch_ns < WIDTH_MIN_NS || glitch_ns >= room_ns) {
            return "--glitch-us must be at least 1 and shorter than half the period";
        }
    }
    return "";
}

Plan plan_make(const PlanOptions &options)
{
    const std::size_t kinds = options.glitch_ns.size();
    const std::int64_t before_ns = kinds > 0 ? options.period_ns / 2 : 0;
    Plan plan;
    std::int64_t t_ns = LEAD_NS + before_ns;
    for (std::int64_t i = 0; i < options.count; ++i, t_ns += options.period_ns) {
        if (kinds > 0) {
            const std::int64_t glitch_ns = options.glitch_ns[static_cast<std::size_t>(i) % kinds];
            plan.changes.push_back({t_ns - before_ns, true, true});
            plan.changes.push_back({t_ns - before_ns + glitch_ns, false, true});
        }
        plan.changes.push_back({t_ns, true, false});
        plan.changes.push_back({t_ns + options.width_ns, false, false});
    }
    plan.end_ns = t_ns;
    return plan;
}

}  // namespace opms::siggen
