/* SPDX-License-Identifier: Apache-2.0 */
#include "pair/lock_search.h"

#include <math.h>
#include <stdlib.h>

#include "pair/judge.h"

#define CAMERA_FRAMES 3      /* that agree; with a new offset, one of them must be on time */
#define ARRIVAL_FRAMES 8     /* in a row, for arrivals alone */
#define ARRIVAL_ON_TIME 5
#define RETURN_FRAMES 4      /* in a row and all on time, back to the offset that was */
#define RESTART_FRAMES 5     /* whose camera times agree */
#define RESTART_ON_TIME 4
#define RESTART_ODD 1        /* frames of before among them */
#define STAMP_JITTER_NS 400000
#define STAMP_DRIFT 300e-6

static uint32_t recent_frames(const opms_pairer_t *pairer)
{
    return pairer->recent_count < PAIR_RECENT ? (uint32_t)pairer->recent_count : PAIR_RECENT;
}

/** Is what exposed it not reported yet? Then it says nothing, for now. */
static int is_ahead(const opms_pairer_t *pairer, int64_t box_ns)
{
    const pair_trigger_t *last = pair_ring_timed(&pairer->triggers, pairer->triggers.known_last);
    return last && box_ns > last->box_ns + pairer->min_gap_ns / 2;
}

int pair_seek_by_camera(const opms_pairer_t *pairer, pair_candidate_t *found)
{
    const pair_camera_clock_t *camera = &pairer->camera;
    uint32_t count = 0, on_time = 0;
    *found = (pair_candidate_t){.witnesses = OPMS_WITNESS_FRAME_ID | OPMS_WITNESS_CAMERA_TIME};
    for (uint32_t i = 0; camera->valid && i < recent_frames(pairer); ++i) {
        const pair_seen_t *seen = pair_recent(pairer, i);
        if (!seen->has_id || !seen->has_camera || !seen->has_arrival ||
            seen->camera_ns <= camera->camera_ns) {
            continue; /* late ones and copies say nothing of what is now */
        }
        const int64_t box_ns = pair_camera_clock_box(camera, seen->camera_ns);
        if (is_ahead(pairer, box_ns)) {
            continue;
        }
        int64_t number = 0;
        const pair_trigger_t *trigger = pair_ring_nearest(&pairer->triggers, box_ns, &number);
        if (!trigger || llabs(box_ns - trigger->box_ns) >
                            pair_camera_clock_tolerance(camera, seen->camera_ns,
                                                        pairer->min_gap_ns)) {
            return 0;
        }
        const int64_t delay_ns = seen->arrival_box_ns - trigger->box_ns;
        const pair_timing_t timing = pair_judge_delay(pairer, delay_ns);
        if (timing == PAIR_EARLY || pair_is_too_late(pairer, delay_ns) ||
            (count > 0 && seen->id - number != found->offset)) {
            return 0;
        }
        found->offset = seen->id - number;
        found->first = seen;
        found->newest = count == 0 ? seen : found->newest;
        on_time += timing == PAIR_ON_TIME;
        const int returns = found->offset == pairer->lock.offset;
        if (++count >= CAMERA_FRAMES && (on_time > 0 || returns)) {
            found->witnesses |= on_time > 0 ? OPMS_WITNESS_ARRIVAL : 0;
            return 1;
        }
    }
    return 0;
}

/** The trigger whose frame would arrive right then. */
static int on_time_number(const opms_pairer_t *pairer, const pair_seen_t *seen, int64_t *number)
{
    const int64_t middle_ns =
        (pair_window_ns(pairer->min_gap_ns) - pair_slack_ns(pairer->min_gap_ns)) / 2;
    const int64_t box_ns = seen->arrival_box_ns - pair_floor_ns(&pairer->floor) - middle_ns;
    const pair_trigger_t *trigger = pair_ring_nearest(&pairer->triggers, box_ns, number);
    return trigger && pair_judge_delay(pairer, seen->arrival_box_ns - trigger->box_ns) ==
                          PAIR_ON_TIME;
}

