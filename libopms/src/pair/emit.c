/* SPDX-License-Identifier: Apache-2.0 */
#include "pair/emit.h"

#include <string.h>

static uint64_t triggers_waiting(const opms_pairer_t *pairer)
{
    const opms_pair_counters_t *c = &pairer->counters;
    return c->triggers - c->triggers_paired - c->triggers_missing - c->triggers_uncertain;
}

int pair_has_room(const opms_pairer_t *pairer, uint32_t more)
{
    return pairer->results.count + triggers_waiting(pairer) + pairer->frames.pending + more <=
           pairer->results.capacity;
}

static opms_pair_result_t *next_result(opms_pairer_t *pairer)
{
    pair_results_t *results = &pairer->results;
    opms_pair_result_t *result =
        &results->slots[(results->first + results->count++) % results->capacity];
    memset(result, 0, sizeof *result);
    result->sequence = results->sequence++;
    result->boot_id = pairer->boot_id;
    result->session_id = pairer->session_id;
    if (pairer->start_edge_box_ns != 0) {
        result->known |= OPMS_PAIR_HAS_START_EDGE;
        result->start_edge_box_ns = pairer->start_edge_box_ns;
    }
    return result;
}

/** Start and length of the exposure: as the box saw them, else as the profile states them. */
static void put_exposure(const opms_camera_profile_t *camera, const pair_trigger_t *trigger,
                         opms_pair_result_t *result)
{
    if (trigger->strobe == PAIR_STROBE_SEEN) {
        result->start_delay_ns = trigger->strobe_delay_ns;
        result->exposure_ns = trigger->strobe_length_ns;
        result->known |= OPMS_PAIR_HAS_START_DELAY | OPMS_PAIR_HAS_EXPOSURE |
                         OPMS_PAIR_START_DELAY_SEEN | OPMS_PAIR_EXPOSURE_SEEN;
    } else {
        if (camera->has_start_delay) {
            result->start_delay_ns = camera->start_delay_ns;
            result->known |= OPMS_PAIR_HAS_START_DELAY;
        }
        if (camera->has_exposure) {
            result->exposure_ns = camera->exposure_ns;
            result->known |= OPMS_PAIR_HAS_EXPOSURE;
        }
    }
    const uint32_t both = OPMS_PAIR_HAS_START_DELAY | OPMS_PAIR_HAS_EXPOSURE;
    if ((result->known & both) == both) {
        result->known |= OPMS_PAIR_HAS_MID_EXPOSURE;
    }
    result->mid_exposure_box_ns =
        trigger->box_ns + result->start_delay_ns + result->exposure_ns / 2;
}

static void put_trigger(const opms_pairer_t *pairer, int64_t number, opms_pair_result_t *result)
{
    const pair_trigger_t *trigger = pair_ring_at(&pairer->triggers, number);
    result->trigger_number = (uint64_t)number;
    result->trigger_count = 1;
    if (!trigger) {
        return;
    }
    if (trigger->source != PAIR_SOURCE_NONE) {
        result->known |= OPMS_PAIR_HAS_TRIGGER_TIME;
        result->trigger_box_ns = trigger->box_ns;
        put_exposure(&pairer->options.camera, trigger, result);
    }
    result->known |= trigger->source == PAIR_SOURCE_HISTORY ? OPMS_PAIR_FROM_HISTORY : 0;
    result->known |= trigger->source == PAIR_SOURCE_GAP ? OPMS_PAIR_FROM_GAP : 0;
    result->known |= trigger->strobe == PAIR_STROBE_ABSENT ? OPMS_PAIR_STROBE_MISSING : 0;
    result->known |= trigger->preamble ? OPMS_PAIR_PREAMBLE_PULSE : 0;
}

static void put_frame(const pair_frame_t *frame, opms_pair_result_t *result)
{
    const pair_evidence_t *evidence = &frame->evidence;
    result->frame = frame->frame;
    result->frame_number = frame->has_id ? (uint64_t)frame->id : 0;
    result->witnesses = evidence->witnesses;
    result->against = evidence->against;
    result->known |= evidence->known;
    result->camera_residual_ns = evidence->camera_residual_ns;
    result->arrival_delay_ns = evidence->arrival_delay_ns;
    result->id_residual = evidence->id_residual;
}

static void end_frame(opms_pairer_t *pairer, pair_frame_t *frame)
{
    frame->phase = PAIR_PHASE_DECIDED;
    --pairer->frames.pending;
}

void pair_emit_pair(opms_pairer_t *pairer, pair_frame_t *frame)
{
    opms_pair_result_t *result = next_result(pairer);
    result->trigger_state = OPMS_TRIGGER_PAIRED;
    result->frame_state = OPMS_FRAME_PAIRED;
    const pair_trigger_t *trigger = pair_ring_at(&pairer->triggers, frame->evidence.number);
    if (trigger && trigger->strobe == PAIR_STROBE_SEEN) {
        frame->evidence.witnesses |= OPMS_WITNESS_STROBE; /* it may have come after the others */
    }
    put_trigger(pairer, frame->evidence.number, result);
    put_frame(frame, result);
    end_frame(pairer, frame);
    ++pairer->counters.triggers_paired;
    ++pairer->counters.frames_paired;
}

void pair_emit_frame(opms_pairer_t *pairer, pair_frame_t *frame, opms_frame_state_t state)
{
    opms_pair_result_t *result = next_result(pairer);
    opms_pair_counters_t *counters = &pairer->counters;
    result->frame_state = state;
    put_frame(frame, result);
    end_frame(pairer, frame);
    switch (state) {
    case OPMS_FRAME_ORPHAN: ++counters->frames_orphan; break;
    case OPMS_FRAME_DUPLICATE: ++counters->frames_duplicate; break;
    case OPMS_FRAME_STALE: ++counters->frames_stale; break;
    case OPMS_FRAME_NONE:
    case OPMS_FRAME_PAIRED:
    case OPMS_FRAME_UNCERTAIN: ++counters->frames_uncertain; break;
    }
}

static void emit_triggers(opms_pairer_t *pairer, int64_t first, uint32_t count,
                          opms_trigger_state_t state)
{
    opms_pair_result_t *result = next_result(pairer);
    result->trigger_state = state;
    put_trigger(pairer, first, result);
    result->trigger_count = count;
    if (state == OPMS_TRIGGER_MISSING) {
        pairer->counters.triggers_missing += count;
    } else {
        pairer->counters.triggers_uncertain += count;
    }
}

void pair_emit_trigger(opms_pairer_t *pairer, int64_t number, opms_trigger_state_t state)
{
    pair_ring_at(&pairer->triggers, number)->state = (uint8_t)state;
    emit_triggers(pairer, number, 1, state);
}

void pair_emit_lost(opms_pairer_t *pairer, int64_t first, uint32_t count)
{
    emit_triggers(pairer, first, count, OPMS_TRIGGER_UNCERTAIN);
}
