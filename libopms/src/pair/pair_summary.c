/* SPDX-License-Identifier: Apache-2.0 */
/* What people and programs see of a pairer: names, counters, gaps. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/fail.h"
#include "pair/pairer_state.h"

#define STAGE "pair"

const char *opms_pair_state_name(opms_pair_state_t state)
{
    switch (state) {
    case OPMS_PAIR_CLOSED: return "CLOSED";
    case OPMS_PAIR_SEARCHING: return "SEARCHING";
    case OPMS_PAIR_LOCKED: return "LOCKED";
    case OPMS_PAIR_SUSPECT: return "SUSPECT";
    }
    return "?";
}

const char *opms_trigger_state_name(opms_trigger_state_t state)
{
    switch (state) {
    case OPMS_TRIGGER_NONE: return "NONE";
    case OPMS_TRIGGER_PAIRED: return "PAIRED";
    case OPMS_TRIGGER_MISSING: return "MISSING";
    case OPMS_TRIGGER_UNCERTAIN: return "UNCERTAIN";
    }
    return "?";
}

const char *opms_frame_state_name(opms_frame_state_t state)
{
    switch (state) {
    case OPMS_FRAME_NONE: return "NONE";
    case OPMS_FRAME_PAIRED: return "PAIRED";
    case OPMS_FRAME_ORPHAN: return "ORPHAN";
    case OPMS_FRAME_DUPLICATE: return "DUPLICATE";
    case OPMS_FRAME_STALE: return "STALE";
    case OPMS_FRAME_UNCERTAIN: return "UNCERTAIN";
    }
    return "?";
}

/** Count what waits by looking, not by subtracting: the sums would hold by themselves otherwise. */
static void count_pending(const opms_pairer_t *pairer, opms_pair_counters_t *counters)
{
    const pair_ring_t *ring = &pairer->triggers;
    for (int64_t n = ring->open; n < ring->next; ++n) {
        counters->triggers_pending += pair_ring_at(ring, n)->state == OPMS_TRIGGER_NONE;
    }
    const pair_queue_t *frames = &pairer->frames;
    for (uint64_t slot = frames->tail; slot < frames->head; ++slot) {
        const pair_frame_t *frame = pair_queue_at(frames, slot);
        counters->frames_pending += frame->phase != PAIR_PHASE_DECIDED;
        /* A pair that is held is still to come out: its trigger is not counted yet, either. */
        counters->triggers_pending += frame->phase == PAIR_PHASE_HELD;
    }
}

static int do_sums_hold(const opms_pair_counters_t *c)
{
    const uint64_t triggers =
        c->triggers_paired + c->triggers_missing + c->triggers_uncertain + c->triggers_pending;
    const uint64_t frames = c->frames_paired + c->frames_orphan + c->frames_duplicate +
                            c->frames_stale + c->frames_uncertain + c->frames_pending;
    return triggers == c->triggers && frames == c->frames && c->triggers_paired == c->frames_paired;
}

static void write_line(opms_pair_summary_t *summary)
{
    const opms_pair_counters_t *c = &summary->counters;
    snprintf(summary->line, sizeof summary->line,
             "%s: %llu of %llu triggers paired, %llu missing, %llu uncertain; frames: %llu orphan, "
             "%llu double, %llu stale, %llu uncertain",
             opms_pair_state_name(summary->state), (unsigned long long)c->triggers_paired,
             (unsigned long long)c->triggers, (unsigned long long)c->triggers_missing,
             (unsigned long long)c->triggers_uncertain, (unsigned long long)c->frames_orphan,
             (unsigned long long)c->frames_duplicate, (unsigned long long)c->frames_stale,
             (unsigned long long)c->frames_uncertain);
}

void opms_pairer_summary(const opms_pairer_t *pairer, opms_pair_summary_t *summary)
{
    if (!summary) {
        return;
    }
    memset(summary, 0, sizeof *summary);
    if (!pairer) {
        return;
    }
    summary->state = pairer->state;
    summary->counters = pairer->counters;
    count_pending(pairer, &summary->counters);
    summary->sums_hold = (uint32_t)do_sums_hold(&summary->counters);
    summary->lock_witnesses = pairer->lock.witnesses;
    summary->ended = pairer->ended;
    summary->arrival_floor_ns = pairer->floor.known ? pair_floor_ns(&pairer->floor) : 0;
    summary->camera_drift_ppb = llround(pairer->camera.drift * 1e9);
    opms_clock_get(pairer->clock, &summary->clock);
    write_line(summary);
}

/** Is there something about this trigger that HISTORY could tell? */
static int is_gap(const opms_pairer_t *pairer, int64_t number)
{
    const pair_trigger_t *trigger = pair_ring_at(&pairer->triggers, number);
    if (!trigger || trigger->contradicted) {
        return 0;
    }
    const int no_time = trigger->source == PAIR_SOURCE_NONE && trigger->state == OPMS_TRIGGER_NONE;
    /* The next report tells the exposure; one that is two behind tells it no more. */
    const int no_strobe = pairer->options.camera.has_strobe &&
                          trigger->strobe == PAIR_STROBE_UNKNOWN &&
                          trigger->state == OPMS_TRIGGER_NONE &&
                          number + 2 < pairer->triggers.next;
    return no_time || no_strobe;
}

opms_status_t opms_pair_gaps(const opms_pairer_t *pairer, opms_pair_gap_t *gaps, uint32_t capacity,
                             uint32_t *count, opms_error_t *err)
{
    if (!pairer || !count || (!gaps && capacity > 0)) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL",
                         !pairer ? "pairer" : !count ? "count" : "gaps");
    }
    *count = 0;
    if (pairer->state == OPMS_PAIR_CLOSED) {
        return OPMS_OK;
    }
    int in_gap = 0;
    for (int64_t n = pairer->triggers.open; n < pairer->triggers.next; ++n) {
        if (!is_gap(pairer, n)) {
            in_gap = 0;
        } else if (in_gap) {
            ++gaps[*count - 1].count;
        } else if (*count < capacity) {
            gaps[(*count)++] = (opms_pair_gap_t){(uint32_t)n, 1};
            in_gap = 1;
        } else {
            break;
        }
    }
    return OPMS_OK;
}