/** Do two frames' stamps lie as far apart as these triggers of theirs? */
static int stamps_agree(const pair_seen_t *a, int64_t a_box_ns, const pair_seen_t *b,
                        int64_t b_box_ns)
{
    const int64_t apart_ns = a->camera_ns - b->camera_ns;
    const double allowed = STAMP_JITTER_NS + STAMP_DRIFT * fabs((double)apart_ns);
    return (double)llabs(apart_ns - (a_box_ns - b_box_ns)) <= allowed;
}

typedef struct tally {
    uint32_t fits, on_time, odd;
} tally_t;

/** Does a frame fit the offset of the newest one? */
static int fits_offset(const opms_pairer_t *pairer, const pair_candidate_t *found,
                       const pair_seen_t *seen, pair_timing_t *timing)
{
    const pair_ring_t *ring = &pairer->triggers;
    const int64_t number = seen->id - found->offset;
    const pair_trigger_t *trigger = pair_ring_timed(ring, number);
    const pair_trigger_t *newest = pair_ring_timed(ring, found->newest->id - found->offset);
    *timing = PAIR_LATE;
    if (!trigger) { /* not reported: it says nothing */
        return pair_ring_at(ring, number) != NULL;
    }
    const int64_t delay_ns = seen->arrival_box_ns - trigger->box_ns;
    *timing = pair_judge_delay(pairer, delay_ns);
    if (*timing == PAIR_EARLY || pair_is_too_late(pairer, delay_ns)) {
        return 0;
    }
    if (trigger->strobe == PAIR_STROBE_ABSENT && !found->without_strobe) {
        return 0; /* nothing was exposed then */
    }
    return !seen->has_camera || !found->newest->has_camera ||
           stamps_agree(seen, trigger->box_ns, found->newest, newest->box_ns);
}

static int is_enough(const opms_pairer_t *pairer, const pair_candidate_t *found,
                     const tally_t *tally)
{
    /* That the strobe speaks against them is one fault; late frames would be a second one. */
    if (found->without_strobe && tally->on_time < tally->fits) {
        return 0;
    }
    if (found->newest->has_camera) {
        return tally->fits >= RESTART_FRAMES && tally->on_time >= RESTART_ON_TIME;
    }
    const int returns = pairer->lock.ever && found->offset == pairer->lock.offset &&
                        !found->without_strobe;
    return tally->odd == 0 &&
           ((tally->fits >= ARRIVAL_FRAMES && tally->on_time >= ARRIVAL_ON_TIME) ||
            (returns && tally->fits >= RETURN_FRAMES && tally->on_time == tally->fits));
}

int pair_seek_by_arrival(const opms_pairer_t *pairer, uint32_t ways, pair_candidate_t *found)
{
    const int with_copies = (ways & PAIR_SEEK_COPIES) != 0;
    tally_t tally = {0, 0, 0};
    *found = (pair_candidate_t){.witnesses = OPMS_WITNESS_FRAME_ID | OPMS_WITNESS_ARRIVAL,
                                .without_strobe = (ways & PAIR_SEEK_NO_STROBE) != 0};
    for (uint32_t i = 0; pairer->floor.known && i < recent_frames(pairer); ++i) {
        const pair_seen_t *seen = pair_recent(pairer, i);
        if (i == 0 && seen->seen_before && !with_copies) {
            return 0; /* what is now counts, and this may be it */
        }
        if ((seen->seen_before && !with_copies) || !seen->has_id || !seen->has_arrival ||
            (!found->newest &&
             is_ahead(pairer, seen->arrival_box_ns - pair_floor_ns(&pairer->floor)))) {
            continue;
        }
        pair_timing_t timing = PAIR_ON_TIME;
        int64_t number = 0;
        if (!found->newest) {
            if (!on_time_number(pairer, seen, &number)) {
                return 0;
            }
            found->newest = seen;
            found->offset = seen->id - number;
        } else if (!fits_offset(pairer, found, seen, &timing)) {
            if (++tally.odd > RESTART_ODD) {
                return 0;
            }
            continue;
        }
        found->first = timing == PAIR_ON_TIME ? seen : found->first;
        ++tally.fits;
        tally.on_time += timing == PAIR_ON_TIME;
        if (is_enough(pairer, found, &tally)) {
            found->witnesses |= seen->has_camera ? OPMS_WITNESS_CAMERA_TIME : 0;
            return 1;
        }
    }
    return 0;
}
