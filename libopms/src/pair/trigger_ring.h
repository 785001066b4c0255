/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The last triggers of a session by their number, decided or not. */
#ifndef OPMS_PAIR_TRIGGER_RING_H
#define OPMS_PAIR_TRIGGER_RING_H

#include <stdint.h>

/** How a time is known; a better source replaces a worse one. */
typedef enum pair_source {
    PAIR_SOURCE_NONE = 0,
    PAIR_SOURCE_GAP = 1, /* from a later report, to 1 us */
    PAIR_SOURCE_HISTORY = 2,
    PAIR_SOURCE_REPORT = 3
} pair_source_t;

typedef enum pair_strobe {
    PAIR_STROBE_UNKNOWN = 0,
    PAIR_STROBE_SEEN = 1,
    PAIR_STROBE_ABSENT = 2
} pair_strobe_t;

typedef struct pair_trigger {
    int64_t box_ns; /* where it is not known: at or before the true one, and never falling */
    int64_t seen_host_ns; /* when the host first knew that it exists */
    int64_t strobe_delay_ns, strobe_length_ns;
    int64_t frame_id, frame_camera_ns; /* of the frame that it was paired with */
    uint8_t source;   /* pair_source_t */
    uint8_t strobe;   /* pair_strobe_t */
    uint8_t state;    /* opms_trigger_state_t; NONE: it waits */
    uint8_t preamble;
    uint8_t suspected;     /* a frame may be its own, but that is not certain */
    uint8_t contradicted;  /* two reports gave it two times */
} pair_trigger_t;

/** Triggers first to next - 1 exist; the last mask + 1 of them are held; those before `open` are
 * decided. */
typedef struct pair_ring {
    pair_trigger_t *slots;
    int64_t mask;
    int64_t first, open, next;
    int64_t known_last; /* newest number with a time; first - 1: none */
} pair_ring_t;

void pair_ring_start(pair_ring_t *ring, int64_t first);

/** The trigger, or NULL where it is not held. */
pair_trigger_t *pair_ring_at(const pair_ring_t *ring, int64_t number);

/** The trigger if its time is known, else NULL. */
const pair_trigger_t *pair_ring_timed(const pair_ring_t *ring, int64_t number);

/** Add trigger `next`, whose time is not known yet. The oldest one must be decided. */
void pair_ring_add(pair_ring_t *ring, int64_t seen_host_ns);

/** Give a trigger that is held its time. A time that cannot stand between those of its neighbours,
 * or that differs from what was known, is not believed.
 * @return 0 where it is not believed. */
int pair_ring_set_time(pair_ring_t *ring, int64_t number, int64_t box_ns, pair_source_t source);

/** The trigger with a known time nearest to a box time.
 * @param[out] number  Its number.
 * @return NULL where none has a time. */
const pair_trigger_t *pair_ring_nearest(const pair_ring_t *ring, int64_t box_ns, int64_t *number);

#endif
