/* SPDX-License-Identifier: Apache-2.0 */
/* The middle of a round trip lies at the same moment on both clocks, but for half of what the two
 * ways differ. That difference is at most the length of the round trip, so the fastest ones are
 * the best ones: a delay of any cause makes a trip long and only then lopsided. (The same thought
 * carries the clock filter of NTP, RFC 5905 section 10.) A line through them gives offset and
 * drift. */
#include <opms/clock.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/fail.h"
#include "base/memory.h"
#include "pair/clock_line.h"

#define STAGE "clock"
#define WALL_STEP_NS 1000000    /* what counts as a step and not as the time between two reads */
#define REFUSED_IN_A_ROW_MAX 16 /* then it is the line that is wrong */
#define GATE_SLACK_NS 50000     /* two reads of a clock are never closer for certain */
#define SLOW_DRIFT 100e-6       /* what the line may be off after running on by itself */

struct opms_clock {
    opms_clock_options_t options;
    pair_trip_t trips[OPMS_CLOCK_WINDOW_MAX];
    uint32_t count, next;
    uint32_t refused_in_a_row;
    pair_line_t line;
    opms_clock_fit_t fit;
    int has_wall;
    int64_t wall_offset_ns; /* wall less host, as it was first */
    int64_t wall_last_ns;   /* the same, as it is now */
    uint32_t wall_steps;
};

void opms_clock_options_init(opms_clock_options_t *options)
{
    if (options) {
        memset(options, 0, sizeof *options);
        options->struct_size = sizeof *options;
        options->window = 31;
        options->best = 8;
        options->drift_max_ppm = 300;
    }
}

static opms_status_t check_options(const opms_clock_options_t *options, opms_error_t *err)
{
    if (options->struct_size != sizeof *options) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "options.struct_size is %u, this library needs %u",
                         (unsigned)options->struct_size, (unsigned)sizeof *options);
    }
    if (options->window < 3 || options->window > OPMS_CLOCK_WINDOW_MAX) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "window is %u, allowed is 3 to %d",
                         (unsigned)options->window, OPMS_CLOCK_WINDOW_MAX);
    }
    if (options->best < 2 || options->best > options->window) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "best is %u, allowed is 2 to window (%u)",
                         (unsigned)options->best, (unsigned)options->window);
    }
    if (options->drift_max_ppm < 1 || options->drift_max_ppm > 10000) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "drift_max_ppm is %u, allowed is 1 to 10000",
                         (unsigned)options->drift_max_ppm);
    }
    return opms_check_allocator(&options->allocator, STAGE, err);
}

opms_status_t opms_clock_create(const opms_clock_options_t *options, opms_clock_t **clock,
                                opms_error_t *err)
{
    if (!clock) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "clock is NULL");
    }
    opms_clock_options_t chosen;
    opms_clock_options_init(&chosen);
    if (options) {
        OPMS_TRY(check_options(options, err));
        chosen = *options;
    }
    opms_clock_t *fresh = opms_take(&chosen.allocator, sizeof *fresh);
    if (!fresh) {
        return opms_fail(err, OPMS_ERR_MEMORY, STAGE, -1, "no memory for a clock (%zu bytes)",
                         sizeof *fresh);
    }
    fresh->options = chosen;
    *clock = fresh;
    return OPMS_OK;
}

void opms_clock_destroy(opms_clock_t *clock)
{
    if (clock) {
        opms_give_back(&clock->options.allocator, clock);
    }
}

static void forget_trips(opms_clock_t *clock)
{
    clock->count = 0;
    clock->next = 0;
    clock->refused_in_a_row = 0;
    memset(&clock->line, 0, sizeof clock->line);
}

void opms_clock_reset(opms_clock_t *clock)
{
    if (clock) {
        forget_trips(clock);
        memset(&clock->fit, 0, sizeof clock->fit);
    }
}

/** Could this have been, by itself? A span of more than an hour is no round trip. */
static int is_possible(const opms_round_trip_t *trip)
{
    const int64_t hour_ns = (int64_t)3600 * 1000000000, far = INT64_MAX / 4;
    if (trip->sent_host_ns > far || trip->sent_host_ns < -far || trip->arrived_host_ns > far ||
        trip->arrived_host_ns < -far || trip->received_box_ns > far ||
        trip->received_box_ns < -far || trip->sent_box_ns > far || trip->sent_box_ns < -far) {
        return 0;
    }
    const int64_t host_ns = trip->arrived_host_ns - trip->sent_host_ns;
    const int64_t box_ns = trip->sent_box_ns - trip->received_box_ns;
    return host_ns >= 0 && box_ns >= 0 && box_ns <= host_ns && host_ns <= hour_ns;
}

/** Is the middle no farther from the line than the trip's own length and the drift allow? */
static int is_on_line(const opms_clock_t *clock, const pair_trip_t *trip)
{
    if (clock->fit.state == OPMS_CLOCK_UNKNOWN) {
        return 1;
    }
    const int64_t expected_ns = pair_line_box(&clock->line, trip->host_ns);
    const int64_t off_ns = llabs(trip->box_ns - expected_ns);
    const int64_t age_ns = llabs(trip->host_ns - clock->fit.newest_host_ns);
    const double drift = (clock->fit.state == OPMS_CLOCK_FITTED ? 2e-6 : 1e-6) *
                         clock->options.drift_max_ppm;
    return (double)off_ns <= (double)trip->length_ns / 2 + (double)clock->fit.bound_ns +
                                 drift * (double)age_ns + GATE_SLACK_NS;
}

/** Would it only spoil the line? When all trips are held up for some seconds, the line goes on
 * better by itself than through the best of them. */
