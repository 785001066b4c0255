/* SPDX-License-Identifier: Apache-2.0 */
/* Two ways, by what there is. With camera time: it names the trigger by itself to a fraction of a
 * millisecond, the frame id must name the same one, arrival must not exclude it. Without: the id
 * names the trigger and the arrival must be on time; as a frame may be late by whole periods, that
 * pair stands only when the next frames say the same. */
#include "pair/judge.h"

#include <stdlib.h>

pair_timing_t pair_judge_delay(const opms_pairer_t *pairer, int64_t delay_ns)
{
    if (!pairer->floor.known) { /* nothing arrives before it was exposed */
        return delay_ns < -pair_slack_ns(pairer->min_gap_ns) ? PAIR_EARLY : PAIR_LATE;
    }
    return pair_floor_judge(&pairer->floor, delay_ns, pairer->min_gap_ns);
}

int pair_is_too_late(const opms_pairer_t *pairer, int64_t delay_ns)
{
    return delay_ns > pairer->max_wait_ns + pair_slack_ns(pairer->min_gap_ns);
}

/** Put the arrival of the frame of this trigger into the evidence. */
static pair_timing_t judge_arrival(const opms_pairer_t *pairer, pair_frame_t *frame,
                                   const pair_trigger_t *trigger)
{
    pair_evidence_t *evidence = &frame->evidence;
    if (!frame->has_arrival) {
        return PAIR_LATE;
    }
    evidence->arrival_delay_ns = frame->arrival_box_ns - trigger->box_ns;
    evidence->known |= OPMS_PAIR_HAS_ARRIVAL_DELAY;
    const pair_timing_t timing = pair_judge_delay(pairer, evidence->arrival_delay_ns);
    if (timing == PAIR_ON_TIME) {
        evidence->witnesses |= OPMS_WITNESS_ARRIVAL;
    } else if (pairer->floor.known) {
        evidence->against |= OPMS_WITNESS_ARRIVAL;
    }
    return timing;
}

static void judge_strobe(pair_frame_t *frame, const pair_trigger_t *trigger)
{
    if (trigger->strobe == PAIR_STROBE_SEEN) {
        frame->evidence.witnesses |= OPMS_WITNESS_STROBE;
    } else if (trigger->strobe == PAIR_STROBE_ABSENT) {
        frame->evidence.against |= OPMS_WITNESS_STROBE;
    }
}

static int came_too_late(const opms_pairer_t *pairer, const pair_frame_t *frame)
{
    return (frame->evidence.known & OPMS_PAIR_HAS_ARRIVAL_DELAY) &&
           pair_is_too_late(pairer, frame->evidence.arrival_delay_ns);
}

/** A frame whose trigger is settled already, or that came after the longest wait. */
static pair_verdict_t judge_settled(const opms_pairer_t *pairer, const pair_frame_t *frame,
                                    const pair_trigger_t *trigger)
{
    if (trigger->state == OPMS_TRIGGER_PAIRED) {
        if (trigger->frame_id != frame->id) {
            return PAIR_VERDICT_ALONE;
        }
        /* A copy has the very same stamp. Nearly the same: a camera that has started anew. */
        return trigger->frame_camera_ns == frame->camera_ns ? PAIR_VERDICT_DUPLICATE
                                                            : PAIR_VERDICT_CONTRADICTS;
    }
    return trigger->state != OPMS_TRIGGER_NONE || came_too_late(pairer, frame)
               ? PAIR_VERDICT_STALE
               : PAIR_VERDICT_PAIR;
}

/** Does this offset hold for this number, now or in a past lock? */
static int offset_holds(const opms_pairer_t *pairer, int64_t offset, int64_t number)
{
    const pair_lock_t *lock = &pairer->lock;
    if (offset == lock->offset && number >= lock->segments[lock->segment].first) {
        return 1;
    }
    for (uint32_t i = 0; i < PAIR_SEGMENTS; ++i) {
        const pair_segment_t *segment = &lock->segments[i];
        if (segment->offset == offset && number >= segment->first && number <= segment->last) {
            return 1;
        }
    }
    return 0;
}

/** The camera's clock names a trigger; is there a second witness? */
static pair_verdict_t judge_named(const opms_pairer_t *pairer, pair_frame_t *frame,
                                  const pair_trigger_t *trigger, int looking_back)
{
    pair_evidence_t *evidence = &frame->evidence;
    const int64_t offset = frame->id - evidence->number;
    const int has_offset = frame->has_id && offset_holds(pairer, offset, evidence->number);
    const pair_timing_t timing = judge_arrival(pairer, frame, trigger);
    evidence->witnesses |= OPMS_WITNESS_CAMERA_TIME;
    judge_strobe(frame, trigger);
    if (frame->has_arrival &&
        evidence->arrival_delay_ns < -pair_slack_ns(pairer->min_gap_ns)) {
        return PAIR_VERDICT_CONTRADICTS; /* here before it was exposed */
    }
    if (has_offset) {
        evidence->witnesses |= OPMS_WITNESS_FRAME_ID;
        return judge_settled(pairer, frame, trigger);
    }
    if (frame->has_id) {
        evidence->against |= OPMS_WITNESS_FRAME_ID;
        evidence->id_residual = offset - pairer->lock.offset;
    }
    const int known_on_both_sides = frame->camera_ns <= pairer->camera.camera_ns;
    if (looking_back && known_on_both_sides && timing == PAIR_ON_TIME) {
        return judge_settled(pairer, frame, trigger);
    }
    return known_on_both_sides || !frame->has_id ? PAIR_VERDICT_ALONE : PAIR_VERDICT_CONTRADICTS;
}

