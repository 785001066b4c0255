/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What will happen in the simulated world, in the order of time. */
#ifndef OPMS_SIMULATED_WORLD_AGENDA_HPP
#define OPMS_SIMULATED_WORLD_AGENDA_HPP

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <utility>

namespace opms_host {

constexpr std::int64_t NS_PER_US = 1000, NS_PER_MS = 1'000'000, NS_PER_S = 1'000'000'000;

/** One thread at a time. Times are of the world: the host's monotonic clock. */
class Agenda {
public:
    using Action = std::function<void()>;
    static constexpr std::int64_t NEVER = std::numeric_limits<std::int64_t>::max();

    explicit Agenda(std::int64_t now_ns) : now_ns_(now_ns) {}

    std::int64_t now_ns() const { return now_ns_; }
    /** What was planned first comes first where times are equal; the past counts as now. */
    void at(std::int64_t t_ns, Action action)
    {
        actions_.emplace(std::make_pair(std::max(t_ns, now_ns_), ++count_), std::move(action));
    }
    void after(std::int64_t delay_ns, Action action) { at(now_ns_ + delay_ns, std::move(action)); }
    std::int64_t next_ns() const
    {
        return actions_.empty() ? NEVER : actions_.begin()->first.first;
    }
    /** Do the next one; there must be one. */
    void run_next()
    {
        const auto first = actions_.begin();
        now_ns_ = first->first.first;
        const Action action = std::move(first->second);
        actions_.erase(first);
        action();
    }
    /** Let time pass in which nothing happens. */
    void pass_to(std::int64_t t_ns) { now_ns_ = std::max(now_ns_, std::min(t_ns, next_ns())); }

private:
    std::int64_t now_ns_;
    std::uint64_t count_ = 0;
    std::map<std::pair<std::int64_t, std::uint64_t>, Action> actions_;
};

}  // namespace opms_host
#endif