static int is_slow(const opms_clock_t *clock, const pair_trip_t *trip)
{
    if (clock->fit.state == OPMS_CLOCK_UNKNOWN) {
        return 0;
    }
    const int64_t age_ns = llabs(trip->host_ns - clock->fit.newest_host_ns);
    return pair_trip_is_slow(trip->length_ns - llround(SLOW_DRIFT * (double)age_ns),
                             clock->line.shortest_ns);
}

static void refit(opms_clock_t *clock, int64_t newest_host_ns)
{
    opms_clock_fit_t *fit = &clock->fit;
    pair_line_fit(&clock->line, clock->trips, clock->count, clock->options.best,
                  clock->options.drift_max_ppm * 1e-6);
    fit->state = clock->line.has_slope ? OPMS_CLOCK_FITTED : OPMS_CLOCK_COARSE;
    fit->round_trips = clock->line.used;
    fit->drift_ppm = clock->line.slope * 1e6;
    fit->drift_sigma_ppm = sqrt(clock->line.slope_variance) * 1e6;
    fit->residual_ns = clock->line.residual_ns;
    fit->sigma_ns = pair_line_sigma_ns(&clock->line, newest_host_ns);
    fit->bound_ns = clock->line.longest_ns / 2;
    fit->newest_host_ns = newest_host_ns;
}

opms_status_t opms_clock_push(opms_clock_t *clock, const opms_round_trip_t *trip,
                              opms_error_t *err)
{
    if (!clock || !trip) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL", clock ? "trip" : "clock");
    }
    if (!is_possible(trip)) {
        ++clock->fit.refused;
        return OPMS_OK;
    }
    const int64_t host_ns = trip->arrived_host_ns - trip->sent_host_ns;
    const int64_t box_ns = trip->sent_box_ns - trip->received_box_ns;
    const pair_trip_t middle = {.host_ns = trip->sent_host_ns + host_ns / 2,
                                .box_ns = trip->received_box_ns + box_ns / 2,
                                .length_ns = host_ns - box_ns};
    if (is_slow(clock, &middle)) {
        ++clock->fit.refused;
        return OPMS_OK;
    }
    if (!is_on_line(clock, &middle)) {
        if (++clock->refused_in_a_row < REFUSED_IN_A_ROW_MAX) {
            ++clock->fit.refused;
            return OPMS_OK;
        }
        forget_trips(clock); /* so many cannot all be wrong */
    }
    clock->refused_in_a_row = 0;
    ++clock->fit.accepted;
    clock->trips[clock->next] = middle;
    clock->next = (clock->next + 1) % clock->options.window;
    clock->count += clock->count < clock->options.window;
    refit(clock, trip->arrived_host_ns);
    return OPMS_OK;
}

void opms_clock_get(const opms_clock_t *clock, opms_clock_fit_t *fit)
{
    if (fit) {
        if (clock) {
            *fit = clock->fit;
        } else {
            memset(fit, 0, sizeof *fit);
        }
    }
}

static opms_status_t check_conversion(const opms_clock_t *clock, const int64_t *out,
                                      opms_error_t *err)
{
    if (!clock || !out) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL", clock ? "output" : "clock");
    }
    if (clock->fit.state == OPMS_CLOCK_UNKNOWN) {
        return opms_fail(err, OPMS_ERR_DOMAIN, STAGE, -1,
                         "no round trip to the box yet: its clock is not known");
    }
    return OPMS_OK;
}

opms_status_t opms_clock_host_from_box(const opms_clock_t *clock, int64_t box_ns,
                                       int64_t *host_ns, opms_error_t *err)
{
    OPMS_TRY(check_conversion(clock, host_ns, err));
    *host_ns = pair_line_host(&clock->line, box_ns);
    return OPMS_OK;
}

opms_status_t opms_clock_box_from_host(const opms_clock_t *clock, int64_t host_ns,
                                       int64_t *box_ns, opms_error_t *err)
{
    OPMS_TRY(check_conversion(clock, box_ns, err));
    *box_ns = pair_line_box(&clock->line, host_ns);
    return OPMS_OK;
}

opms_status_t opms_clock_push_wall(opms_clock_t *clock, int64_t host_ns, int64_t wall_ns,
                                   opms_error_t *err)
{
    if (!clock) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "clock is NULL");
    }
    const int64_t offset_ns = (int64_t)((uint64_t)wall_ns - (uint64_t)host_ns);
    if (!clock->has_wall) {
        clock->has_wall = 1;
        clock->wall_offset_ns = offset_ns;
    } else if (llabs((int64_t)((uint64_t)offset_ns - (uint64_t)clock->wall_last_ns)) >
               WALL_STEP_NS) {
        ++clock->wall_steps;
    }
    clock->wall_last_ns = offset_ns;
    return OPMS_OK;
}

opms_status_t opms_clock_wall_from_host(const opms_clock_t *clock, int64_t host_ns,
                                        int64_t *wall_ns, opms_error_t *err)
{
    if (!clock || !wall_ns) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL", clock ? "wall_ns" : "clock");
    }
    if (!clock->has_wall) {
        return opms_fail(err, OPMS_ERR_DOMAIN, STAGE, -1, "no sample of the wall clock yet");
    }
    *wall_ns = (int64_t)((uint64_t)host_ns + (uint64_t)clock->wall_offset_ns);
    return OPMS_OK;
}

int64_t opms_clock_wall_steps_ns(const opms_clock_t *clock, uint32_t *steps)
{
    if (steps) {
        *steps = clock ? clock->wall_steps : 0;
    }
    return clock ? (int64_t)((uint64_t)clock->wall_last_ns - (uint64_t)clock->wall_offset_ns) : 0;
}
