/* SPDX-License-Identifier: Apache-2.0 */
#include "pair/trigger_ring.h"

#include <stdlib.h>
#include <string.h>

#include <opms/pair.h>

#define SAME_TIME_NS 2500 /* gap fields are whole microseconds, and two of them add up */

void pair_ring_start(pair_ring_t *ring, int64_t first)
{
    ring->first = ring->open = ring->next = first;
    ring->known_last = first - 1;
}

static int64_t oldest_held(const pair_ring_t *ring)
{
    const int64_t held = ring->next - ring->mask - 1;
    return held > ring->first ? held : ring->first;
}

pair_trigger_t *pair_ring_at(const pair_ring_t *ring, int64_t number)
{
    if (number < oldest_held(ring) || number >= ring->next) {
        return NULL;
    }
    return &ring->slots[number & ring->mask];
}

const pair_trigger_t *pair_ring_timed(const pair_ring_t *ring, int64_t number)
{
    const pair_trigger_t *trigger = pair_ring_at(ring, number);
    return trigger && trigger->source != PAIR_SOURCE_NONE ? trigger : NULL;
}

void pair_ring_add(pair_ring_t *ring, int64_t seen_host_ns)
{
    const pair_trigger_t *last = pair_ring_at(ring, ring->next - 1);
    const int64_t floor_ns = last ? last->box_ns : 0;
    pair_trigger_t *fresh = &ring->slots[ring->next & ring->mask];
    memset(fresh, 0, sizeof *fresh);
    fresh->box_ns = floor_ns;
    fresh->seen_host_ns = seen_host_ns;
    ++ring->next;
}

/** May the trigger have this time, as its neighbours stand? They are nearly always known, so that
 * the way to the next known one is short. */
static int fits_between(const pair_ring_t *ring, int64_t number, int64_t box_ns)
{
    const pair_trigger_t *before = pair_ring_at(ring, number - 1);
    if (box_ns <= 0 || (before && box_ns <= before->box_ns)) {
        return 0;
    }
    for (int64_t n = number + 1; n <= ring->known_last; ++n) {
        const pair_trigger_t *after = pair_ring_timed(ring, n);
        if (after) {
            return box_ns < after->box_ns;
        }
    }
    return 1;
}

int pair_ring_set_time(pair_ring_t *ring, int64_t number, int64_t box_ns, pair_source_t source)
{
    pair_trigger_t *trigger = pair_ring_at(ring, number);
    if (trigger->source != PAIR_SOURCE_NONE) {
        if (llabs(box_ns - trigger->box_ns) > SAME_TIME_NS) {
            return 0;
        }
        if ((int)source <= trigger->source) {
            return 1;
        }
    } else if (!fits_between(ring, number, box_ns)) {
        return 0;
    }
    trigger->box_ns = box_ns;
    trigger->source = (uint8_t)source;
    for (int64_t n = number + 1; n < ring->next && !pair_ring_timed(ring, n); ++n) {
        pair_ring_at(ring, n)->box_ns = box_ns;
    }
    if (number > ring->known_last) {
        ring->known_last = number;
    }
    return 1;
}

const pair_trigger_t *pair_ring_nearest(const pair_ring_t *ring, int64_t box_ns, int64_t *number)
{
    int64_t low = oldest_held(ring), high = ring->known_last; /* times rise with numbers */
    if (high < low) {
        return NULL;
    }
    while (low < high) { /* the last trigger at or before, if any */
        const int64_t middle = low + (high - low + 1) / 2;
        if (ring->slots[middle & ring->mask].box_ns <= box_ns) {
            low = middle;
        } else {
            high = middle - 1;
        }
    }
    int64_t before = low, after = low + 1;
    while (before >= oldest_held(ring) && !pair_ring_timed(ring, before)) {
        --before;
    }
    while (after <= ring->known_last && !pair_ring_timed(ring, after)) {
        ++after;
    }
    const pair_trigger_t *left = pair_ring_timed(ring, before);
    const pair_trigger_t *right = pair_ring_timed(ring, after);
    const int use_right =
        right && (!left || right->box_ns - box_ns < llabs(box_ns - left->box_ns));
    *number = use_right ? after : before;
    return use_right ? right : left;
}
