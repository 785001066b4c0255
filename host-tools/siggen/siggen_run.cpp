/* SPDX-License-Identifier: Apache-2.0 */
/* One thread: it listens until shortly before the next level change, then sleeps until exactly
 * that time. Edges that come meanwhile wait in the kernel, with their time stamps. */
#include "siggen_run.hpp"

#include <algorithm>
#include <queue>

namespace opms::siggen {

namespace {

constexpr std::int64_t GUARD_NS = 300000;    /**< no listening that close to a level change */
constexpr std::int64_t SLICE_NS = 100000000; /**< longest wait before `stop` is asked again */
constexpr int DRAIN_READS = 1000;            /**< at the end, of what waits in the kernel */

struct Due {
    std::int64_t t_ns;
    gpio_role_t output;
    bool active;
    bool glitch;

    bool operator<(const Due &o) const { return t_ns > o.t_ns; } /* earliest on top */
};

class Runner {
public:
    Runner(const RunOptions &options, Lines &lines, Clock &clock)
        : options_(options), lines_(lines), clock_(clock)
    {
        const Plan plan = plan_make(options.plan);
        const std::int64_t zero_ns = clock.now_ns();
        for (const Change &change : plan.changes) {
            due_.push({zero_ns + change.t_ns, GPIO_START, change.active, change.glitch});
        }
        run_.begin_ns = zero_ns;
        run_.end_ns = zero_ns + plan.end_ns;
    }

    Run run(const std::function<bool()> &stop)
    {
        while (clock_.now_ns() < run_.end_ns || !due_.empty()) {
            if (stop()) {
                run_.stopped = true;
                run_.end_ns = clock_.now_ns();
                break;
            }
            step();
        }
        for (int i = 0; i < DRAIN_READS && listen(0); ++i) {
        }
        lines_.set(GPIO_START, false);
        if (options_.strobe.on) {
            lines_.set(GPIO_STROBE, false);
        }
        return std::move(run_);
    }

private:
    void step()
    {
        const std::int64_t next_ns = due_.empty() ? run_.end_ns : due_.top().t_ns;
        const std::int64_t free_ns =
            next_ns - clock_.now_ns() - (due_.empty() ? 0 : GUARD_NS);
        if (free_ns > 0) {
            pass(std::min(free_ns, SLICE_NS));
        } else if (!due_.empty()) {
            send();
        }
    }

    /** Let time pass, listening if there is anything to listen to. */
    void pass(std::int64_t time_ns)
    {
        if (options_.listens) {
            listen(time_ns);
        } else {
            clock_.sleep_until_ns(clock_.now_ns() + time_ns);
        }
    }

    /** @return Whether edges came. */
    bool listen(std::int64_t timeout_ns)
    {
        if (!options_.listens) {
            return false;
        }
        const std::vector<gpio_edge_t> edges = lines_.wait(timeout_ns);
        for (const gpio_edge_t &edge : edges) {
            run_.edges.push_back(edge);
            /* After the end no more exposures begin. */
            const std::int64_t begin_ns = edge.t_ns + options_.strobe.delay_ns;
            if (options_.strobe.on && begin_ns < run_.end_ns) {
                due_.push({begin_ns, GPIO_STROBE, true, false});
                due_.push({begin_ns + options_.strobe.width_ns, GPIO_STROBE, false, false});
            }
        }
        return !edges.empty();
    }

    void send()
    {
        const Due due = due_.top();
        due_.pop();
        clock_.sleep_until_ns(due.t_ns);
        Sent sent{due.t_ns, clock_.now_ns(), 0};
        lines_.set(due.output, due.active);
        sent.after_ns = clock_.now_ns();
        if (due.output == GPIO_STROBE) {
            if (due.active) {
                run_.strobes.push_back(sent);
            }
        } else if (due.glitch) {
            run_.glitches += due.active;
        } else {
            (due.active ? run_.starts : run_.start_ends).push_back(sent);
        }
    }

    const RunOptions &options_;
    Lines &lines_;
    Clock &clock_;
    std::priority_queue<Due> due_;
    Run run_;
};

}  // namespace

std::string chip_path(const std::string &chip)
{
    if (chip.find('/') != std::string::npos) {
        return chip;
    }
    const bool number = !chip.empty() && std::all_of(chip.begin(), chip.end(), [](char c) {
        return c >= '0' && c <= '9';
    });
    return (number ? "/dev/gpiochip" : "/dev/") + chip;
}

Run run(const RunOptions &options, Lines &lines, Clock &clock, const std::function<bool()> &stop)
{
    return Runner(options, lines, clock).run(stop);
}

}  // namespace opms::siggen
