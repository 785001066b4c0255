/* SPDX-License-Identifier: Apache-2.0 */
#include "pair/lock.h"

#include <stdlib.h>

#include "pair/lock_search.h"
#include "pair/settle.h"
#include "pair/supported.h"

/** Bar frames that came before this one in the queue from what the new lock says. */
static void bar_before(opms_pairer_t *pairer, uint64_t slot)
{
    pair_queue_t *frames = &pairer->frames;
    for (uint64_t i = frames->tail; i < frames->head && i < slot; ++i) {
        pair_frame_t *frame = pair_queue_at(frames, i);
        if (pair_waits_for_lock(frame) || frame->phase == PAIR_PHASE_TRIGGER) {
            frame->phase = PAIR_PHASE_BARRED;
        }
    }
}

/** Is the camera's clock another one than before? */
static int has_new_clock(const opms_pairer_t *pairer, const pair_seen_t *newest, int64_t box_ns)
{
    const pair_camera_clock_t *camera = &pairer->camera;
    return !camera->valid ||
           llabs(pair_camera_clock_box(camera, newest->camera_ns) - box_ns) >
               pair_camera_clock_tolerance(camera, newest->camera_ns, pairer->min_gap_ns);
}

static void take_camera_clock(opms_pairer_t *pairer, const pair_candidate_t *found, int64_t box_ns)
{
    const pair_seen_t *newest = found->newest;
    if (!newest->has_camera) {
        return;
    }
    if (!has_new_clock(pairer, newest, box_ns)) {
        pair_camera_clock_learn(&pairer->camera, newest->camera_ns, box_ns);
        return;
    }
    if (pairer->camera.valid) {
        ++pairer->counters.camera_restarts;
    }
    pair_camera_clock_start(&pairer->camera, newest->camera_ns, box_ns);
}

/** The numbers over which the new offset can hold begin behind those of the one before. */
static void take_offset(opms_pairer_t *pairer, const pair_candidate_t *found)
{
    pair_lock_t *lock = &pairer->lock;
    int64_t from = pairer->triggers.first;
    if (lock->ever) {
        from = lock->segments[lock->segment].last + 1;
        lock->segment = (lock->segment + 1) % PAIR_SEGMENTS;
        ++pairer->counters.id_changes;
    }
    lock->offset = found->offset;
    lock->pairs = 0;
    ++lock->epoch;
    lock->segments[lock->segment] = (pair_segment_t){found->offset, from, from - 1};
}

static void take_lock(opms_pairer_t *pairer, const pair_candidate_t *found, int by_pattern)
{
    pair_lock_t *lock = &pairer->lock;
    const int64_t newest_number = found->newest->id - found->offset;
    const int by_arrival = !(found->witnesses & OPMS_WITNESS_CAMERA_TIME);
    const int changed = !lock->ever || found->offset != lock->offset;
    take_camera_clock(pairer, found, pair_ring_at(&pairer->triggers, newest_number)->box_ns);
    if (changed) {
        pair_leave_supported(pairer, found->first->id - found->offset);
        take_offset(pairer, found);
        lock->first_id = found->first->id + (by_pattern ? 0 : 1);
        if (by_arrival && !by_pattern) {
            const int by_strobe = pairer->options.camera.has_strobe && !found->without_strobe;
            bar_before(pairer, by_strobe ? found->first->slot + 1 : pairer->frames.head);
        }
    }
    if (found->has_floor && !pairer->floor.known) {
        pair_floor_learn(&pairer->floor, found->floor_ns, pairer->min_gap_ns);
    }
    lock->ever = 1;
    lock->misses = 0;
    lock->witnesses = found->witnesses;
    pairer->state = OPMS_PAIR_LOCKED;
    ++pairer->counters.locks;
    pair_settle_again(pairer);
}

/** By arrivals, with as little taken for granted as will do. */
static int seek_by_any_arrival(const opms_pairer_t *pairer, pair_candidate_t *found)
{
    const uint32_t all = pairer->options.camera.has_strobe
                             ? (uint32_t)PAIR_SEEK_COPIES | PAIR_SEEK_NO_STROBE
                             : (uint32_t)PAIR_SEEK_COPIES;
    for (uint32_t ways = 0; ways <= all; ++ways) {
        if (pair_seek_by_arrival(pairer, ways, found)) {
            return 1;
        }
    }
    return 0;
}

void pair_seek_lock(opms_pairer_t *pairer)
{
    if (pairer->state != OPMS_PAIR_SEARCHING && pairer->state != OPMS_PAIR_SUSPECT) {
        return;
    }
    pair_candidate_t found = {0};
    if (pair_seek_by_camera(pairer, &found) || seek_by_any_arrival(pairer, &found)) {
        take_lock(pairer, &found, 0);
    } else if (!pairer->lock.ever && pair_seek_by_pattern(pairer, &found)) {
        take_lock(pairer, &found, 1);
    }
}
