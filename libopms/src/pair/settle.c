/* SPDX-License-Identifier: Apache-2.0 */
#include "pair/settle.h"

#include <string.h>

#include "pair/emit.h"
#include "pair/judge.h"
#include "pair/supported.h"

#define MISSES_MAX 4 /* frames in a row that do not support the lock */
#define HOLD_MAX_NS 400000000
#define CONFIRMING_PAIRS 4 /* more than the frames on time that may still wait */

static void become_suspect(opms_pairer_t *pairer)
{
    if (pairer->state == OPMS_PAIR_LOCKED) {
        pairer->state = OPMS_PAIR_SUSPECT;
        ++pairer->counters.losses_of_lock;
    }
}

static void miss(opms_pairer_t *pairer)
{
    if (++pairer->lock.misses >= MISSES_MAX) {
        become_suspect(pairer);
    }
}

static int has_two_witnesses(const pair_frame_t *frame)
{
    const uint32_t both = OPMS_WITNESS_FRAME_ID | OPMS_WITNESS_CAMERA_TIME;
    return (frame->evidence.witnesses & both) == both;
}

static void act(opms_pairer_t *pairer, uint64_t slot, pair_verdict_t verdict, int looking_back)
{
    pair_frame_t *frame = pair_queue_at(&pairer->frames, slot);
    frame->lock_epoch = pairer->lock.epoch;
    frame->pairs_before = pairer->lock.pairs;
    switch (verdict) {
    case PAIR_VERDICT_PAIR:
        pair_commit(pairer, frame);
        return;
    case PAIR_VERDICT_SUPPORTED:
        pair_support(pairer, slot);
        return;
    case PAIR_VERDICT_DUPLICATE:
    case PAIR_VERDICT_STALE:
        frame->phase = verdict == PAIR_VERDICT_STALE ? PAIR_PHASE_STALE : PAIR_PHASE_TWICE;
        if (has_two_witnesses(frame)) {
            return; /* late, but what the lock expects */
        }
        break;
    case PAIR_VERDICT_TRIGGER:
        frame->phase = PAIR_PHASE_TRIGGER;
        if (frame->has_camera && pairer->camera.valid) {
            return; /* nothing is wrong with a report that is late */
        }
        break;
    case PAIR_VERDICT_OFF_GRID:
        frame->phase = PAIR_PHASE_OFF_GRID;
        break;
    case PAIR_VERDICT_ALONE:
        frame->phase = PAIR_PHASE_PARKED;
        break;
    case PAIR_VERDICT_CONTRADICTS:
        frame->phase = PAIR_PHASE_PARKED;
        if (!looking_back) {
            pair_bar_supported(pairer, frame);
            become_suspect(pairer);
        }
        break;
    }
    if (!looking_back) {
        miss(pairer);
    }
}

void pair_settle_frame(opms_pairer_t *pairer, uint64_t slot, int looking_back)
{
    pair_frame_t *frame = pair_queue_at(&pairer->frames, slot);
    if (pairer->state == OPMS_PAIR_LOCKED) {
        act(pairer, slot, pair_judge(pairer, frame, looking_back), looking_back);
    } else {
        frame->phase = PAIR_PHASE_PARKED;
    }
}

/** Has the exposure of a pair become known, or is it not worth waiting for any more? */
static int is_hold_over(const opms_pairer_t *pairer, const pair_frame_t *frame)
{
    const pair_trigger_t *trigger = pair_ring_at(&pairer->triggers, frame->evidence.number);
    const int64_t hold_ns =
        3 * pairer->period_ns < HOLD_MAX_NS ? 3 * pairer->period_ns : HOLD_MAX_NS;
    return !trigger || trigger->strobe != PAIR_STROBE_UNKNOWN ||
           pairer->triggers.known_last >= frame->evidence.number + 3 ||
           pairer->now_host_ns - frame->frame.arrival_host_ns > hold_ns;
}