/** No trigger at the camera's time: before the first, between two, or not known yet? */
static pair_verdict_t judge_unnamed(const opms_pairer_t *pairer, const pair_frame_t *frame,
                                    int64_t box_ns, const pair_trigger_t *nearest, int64_t number)
{
    const pair_ring_t *ring = &pairer->triggers;
    if (!nearest) {
        return PAIR_VERDICT_TRIGGER;
    }
    const int before = box_ns < nearest->box_ns;
    if (before && number == ring->first) {
        return PAIR_VERDICT_STALE;
    }
    if (!pair_ring_timed(ring, before ? number - 1 : number + 1)) {
        return PAIR_VERDICT_TRIGGER; /* also behind the last one: its successors may be told yet */
    }
    /* One that was not new when it came may be of a camera that has started anew: no later pair
     * confirms its clock. */
    return frame->is_new ? PAIR_VERDICT_OFF_GRID : PAIR_VERDICT_ALONE;
}

static pair_verdict_t judge_by_camera(const opms_pairer_t *pairer, pair_frame_t *frame,
                                      int looking_back)
{
    const pair_camera_clock_t *camera = &pairer->camera;
    const int64_t box_ns = pair_camera_clock_box(camera, frame->camera_ns);
    const int64_t tolerance_ns =
        pair_camera_clock_tolerance(camera, frame->camera_ns, pairer->min_gap_ns);
    int64_t number = PAIR_NO_NUMBER;
    const pair_trigger_t *nearest = pair_ring_nearest(&pairer->triggers, box_ns, &number);
    if (nearest && llabs(box_ns - nearest->box_ns) <= tolerance_ns) {
        frame->evidence.number = number;
        frame->evidence.camera_residual_ns = box_ns - nearest->box_ns;
        frame->evidence.known |= OPMS_PAIR_HAS_CAMERA_RESIDUAL;
        return judge_named(pairer, frame, nearest, looking_back);
    }
    frame->evidence.against |= OPMS_WITNESS_CAMERA_TIME;
    if (frame->has_arrival &&
        (frame->arrival_box_ns < box_ns - pair_slack_ns(pairer->min_gap_ns) ||
         frame->arrival_box_ns - box_ns > pairer->max_wait_ns + pairer->settle_ns)) {
        return frame->has_id && frame->arrival_box_ns > box_ns &&
                       offset_holds(pairer, frame->id - number, number)
                   ? PAIR_VERDICT_STALE
                   : PAIR_VERDICT_CONTRADICTS; /* the camera's clock has started anew */
    }
    return judge_unnamed(pairer, frame, box_ns, nearest, number);
}

/** The id names a trigger that is not known (yet). */
static pair_verdict_t judge_untimed(const opms_pairer_t *pairer, const pair_frame_t *frame,
                                    int64_t number)
{
    const pair_ring_t *ring = &pairer->triggers;
    const pair_trigger_t *last = pair_ring_timed(ring, ring->known_last);
    if (number < ring->first) {
        const pair_trigger_t *first = pair_ring_timed(ring, ring->first);
        return first && frame->arrival_box_ns < first->box_ns ? PAIR_VERDICT_STALE
                                                               : PAIR_VERDICT_ALONE;
    }
    if (number >= ring->next && last && frame->arrival_box_ns < last->box_ns) {
        return PAIR_VERDICT_CONTRADICTS; /* older than a trigger before it */
    }
    const int held = number >= ring->next || pair_ring_at(ring, number);
    return held ? PAIR_VERDICT_TRIGGER : PAIR_VERDICT_ALONE;
}

static pair_verdict_t judge_by_arrival(const opms_pairer_t *pairer, pair_frame_t *frame)
{
    pair_evidence_t *evidence = &frame->evidence;
    if (!frame->has_id || !frame->has_arrival || frame->id < pairer->lock.first_id) {
        return PAIR_VERDICT_ALONE;
    }
    const int64_t number = frame->id - pairer->lock.offset;
    const pair_trigger_t *trigger = pair_ring_timed(&pairer->triggers, number);
    evidence->number = number;
    evidence->witnesses = OPMS_WITNESS_FRAME_ID;
    if (!trigger) {
        const pair_verdict_t untimed = judge_untimed(pairer, frame, number);
        if (untimed == PAIR_VERDICT_CONTRADICTS) {
            evidence->number = PAIR_NO_NUMBER;
        }
        return untimed;
    }
    const pair_timing_t timing = judge_arrival(pairer, frame, trigger);
    judge_strobe(frame, trigger);
    if (timing == PAIR_EARLY) {
        evidence->number = PAIR_NO_NUMBER;
        return PAIR_VERDICT_CONTRADICTS;
    }
    const pair_verdict_t settled = judge_settled(pairer, frame, trigger);
    if (settled != PAIR_VERDICT_PAIR) {
        return settled;
    }
    const int no_exposure = trigger->strobe == PAIR_STROBE_ABSENT;
    return timing == PAIR_ON_TIME && !no_exposure ? PAIR_VERDICT_SUPPORTED : PAIR_VERDICT_ALONE;
}

pair_verdict_t pair_judge(const opms_pairer_t *pairer, pair_frame_t *frame, int looking_back)
{
    frame->evidence = (pair_evidence_t){.number = PAIR_NO_NUMBER};
    return frame->has_camera && pairer->camera.valid
               ? judge_by_camera(pairer, frame, looking_back)
               : judge_by_arrival(pairer, frame);
}
