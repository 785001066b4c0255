/* SPDX-License-Identifier: Apache-2.0 */
#include "pair/supported.h"

#include <string.h>

#include "pair/emit.h"
#include "pair/judge.h"

void pair_commit(opms_pairer_t *pairer, pair_frame_t *frame)
{
    const pair_evidence_t *evidence = &frame->evidence;
    pair_trigger_t *trigger = pair_ring_at(&pairer->triggers, evidence->number);
    pair_lock_t *lock = &pairer->lock;
    trigger->state = OPMS_TRIGGER_PAIRED;
    trigger->frame_id = frame->id;
    trigger->frame_camera_ns = frame->camera_ns;
    frame->evidence.witnesses |= lock->witnesses & OPMS_WITNESS_PREAMBLE;
    if (frame->has_camera && pairer->camera.valid) {
        pair_camera_clock_learn(&pairer->camera, frame->camera_ns, trigger->box_ns);
    }
    if (evidence->known & OPMS_PAIR_HAS_ARRIVAL_DELAY) {
        pair_floor_learn(&pairer->floor, evidence->arrival_delay_ns, pairer->min_gap_ns);
    }
    pair_segment_t *segment = &lock->segments[lock->segment];
    if (frame->id - evidence->number == segment->offset) {
        ++lock->pairs;
        if (evidence->number > segment->last) {
            segment->last = evidence->number;
            lock->newest_id = frame->id;
        }
    }
    lock->misses = 0;
    if (pairer->options.camera.has_strobe && trigger->strobe == PAIR_STROBE_UNKNOWN) {
        frame->phase = PAIR_PHASE_HELD;
    } else {
        pair_emit_pair(pairer, frame);
    }
}

static pair_frame_t *supported_at(opms_pairer_t *pairer, uint32_t i)
{
    return pair_queue_at(&pairer->frames, pairer->supported[i]);
}

static void take_out(opms_pairer_t *pairer, uint32_t i)
{
    memmove(pairer->supported + i, pairer->supported + i + 1,
            (pairer->supported_count - i - 1) * sizeof pairer->supported[0]);
    --pairer->supported_count;
}

/** Is the trigger still free? Two frames of one trigger cannot both be its own. */
static int is_free(const opms_pairer_t *pairer, const pair_frame_t *frame)
{
    const pair_trigger_t *trigger = pair_ring_at(&pairer->triggers, frame->evidence.number);
    return trigger && trigger->state == OPMS_TRIGGER_NONE;
}

static void commit_or_bar(opms_pairer_t *pairer, pair_frame_t *frame)
{
    if (is_free(pairer, frame)) {
        pair_commit(pairer, frame);
    } else {
        frame->phase = PAIR_PHASE_BARRED;
    }
}

void pair_support(opms_pairer_t *pairer, uint64_t slot)
{
    pair_frame_t *fresh = pair_queue_at(&pairer->frames, slot);
    pairer->lock.misses = 0;
    for (uint32_t i = 0; i < pairer->supported_count; ++i) {
        pair_frame_t *frame = supported_at(pairer, i);
        if (frame->id == fresh->id) { /* came twice before it was decided */
            fresh->phase = PAIR_PHASE_BARRED;
            fresh->seen_before = 1;
            return;
        }
    }
    uint32_t later = 0;
    for (uint32_t i = 0; i < pairer->supported_count;) {
        pair_frame_t *frame = supported_at(pairer, i);
        if (frame->id > fresh->id) {
            ++later;
            ++i;
        } else if (frame->id + 1 == fresh->id || ++frame->later >= 2) {
            take_out(pairer, i);
            commit_or_bar(pairer, frame);
        } else {
            ++i;
        }
    }
    fresh->later = (uint8_t)later;
    if (later >= 2) {
        commit_or_bar(pairer, fresh);
        return;
    }
    if (pairer->supported_count == PAIR_SUPPORTED) {
        supported_at(pairer, 0)->phase = PAIR_PHASE_BARRED;
        take_out(pairer, 0);
    }
    fresh->phase = PAIR_PHASE_SUPPORTED;
    pairer->supported[pairer->supported_count++] = slot;
}

/** Does a frame's id follow upon that of the pair before? */
static int follows_a_pair(const opms_pairer_t *pairer, const pair_frame_t *frame)
{
    const pair_trigger_t *before = pair_ring_at(&pairer->triggers, frame->evidence.number - 1);
    return before && before->state == OPMS_TRIGGER_PAIRED && before->frame_id == frame->id - 1;
}

/** Could this frame be the true one of the trigger that the other is on time for? */
static int competes(const opms_pairer_t *pairer, const pair_frame_t *frame,
                    const pair_frame_t *other)
{
    const pair_trigger_t *trigger = pair_ring_at(&pairer->triggers, other->evidence.number);
    return !trigger || !frame->has_arrival ||
           pair_judge_delay(pairer, frame->arrival_box_ns - trigger->box_ns) == PAIR_ON_TIME;
}

static void end_supported(opms_pairer_t *pairer, pair_frame_t *frame, int is_alone)
{
    if (is_alone && follows_a_pair(pairer, frame)) {
        commit_or_bar(pairer, frame);
    } else {
        frame->phase = PAIR_PHASE_BARRED;
    }
}

void pair_bar_supported(opms_pairer_t *pairer, const pair_frame_t *contradicting)
{
    for (uint32_t i = 0; i < pairer->supported_count; ++i) {
        pair_frame_t *frame = supported_at(pairer, i);
        end_supported(pairer, frame, !competes(pairer, contradicting, frame));
    }
    pairer->supported_count = 0;
}

void pair_leave_supported(opms_pairer_t *pairer, int64_t from_number)
{
    for (uint32_t i = 0; i < pairer->supported_count; ++i) {
        pair_frame_t *frame = supported_at(pairer, i);
        end_supported(pairer, frame, frame->evidence.number < from_number);
    }
    pairer->supported_count = 0;
}

void pair_end_supported(opms_pairer_t *pairer, int64_t number)
{
    for (uint32_t i = 0; i < pairer->supported_count; ++i) {
        pair_frame_t *frame = supported_at(pairer, i);
        if (frame->evidence.number != number) {
            continue;
        }
        take_out(pairer, i);
        end_supported(pairer, frame, 1);
        return;
    }
}
