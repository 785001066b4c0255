/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What a run says about the box: period, jitter, missing pulses; and whether that is enough. */
#ifndef OPMS_SIGGEN_EDGE_REPORT_HPP
#define OPMS_SIGGEN_EDGE_REPORT_HPP

#include <cstdint>
#include <string>
#include <vector>

#include "siggen_run.hpp"

namespace opms::siggen {

/** Of a set of times in us. */
struct Summary {
    std::int64_t count = 0;
    double mean = 0, sd = 0, min = 0, max = 0; /**< all 0 without a value; sd with n - 1 */
};

Summary summarize(const std::vector<double> &values);

struct Limits {
    double expect_period_us = 0; /**< 0: not known; the median of the intervals stands for it */
    double max_jitter_us = 0;    /**< 0: none */
};

struct EdgeReport {
    std::int64_t edges = 0;        /**< of TRIG, all */
    std::int64_t before_start = 0; /**< of them, those before the first START (the preamble) */
    Summary period_us;             /**< intervals of about one period, after the first START */
    double jitter_us = 0;          /**< largest distance of such an interval from the period */
    std::int64_t missed = 0;       /**< periods without their pulse, up to the end of listening */
    std::int64_t extra = 0;        /**< edges less than half a period after the one before */
    std::int64_t dropped = 0;      /**< edges that the kernel had no room for */
    /** From just before each START was driven to the next edge: with the time that driving took. */
    Summary start_to_edge_us;
    double first_edge_delay_us = 0; /**< the first of those */
    /** Were edges stamped by the clock that START was sent by? Else no delays are given. */
    bool same_clock = true;
};

/** @p run's edges must be in order of time. */
EdgeReport report_edges(const Run &run, const Limits &limits);

struct Verdict {
    std::vector<std::string> failures; /**< limits that did not hold, for people */
    bool lost = false;                 /**< pulses are missing */
};

/** Compare with the limits. The period's mean may be off by 200 ppm (two crystals of 50 ppm each,
 * with room) and by 100 us over the whole run (two late interrupts). */
Verdict judge(const EdgeReport &report, const Limits &limits);

}  // namespace opms::siggen

#endif
