/* SPDX-License-Identifier: Apache-2.0 */
#include "edge_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace opms::siggen {

namespace {

constexpr double PERIOD_TOLERANCE = 200e-6;
constexpr double STAMP_TOLERANCE_US = 100;
/** A pulse that is due just at the end of listening may come after it. */
constexpr double END_SLACK_PERIODS = 0.1;
/** Stamps that far outside of the run are of another clock (the wall clock, before Linux 5.7). */
constexpr std::int64_t OTHER_CLOCK_NS = 60LL * 1000000000;

double us(std::int64_t ns)
{
    return static_cast<double>(ns) * 1e-3;
}

double median(std::vector<double> values)
{
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/** Stamps of edges after the first START; with stamps of another clock that is all of them. */
std::vector<std::int64_t> edges_of_run(const Run &run, const EdgeReport &report)
{
    std::vector<std::int64_t> stamps;
    for (const gpio_edge_t &edge : run.edges) {
        if (!report.same_clock || run.starts.empty() ||
            edge.t_ns >= run.starts.front().before_ns) {
            stamps.push_back(edge.t_ns);
        }
    }
    return stamps;
}

/** Periods from one moment to a later one, rounded. */
std::int64_t periods_in(double time_us, double period_us)
{
    return std::llround(time_us / period_us);
}

void count_intervals(const std::vector<std::int64_t> &stamps, const Limits &limits,
                     EdgeReport &report)
{
    std::vector<double> intervals;
    for (std::size_t i = 1; i < stamps.size(); ++i) {
        intervals.push_back(us(stamps[i] - stamps[i - 1]));
    }
    if (intervals.empty()) {
        return;
    }
    const double known_us = limits.expect_period_us;
    const double period_us = known_us > 0 ? known_us : median(intervals);
    std::vector<double> single;
    for (const double interval_us : intervals) {
        const std::int64_t periods = periods_in(interval_us, period_us);
        if (periods == 1) {
            single.push_back(interval_us);
        } else if (periods == 0) {
            ++report.extra;
        } else {
            report.missed += periods - 1;
        }
    }
    report.period_us = summarize(single);
    const double about_us = known_us > 0 ? known_us : report.period_us.mean;
    for (const double interval_us : single) {
        report.jitter_us = std::max(report.jitter_us, std::fabs(interval_us - about_us));
    }
}

/** Pulses that should have come between the last edge and the end. */
void count_tail(const std::vector<std::int64_t> &stamps, const Run &run, const Limits &limits,
                EdgeReport &report)
{
    const double period_us =
        limits.expect_period_us > 0 ? limits.expect_period_us : report.period_us.mean;
    if (!report.same_clock || period_us <= 0 || run.starts.empty()) {
        return;
    }
    const std::int64_t last_ns = stamps.empty() ? run.starts.front().after_ns : stamps.back();
    const double periods = us(run.end_ns - last_ns) / period_us;
    const auto due = static_cast<std::int64_t>(std::floor(periods - END_SLACK_PERIODS));
    report.missed += std::max<std::int64_t>(due, 0) + (stamps.empty() ? 1 : 0);
}

void measure_delays(const std::vector<std::int64_t> &stamps, const Run &run, EdgeReport &report)
{
    std::vector<double> delays;
    for (std::size_t i = 0; report.same_clock && i < run.starts.size(); ++i) {
        const std::int64_t from = run.starts[i].before_ns;
        const auto next = std::lower_bound(stamps.begin(), stamps.end(), from);
        const bool before_the_next_start =
            next != stamps.end() &&
            (i + 1 == run.starts.size() || *next < run.starts[i + 1].before_ns);
        if (before_the_next_start) {
            delays.push_back(us(*next - from));
        }
    }
    report.start_to_edge_us = summarize(delays);
    report.first_edge_delay_us = delays.empty() ? 0 : delays.front();
}

std::string text(const char *format, double a, double b)
{
    char buffer[160];
    std::snprintf(buffer, sizeof buffer, format, a, b);
    return buffer;
}

}  // namespace

Summary summarize(const std::vector<double> &values)
{
    Summary summary;
    summary.count = static_cast<std::int64_t>(values.size());
    if (values.empty()) {
        return summary;
    }
    for (const double value : values) {
        summary.mean += (value - values.front()) / static_cast<double>(values.size());
    }
    summary.mean += values.front();
    double squares = 0;
    for (const double value : values) {
        squares += (value - summary.mean) * (value - summary.mean);
    }
    if (values.size() > 1) {
        summary.sd = std::sqrt(squares / static_cast<double>(values.size() - 1));
    }
    summary.min = *std::min_element(values.begin(), values.end());
    summary.max = *std::max_element(values.begin(), values.end());
    return summary;
}

EdgeReport report_edges(const Run &run, const Limits &limits)
{
    EdgeReport report;
    report.edges = static_cast<std::int64_t>(run.edges.size());
    for (const gpio_edge_t &edge : run.edges) {
        report.dropped += edge.dropped;
        report.same_clock = report.same_clock && edge.t_ns > run.begin_ns - OTHER_CLOCK_NS &&
                            edge.t_ns < run.end_ns + OTHER_CLOCK_NS;
    }
    const std::vector<std::int64_t> stamps = edges_of_run(run, report);
    report.before_start = report.edges - static_cast<std::int64_t>(stamps.size());
    count_intervals(stamps, limits, report);
    count_tail(stamps, run, limits, report);
    measure_delays(stamps, run, report);
    return report;
}

Verdict judge(const EdgeReport &report, const Limits &limits)
{
    Verdict verdict;
    const Summary &period = report.period_us;
    verdict.lost = report.missed > 0 || report.dropped > 0 || report.edges == report.before_start;
    if (limits.expect_period_us > 0 && period.count > 0) {
        const double tolerance_us = limits.expect_period_us * PERIOD_TOLERANCE +
                                    STAMP_TOLERANCE_US / static_cast<double>(period.count);
        if (std::fabs(period.mean - limits.expect_period_us) > tolerance_us) {
            verdict.failures.push_back(text("the period is %.3f us, not %.3f us", period.mean,
                                            limits.expect_period_us));
        }
    }
    if (limits.expect_period_us > 0 && report.extra > 0) {
        verdict.failures.push_back(std::to_string(report.extra) +
                                   " edges came less than half a period after the one before");
    }
    if (limits.max_jitter_us > 0 && report.jitter_us > limits.max_jitter_us) {
        verdict.failures.push_back(text("the jitter is %.3f us, more than %.3f us",
                                        report.jitter_us, limits.max_jitter_us));
    }
    return verdict;
}

}  // namespace opms::siggen
