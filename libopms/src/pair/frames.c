/* SPDX-License-Identifier: Apache-2.0 */
/* Frames of the camera. */
#include "base/fail.h"
#include "pair/emit.h"
#include "pair/intake.h"
#include "pair/settle.h"

#define SECOND_NS 1000000000U
#define CLOCK_BOUND_MAX_NS 1500000 /* less than the slack that arrivals have */
#define CLOCK_AGE_FITTED_NS ((int64_t)60 * SECOND_NS)
#define CLOCK_AGE_COARSE_NS ((int64_t)10 * SECOND_NS)
#define BEFORE_NEW 8 /* frames before a new one that its stamp is beyond */

/** A camera time stamp in ns on a line that does not wrap. @return 0 where it makes none. */
static int unwrap_stamp(opms_pairer_t *pairer, uint64_t ticks, int64_t *camera_ns)
{
    const uint64_t hz = pairer->options.camera.camera_tick_hz;
    const int64_t unwrapped = pair_unwrap(&pairer->tick_unwrap, ticks);
    const uint64_t magnitude = unwrapped < 0 ? 0 - (uint64_t)unwrapped : (uint64_t)unwrapped;
    const uint64_t seconds = magnitude / hz;
    if (seconds >= (uint64_t)PAIR_STAMP_LIMIT_NS / SECOND_NS) {
        return 0;
    }
    const int64_t ns = (int64_t)(seconds * SECOND_NS + magnitude % hz * SECOND_NS / hz);
    *camera_ns = unwrapped < 0 ? -ns : ns;
    return 1;
}

/** When it arrived by the box's clock, where that is known well enough to tell a frame in time from
 * one that is not. */
static int read_arrival(const opms_pairer_t *pairer, int64_t arrival_host_ns, int64_t *box_ns)
{
    if (pairer->clock_boot_id != pairer->boot_id ||
        opms_clock_box_from_host(pairer->clock, arrival_host_ns, box_ns, NULL) != OPMS_OK) {
        return 0;
    }
    opms_clock_fit_t fit;
    opms_clock_get(pairer->clock, &fit);
    const int64_t age_ns = arrival_host_ns - fit.newest_host_ns;
    const int64_t age_max_ns =
        fit.state == OPMS_CLOCK_FITTED ? CLOCK_AGE_FITTED_NS : CLOCK_AGE_COARSE_NS;
    return fit.bound_ns <= CLOCK_BOUND_MAX_NS && age_ns <= age_max_ns;
}

/** Are its id and its stamp beyond those of all pairs, and its stamp beyond those of the last
 * frames, which may wait for their triggers yet? Else it may be of before the camera's start. */
static int is_new(const opms_pairer_t *pairer, const pair_frame_t *frame)
{
    if (!frame->has_id || !frame->has_camera || !pairer->camera.valid ||
        frame->id <= pairer->lock.newest_id || frame->camera_ns <= pairer->camera.camera_ns) {
        return 0;
    }
    for (uint32_t i = 0; i < BEFORE_NEW && i < pairer->recent_count; ++i) {
        const pair_seen_t *before = pair_recent(pairer, i);
        if (before->has_camera && before->camera_ns >= frame->camera_ns) {
            return 0;
        }
    }
    return 1;
}

static void read_header(opms_pairer_t *pairer, const opms_frame_t *header, pair_frame_t *frame)
{
    const opms_camera_profile_t *camera = &pairer->options.camera;
    *frame = (pair_frame_t){.frame = *header, .phase = PAIR_PHASE_PARKED};
    frame->evidence.number = PAIR_NO_NUMBER;
    if (camera->has_frame_id && !(header->flags & OPMS_FRAME_NO_ID)) {
        frame->has_id = 1;
        frame->id = pair_unwrap(&pairer->id_unwrap, header->frame_id);
    }
    if (camera->has_camera_time && !(header->flags & OPMS_FRAME_NO_TIME)) {
        frame->has_camera =
            (uint8_t)unwrap_stamp(pairer, header->camera_time_ticks, &frame->camera_ns);
    }
    frame->camera_epoch = pairer->camera.epoch;
    frame->is_new = (uint8_t)is_new(pairer, frame);
    frame->has_arrival =
        (uint8_t)read_arrival(pairer, header->arrival_host_ns, &frame->arrival_box_ns);
}

/** Is this the id of a frame that was paired, by the lock as it is or was last? */
static int has_paired_id(const opms_pairer_t *pairer, const pair_frame_t *frame)
{
    const pair_trigger_t *trigger =
        pair_ring_at(&pairer->triggers, frame->id - pairer->lock.offset);
    return pairer->lock.ever && trigger && trigger->state == OPMS_TRIGGER_PAIRED &&
           trigger->frame_id == frame->id;
}

/** Did this frame come before? Where the camera's time is the same, too, that is certain; an id
 * alone may be one that the camera counts for the second time. */
static int comes_twice(opms_pairer_t *pairer, pair_frame_t *frame)
{
    if (!frame->has_id) {
        return 0;
    }
    pair_sighting_t *last = &pairer->sightings[frame->frame.frame_id % PAIR_SIGHTINGS];
    const int same_id = last->valid && last->frame_id == frame->frame.frame_id;
    const int same_time = last->camera_time_ticks == frame->frame.camera_time_ticks;
    if (same_id && frame->has_camera && same_time) {
        return 1;
    }
    frame->seen_before = !frame->has_camera && (same_id || has_paired_id(pairer, frame));
    *last = (pair_sighting_t){1, frame->frame.frame_id, frame->frame.camera_time_ticks};
    return 0;
}

static void note_recent(opms_pairer_t *pairer, const pair_frame_t *frame, uint64_t slot)
{
    pairer->recent[pairer->recent_count++ % PAIR_RECENT] =
        (pair_seen_t){.slot = slot,
                      .id = frame->id,
                      .camera_ns = frame->camera_ns,
                      .arrival_box_ns = frame->arrival_box_ns,
                      .has_id = frame->has_id,
                      .has_camera = frame->has_camera,
                      .has_arrival = frame->has_arrival,
                      .seen_before = frame->seen_before};
}

opms_status_t opms_pairer_push_frame(opms_pairer_t *pairer, const opms_frame_t *frame,
                                     opms_error_t *err)
{
    OPMS_TRY(pair_check_input(pairer, frame, "frame", err));
    OPMS_TRY(pair_check_time(frame->arrival_host_ns, "frame.arrival_host_ns", err));
    pair_queue_t *frames = &pairer->frames;
    pair_set_now(pairer, frame->arrival_host_ns);
    if (frames->head - frames->tail > frames->mask) {
        pair_settle_oldest_frame(pairer);
    }
    const uint64_t slot = frames->head++;
    pair_frame_t *fresh = pair_queue_at(frames, slot);
    ++frames->pending;
    ++pairer->counters.frames;
    read_header(pairer, frame, fresh);
    if (pairer->state == OPMS_PAIR_CLOSED) {
        pair_emit_frame(pairer, fresh, OPMS_FRAME_STALE);
        frames->tail = frames->head;
    } else if (comes_twice(pairer, fresh)) {
        pair_emit_frame(pairer, fresh, OPMS_FRAME_DUPLICATE);
    } else {
        note_recent(pairer, fresh, slot);
        pair_settle_frame(pairer, slot, 0);
    }
    pair_go_on(pairer, frame->arrival_host_ns);
    return OPMS_OK;
}
