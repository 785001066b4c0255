/* SPDX-License-Identifier: Apache-2.0 */
/* Frames repeat the gaps between their triggers. Where those gaps are unequal - the preamble's are
 * coded, and nobody knows beforehand when START will come - only one way of laying frames upon
 * triggers fits. All ways that are possible at all are tried, those too that would lay frames upon
 * triggers that are not reported yet; a lock is found where exactly one is alive. */
#include <math.h>
#include <stdlib.h>

#include "pair/judge.h"
#include "pair/lock_search.h"

#define FRAMES_MAX 12
#define FITS_MIN 4
#define FITS_ALIVE 3   /* a way that so many frames may fit, and most of them, is not excluded */
#define MISFITS_MAX 1  /* of the way that is taken: an extra frame, a late one */
#define AHEAD FRAMES_MAX
#define STAMP_TOLERANCE_NS 400000
#define STAMP_DRIFT 300e-6
#define FLOOR_TOLERANCE_NS 20000000 /* of delays that were learnt before */

typedef struct window {
    const pair_seen_t *frames[FRAMES_MAX]; /* newest first */
    uint32_t count;
    int by_camera;
} window_t;

/** How frames lie upon triggers by one offset. */
typedef struct fit {
    uint32_t fits, misfits, unknown, of_preamble;
    int64_t least_delay_ns;
    const pair_seen_t *first, *newest;
} fit_t;

static window_t take_window(const opms_pairer_t *pairer)
{
    window_t window = {.by_camera = pairer->options.camera.has_camera_time != 0};
    for (uint32_t i = 0; i < PAIR_RECENT && i < pairer->recent_count; ++i) {
        const pair_seen_t *seen = pair_recent(pairer, i);
        if (!seen->seen_before && seen->has_id && seen->has_arrival &&
            (seen->has_camera || !window.by_camera) && window.count < FRAMES_MAX) {
            window.frames[window.count++] = seen;
        }
    }
    return window;
}

/** A frame's own measure of its trigger's time, but for a constant. */
static int64_t measure(const window_t *window, const pair_seen_t *seen)
{
    return window->by_camera ? seen->camera_ns : seen->arrival_box_ns;
}

/** Could the frame have been exposed then? */
static int is_in_time(const opms_pairer_t *pairer, int64_t delay_ns)
{
    return delay_ns >= -pair_slack_ns(pairer->min_gap_ns) && !pair_is_too_late(pairer, delay_ns);
}

/** The constant that the frames share: of camera stamps the newest's, of arrivals the least. */
static int reference(const opms_pairer_t *pairer, const window_t *window, int64_t offset,
                     int64_t *constant_ns)
{
    int found = 0;
    for (uint32_t i = 0; i < window->count; ++i) {
        const pair_seen_t *seen = window->frames[i];
        const pair_trigger_t *trigger = pair_ring_timed(&pairer->triggers, seen->id - offset);
        if (!trigger || !is_in_time(pairer, seen->arrival_box_ns - trigger->box_ns)) {
            continue;
        }
        const int64_t here_ns = measure(window, seen) - trigger->box_ns;
        if (!found || (!window->by_camera && here_ns < *constant_ns)) {
            *constant_ns = here_ns;
        }
        found = 1;
        if (window->by_camera) {
            break;
        }
    }
    return found;
}

static void count_untimed(const opms_pairer_t *pairer, const pair_seen_t *seen, int64_t number,
                          fit_t *fit)
{
    const pair_ring_t *ring = &pairer->triggers;
    const pair_trigger_t *last = pair_ring_timed(ring, ring->known_last);
    if (number < ring->first) {
        return; /* a stale frame: neither for nor against */
    }
    if (number > ring->known_last && last && seen->arrival_box_ns < last->box_ns) {
        ++fit->misfits;
    } else {
        ++fit->unknown;
    }
}

static fit_t lay_upon(const opms_pairer_t *pairer, const window_t *window, int64_t offset)
{
    fit_t fit = {.least_delay_ns = INT64_MAX};
    int64_t constant_ns = 0;
    const int any = reference(pairer, window, offset, &constant_ns);
    for (uint32_t i = 0; i < window->count; ++i) {
        const pair_seen_t *seen = window->frames[i];
        const int64_t number = seen->id - offset;
        const pair_trigger_t *trigger = pair_ring_timed(&pairer->triggers, number);
        if (!trigger) {
            count_untimed(pairer, seen, number, &fit);
            continue;
        }
        const int64_t delay_ns = seen->arrival_box_ns - trigger->box_ns;
        const int64_t off_ns = measure(window, seen) - trigger->box_ns - constant_ns;
        const double apart_ns = fabs((double)(seen->arrival_box_ns -
                                              window->frames[0]->arrival_box_ns));
        const double allowed_ns = window->by_camera
                                      ? STAMP_TOLERANCE_NS + STAMP_DRIFT * apart_ns
                                      : (double)pair_window_ns(pairer->min_gap_ns);
        if (!any || !is_in_time(pairer, delay_ns) || fabs((double)off_ns) > allowed_ns) {
            ++fit.misfits;
            continue;
        }
        ++fit.fits;
        fit.of_preamble += trigger->preamble;
        fit.first = seen;
        fit.newest = fit.newest ? fit.newest : seen;
        fit.least_delay_ns = delay_ns < fit.least_delay_ns ? delay_ns : fit.least_delay_ns;
    }
    return fit;
}

static int is_alive(const opms_pairer_t *pairer, const fit_t *fit)
{
    /* All may be late, and then only the gaps tell; but none is early. */
    const int is_early =
        pairer->floor.known && fit->fits > 0 &&
        fit->least_delay_ns < pair_floor_ns(&pairer->floor) - FLOOR_TOLERANCE_NS;
    const uint32_t may_fit = fit->fits + fit->unknown;
    return !is_early && may_fit >= FITS_ALIVE && may_fit > fit->misfits;
}

int pair_seek_by_pattern(const opms_pairer_t *pairer, pair_candidate_t *found)
{
    const pair_ring_t *ring = &pairer->triggers;
    const window_t window = take_window(pairer);
    if (window.count < FITS_MIN || ring->known_last < ring->first) {
        return 0;
    }
    const pair_seen_t *newest = window.frames[0];
    fit_t only = {0};
    uint32_t alive = 0;
    for (int64_t number = ring->next + AHEAD; number >= ring->first && alive < 2; --number) {
        const pair_trigger_t *trigger = pair_ring_at(ring, number);
        if (number < ring->next &&
            (!trigger || newest->arrival_box_ns - trigger->box_ns > pairer->max_wait_ns)) {
            break;
        }
        const fit_t fit = lay_upon(pairer, &window, newest->id - number);
        if (is_alive(pairer, &fit)) {
            ++alive;
            only = fit;
            found->offset = newest->id - number;
        }
    }
    if (alive != 1 || only.fits < FITS_MIN || only.misfits > MISFITS_MAX) {
        return 0;
    }
    found->first = only.first;
    found->newest = only.newest;
    found->has_floor = 1;
    found->floor_ns = only.least_delay_ns;
    found->witnesses = OPMS_WITNESS_FRAME_ID | OPMS_WITNESS_ARRIVAL |
                       (window.by_camera ? OPMS_WITNESS_CAMERA_TIME : 0) |
                       (only.of_preamble >= FITS_MIN ? OPMS_WITNESS_PREAMBLE : 0);
    return 1;
}
