/* SPDX-License-Identifier: Apache-2.0 */
#include "pair/clock_line.h"

#include <math.h>
#include <string.h>

#include <opms/clock.h>

#define TRIPS_FOR_A_SLOPE 4    /* two make a line of any noise */
#define SLOPE_START 60e-6     /* what is expected of two quartz clocks that are not known yet */
#define SLOPE_WALK 0.15e-6    /* what temperature does to them from ping to ping */
#define REUSE 8.0             /* the same trips are used in so many fits */
#define NOISE_FLOOR_NS2 (50e3 * 50e3)
#define OUTLIER_SIGMAS 4.0
#define ALLOWED_NS 1500000    /* longer than the fastest: polls of 1 ms on both ways */
#define OUTLIER_FLOOR_NS 100e3 /* residuals below this are never outliers: polls of 1 ms */

/** Indices of the shortest trips, shortest first. @return How many. */
static uint32_t take_shortest(const pair_trip_t *trips, uint32_t count, uint32_t best,
                              uint32_t *chosen)
{
    uint32_t taken = 0;
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t at = taken;
        if (taken < best) {
            ++taken;
        } else if (trips[i].length_ns < trips[chosen[best - 1]].length_ns) {
            at = best - 1;
        } else {
            continue;
        }
        while (at > 0 && trips[chosen[at - 1]].length_ns > trips[i].length_ns) {
            chosen[at] = chosen[at - 1];
            --at;
        }
        chosen[at] = i;
    }
    return taken;
}

/** Sums about the mean of the chosen trips. x: host, y: box less host. */
typedef struct moments {
    double x_mean, y_mean, xx, xy, yy;
} moments_t;

/** A slope and how well it is known. */
typedef struct slope {
    double value, variance;
} slope_t;

static moments_t moments_of(const pair_trip_t *trips, const uint32_t *chosen, uint32_t count,
                            const pair_trip_t *origin)
{
    moments_t m = {0, 0, 0, 0, 0};
    for (uint32_t i = 0; i < count; ++i) {
        const pair_trip_t *trip = &trips[chosen[i]];
        const double x = (double)(trip->host_ns - origin->host_ns);
        m.x_mean += x / count;
        m.y_mean += ((double)(trip->box_ns - origin->box_ns) - x) / count;
    }
    for (uint32_t i = 0; i < count; ++i) {
        const pair_trip_t *trip = &trips[chosen[i]];
        const double x = (double)(trip->host_ns - origin->host_ns);
        const double y = (double)(trip->box_ns - origin->box_ns) - x;
        m.xx += (x - m.x_mean) * (x - m.x_mean);
        m.xy += (x - m.x_mean) * (y - m.y_mean);
        m.yy += (y - m.y_mean) * (y - m.y_mean);
    }
    return m;
}

/** The slope that was known, and what these trips add to it. */
static slope_t learn_slope(slope_t known, const moments_t *m, uint32_t count, double slope_max)
{
    if (count < TRIPS_FOR_A_SLOPE || m->xx <= 0) {
        return known;
    }
    const double seen = fmin(fmax(m->xy / m->xx, -slope_max), slope_max);
    const double noise = fmax((m->yy - m->xy * m->xy / m->xx) / (count - 2), NOISE_FLOOR_NS2);
    const double variance = REUSE * noise / m->xx;
    const double gain = known.variance / (known.variance + variance);
    const slope_t slope = {known.value + gain * (seen - known.value),
                           (1 - gain) * known.variance};
    return slope;
}