/** Has a later pair shown that the camera's clock was right about a frame between two triggers? */
static int is_orphan(const opms_pairer_t *pairer, const pair_frame_t *frame)
{
    return frame->phase == PAIR_PHASE_OFF_GRID && pairer->state == OPMS_PAIR_LOCKED &&
           frame->camera_epoch == pairer->camera.epoch &&
           pairer->camera.camera_ns > frame->camera_ns;
}

/** Were enough pairs made by the lock since it judged a frame? Then the ids had not started anew
 * before it, and the id names its trigger. */
static int is_confirmed(const opms_pairer_t *pairer, const pair_frame_t *frame)
{
    return frame->lock_epoch == pairer->lock.epoch &&
           pairer->lock.pairs >= frame->pairs_before + CONFIRMING_PAIRS;
}

int pair_waits_for_lock(const pair_frame_t *frame)
{
    return frame->phase == PAIR_PHASE_PARKED || frame->phase == PAIR_PHASE_OFF_GRID ||
           frame->phase == PAIR_PHASE_TWICE || frame->phase == PAIR_PHASE_STALE;
}

void pair_settle_waiting(opms_pairer_t *pairer)
{
    pair_queue_t *frames = &pairer->frames;
    for (uint64_t slot = frames->tail; slot < frames->head; ++slot) {
        pair_frame_t *frame = pair_queue_at(frames, slot);
        if (frame->phase == PAIR_PHASE_HELD && is_hold_over(pairer, frame)) {
            pair_emit_pair(pairer, frame);
        } else if (is_orphan(pairer, frame)) {
            pair_emit_frame(pairer, frame, OPMS_FRAME_ORPHAN);
        } else if (frame->phase == PAIR_PHASE_TWICE && is_confirmed(pairer, frame)) {
            pair_emit_frame(pairer, frame, OPMS_FRAME_DUPLICATE);
        } else if (frame->phase == PAIR_PHASE_STALE && is_confirmed(pairer, frame)) {
            pair_emit_frame(pairer, frame, OPMS_FRAME_STALE);
        } else if (frame->phase == PAIR_PHASE_TRIGGER && pairer->state == OPMS_PAIR_LOCKED) {
            const uint32_t misses = pairer->lock.misses;
            pair_settle_frame(pairer, slot, 0);
            if (frame->phase == PAIR_PHASE_TRIGGER) {
                pairer->lock.misses = misses; /* it was counted when it came */
            }
        }
    }
}

void pair_settle_again(opms_pairer_t *pairer)
{
    pair_queue_t *frames = &pairer->frames;
    for (uint64_t slot = frames->tail; slot < frames->head; ++slot) {
        const pair_frame_t *frame = pair_queue_at(frames, slot);
        if (pair_waits_for_lock(frame) || frame->phase == PAIR_PHASE_TRIGGER) {
            pair_settle_frame(pairer, slot, 1);
        }
    }
}

/** May this frame, that waits, be the trigger's? */
static int may_own(const opms_pairer_t *pairer, const pair_frame_t *frame, int64_t number,
                   const pair_trigger_t *trigger)
{
    if (frame->phase == PAIR_PHASE_DECIDED || frame->phase == PAIR_PHASE_HELD) {
        return 0;
    }
    /* The frame id alone names nothing for certain: it may have started anew. */
    if (frame->evidence.number != PAIR_NO_NUMBER &&
        (frame->phase == PAIR_PHASE_SUPPORTED || is_confirmed(pairer, frame) ||
         (frame->evidence.witnesses & OPMS_WITNESS_CAMERA_TIME))) {
        return frame->evidence.number == number;
    }
    const int64_t delay_ns = frame->arrival_box_ns - trigger->box_ns;
    return !frame->has_arrival || (delay_ns >= 0 && !pair_is_too_late(pairer, delay_ns));
}

static opms_trigger_state_t end_of_trigger(const opms_pairer_t *pairer, int64_t number)
{
    const pair_trigger_t *trigger = pair_ring_at(&pairer->triggers, number);
    if (trigger->source == PAIR_SOURCE_NONE || trigger->suspected || !pairer->lock.ever) {
        return OPMS_TRIGGER_UNCERTAIN;
    }
    for (uint64_t slot = pairer->frames.tail; slot < pairer->frames.head; ++slot) {
        if (may_own(pairer, pair_queue_at(&pairer->frames, slot), number, trigger)) {
            return OPMS_TRIGGER_UNCERTAIN;
        }
    }
    return OPMS_TRIGGER_MISSING;
}

