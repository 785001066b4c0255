/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A line through the fastest of some round trips. */
#ifndef OPMS_PAIR_CLOCK_LINE_H
#define OPMS_PAIR_CLOCK_LINE_H

#include <stdint.h>

/** Middle of a round trip on both clocks, and the time it was under way. */
typedef struct pair_trip {
    int64_t host_ns, box_ns, length_ns;
} pair_trip_t;

/** box = box_ns + (host - host_ns) (1 + slope) */
typedef struct pair_line {
    int64_t host_ns, box_ns; /* a point in the middle of the data */
    double slope;
    int has_slope;
    uint32_t used;
    double slope_variance; /* 0: nothing is known of the slope */
    double point_sigma_ns;
    int64_t residual_ns, shortest_ns, longest_ns; /* of the trips used */
} pair_line_t;

/** A trip that is so much slower than the fastest would only spoil the line. */
static inline int pair_trip_is_slow(int64_t length_ns, int64_t shortest_ns)
{
    return length_ns / 4 > shortest_ns + 1000000;
}

/** Fit to the `best` shortest of `count` trips (1 to OPMS_CLOCK_WINDOW_MAX).
 *
 * The slope is that of two quartz clocks: it hardly changes, and some seconds tell it badly. So it
 * is carried on from fit to fit (a Kalman filter of one state), and only the offset is new each
 * time.
 * @param[in,out] line  The fit before this one, or all 0.
 * @param slope_max     A steeper line is not believed. */
void pair_line_fit(pair_line_t *line, const pair_trip_t *trips, uint32_t count, uint32_t best,
                   double slope_max);

int64_t pair_line_box(const pair_line_t *line, int64_t host_ns);
int64_t pair_line_host(const pair_line_t *line, int64_t box_ns);

/** Standard deviation of a conversion at a host time. */
int64_t pair_line_sigma_ns(const pair_line_t *line, int64_t host_ns);

#endif