static void put_line(pair_line_t *line, const pair_trip_t *trips, const uint32_t *chosen,
                     uint32_t count, slope_t known, double slope_max)
{
    const pair_trip_t *origin = &trips[chosen[0]];
    const moments_t m = moments_of(trips, chosen, count, origin);
    const slope_t slope = learn_slope(known, &m, count, slope_max);
    line->used = count;
    line->shortest_ns = origin->length_ns;
    line->longest_ns = origin->length_ns;
    line->has_slope = count >= TRIPS_FOR_A_SLOPE;
    line->slope = slope.value;
    line->slope_variance = slope.variance;
    if (!line->has_slope) { /* the fastest trip alone */
        line->host_ns = origin->host_ns;
        line->box_ns = origin->box_ns;
    } else {
        line->host_ns = origin->host_ns + llround(m.x_mean);
        line->box_ns = origin->box_ns + llround(m.x_mean) + llround(m.y_mean);
        line->longest_ns = trips[chosen[count - 1]].length_ns;
    }
    double squares = 0, worst = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const pair_trip_t *trip = &trips[chosen[i]];
        const double r = (double)(trip->box_ns - pair_line_box(line, trip->host_ns));
        squares += r * r;
        worst = fmax(worst, fabs(r));
    }
    line->residual_ns = llround(worst);
    const double variance = count > 2 ? squares / (count - 2) : 0;
    line->point_sigma_ns = line->has_slope ? sqrt(variance / count)
                                           : (double)line->shortest_ns / 2 / sqrt(3.0);
}

/** Take out the one that lies farthest off. @return 0 where none is an outlier. */
static int drop_outlier(const pair_line_t *line, const pair_trip_t *trips, uint32_t *chosen,
                        uint32_t *count)
{
    double squares = 0, worst = -1;
    uint32_t at = 0;
    for (uint32_t i = 0; i < *count; ++i) {
        const pair_trip_t *trip = &trips[chosen[i]];
        const double r = fabs((double)(trip->box_ns - pair_line_box(line, trip->host_ns)));
        squares += r * r;
        if (r > worst) {
            worst = r;
            at = i;
        }
    }
    /* Judged by the others: an outlier among eight would hide in a figure that it makes itself. */
    const double others = sqrt((squares - worst * worst) / (*count - 1));
    if (worst <= OUTLIER_FLOOR_NS || worst <= OUTLIER_SIGMAS * others) {
        return 0;
    }
    memmove(chosen + at, chosen + at + 1, (*count - at - 1) * sizeof *chosen);
    --*count;
    return 1;
}

void pair_line_fit(pair_line_t *line, const pair_trip_t *trips, uint32_t count, uint32_t best,
                   double slope_max)
{
    uint32_t chosen[OPMS_CLOCK_WINDOW_MAX] = {0};
    uint32_t used = take_shortest(trips, count, best, chosen);
    const int64_t shortest_ns = trips[chosen[0]].length_ns;
    const int64_t allowed_ns = shortest_ns / 2 > ALLOWED_NS ? shortest_ns / 2 : ALLOWED_NS;
    while (trips[chosen[used - 1]].length_ns - shortest_ns > allowed_ns) {
        --used; /* the best of bad ones, beside a good one */
    }
    slope_t known = {0, SLOPE_START * SLOPE_START};
    if (line->slope_variance > 0) {
        known.value = line->slope;
        known.variance = fmin(line->slope_variance + SLOPE_WALK * SLOPE_WALK, known.variance);
    }
    put_line(line, trips, chosen, used, known, slope_max);
    while (line->has_slope && used > TRIPS_FOR_A_SLOPE &&
           drop_outlier(line, trips, chosen, &used)) {
        put_line(line, trips, chosen, used, known, slope_max);
    }
}

int64_t pair_line_box(const pair_line_t *line, int64_t host_ns)
{
    const double since = (double)host_ns - (double)line->host_ns;
    return (int64_t)((uint64_t)line->box_ns + (uint64_t)host_ns - (uint64_t)line->host_ns +
                     (uint64_t)llround(since * line->slope));
}

int64_t pair_line_host(const pair_line_t *line, int64_t box_ns)
{
    const double since = (double)box_ns - (double)line->box_ns;
    const double stretch = line->slope / (1 + line->slope);
    return (int64_t)((uint64_t)line->host_ns + (uint64_t)box_ns - (uint64_t)line->box_ns -
                     (uint64_t)llround(since * stretch));
}

int64_t pair_line_sigma_ns(const pair_line_t *line, int64_t host_ns)
{
    const double since = (double)host_ns - (double)line->host_ns;
    return llround(fmin(hypot(line->point_sigma_ns, sqrt(line->slope_variance) * since), 1e15));
}