void pair_settle_oldest_trigger(opms_pairer_t *pairer)
{
    const int64_t number = pairer->triggers.open;
    pair_end_supported(pairer, number);
    if (pair_ring_at(&pairer->triggers, number)->state == OPMS_TRIGGER_NONE) {
        pair_emit_trigger(pairer, number, end_of_trigger(pairer, number));
    }
    ++pairer->triggers.open;
}

/** Mark the triggers that a frame without an answer may have been of. */
static void suspect_triggers(opms_pairer_t *pairer, const pair_frame_t *frame)
{
    pair_ring_t *ring = &pairer->triggers;
    for (int64_t n = ring->open; n < ring->next; ++n) {
        pair_trigger_t *trigger = pair_ring_at(ring, n);
        if (may_own(pairer, frame, n, trigger)) {
            trigger->suspected = 1;
        }
    }
}

static void end_frame(opms_pairer_t *pairer, uint64_t slot)
{
    pair_frame_t *frame = pair_queue_at(&pairer->frames, slot);
    if (frame->phase == PAIR_PHASE_HELD) {
        pair_emit_pair(pairer, frame);
    } else if (is_orphan(pairer, frame)) {
        pair_emit_frame(pairer, frame, OPMS_FRAME_ORPHAN);
    } else if (frame->phase != PAIR_PHASE_DECIDED) {
        if (frame->phase == PAIR_PHASE_SUPPORTED) {
            pair_end_supported(pairer, frame->evidence.number);
        }
        if (frame->phase == PAIR_PHASE_HELD) {
            pair_emit_pair(pairer, frame);
        } else if (frame->phase != PAIR_PHASE_DECIDED) {
            suspect_triggers(pairer, frame);
            pair_emit_frame(pairer, frame, OPMS_FRAME_UNCERTAIN);
        }
    }
}

static void drop_decided(pair_queue_t *frames)
{
    while (frames->tail < frames->head &&
           pair_queue_at(frames, frames->tail)->phase == PAIR_PHASE_DECIDED) {
        ++frames->tail;
    }
}

void pair_settle_oldest_frame(opms_pairer_t *pairer)
{
    end_frame(pairer, pairer->frames.tail);
    drop_decided(&pairer->frames);
}

static int is_trigger_over(const opms_pairer_t *pairer, const pair_trigger_t *trigger)
{
    int64_t due_ns = trigger->seen_host_ns;
    if (trigger->source != PAIR_SOURCE_NONE) {
        int64_t host_ns = 0;
        if (opms_clock_host_from_box(pairer->clock, trigger->box_ns, &host_ns, NULL) == OPMS_OK &&
            host_ns < due_ns) {
            due_ns = host_ns;
        }
    }
    return pairer->now_host_ns - due_ns > pairer->max_wait_ns + pairer->settle_ns;
}

static int is_frame_over(const opms_pairer_t *pairer, const pair_frame_t *frame)
{
    return pairer->now_host_ns - frame->frame.arrival_host_ns >
           pairer->max_wait_ns + pairer->settle_ns;
}

void pair_settle_expired(opms_pairer_t *pairer, int everything)
{
    pair_ring_t *ring = &pairer->triggers;
    while (ring->open < ring->next) {
        const pair_trigger_t *oldest = pair_ring_at(ring, ring->open);
        if (oldest->state != OPMS_TRIGGER_NONE) {
            ++ring->open;
        } else if (everything || is_trigger_over(pairer, oldest)) {
            pair_settle_oldest_trigger(pairer);
        } else {
            break;
        }
    }
    pair_queue_t *frames = &pairer->frames;
    drop_decided(frames);
    while (frames->tail < frames->head &&
           (everything || is_frame_over(pairer, pair_queue_at(frames, frames->tail)))) {
        pair_settle_oldest_frame(pairer);
    }
}
