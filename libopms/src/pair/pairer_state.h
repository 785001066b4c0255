/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * All that a pairer holds. Seen by the files of this folder only. */
#ifndef OPMS_PAIR_PAIRER_STATE_H
#define OPMS_PAIR_PAIRER_STATE_H

#include <opms/pair.h>

#include "pair/arrival_floor.h"
#include "pair/camera_clock.h"
#include "pair/trigger_ring.h"
#include "pair/unwrap.h"

#define PAIR_RECENT 32   /* last frames that a lock is sought in */
#define PAIR_SEGMENTS 8  /* past locks whose offset late frames may still show */
#define PAIR_SUPPORTED 8 /* frames on time that wait for the next one */
#define PAIR_SIGHTINGS 512 /* last frames by their id, for what comes twice */
#define PAIR_NO_NUMBER INT64_MIN
/* Times of host and box are less than 18 years, those of a camera less than 73: their differences
 * never overflow. */
#define PAIR_TIME_LIMIT_NS ((int64_t)1 << 59)
#define PAIR_STAMP_LIMIT_NS ((int64_t)1 << 61)

/** What a frame waits for. */
typedef enum pair_phase {
    PAIR_PHASE_DECIDED = 0,
    PAIR_PHASE_TRIGGER,   /* its trigger's time */
    PAIR_PHASE_SUPPORTED, /* on time; the next frame must say the same */
    PAIR_PHASE_OFF_GRID,  /* between the triggers; the camera's clock is to be confirmed */
    PAIR_PHASE_PARKED,    /* a new lock */
    PAIR_PHASE_TWICE,     /* it seems to have come before; the lock is to be confirmed */
    PAIR_PHASE_STALE,     /* it seems to be old; the lock is to be confirmed */
    PAIR_PHASE_BARRED,    /* nothing but the end of its time */
    PAIR_PHASE_HELD       /* paired; the exposure's length is on its way */
} pair_phase_t;

/** What the witnesses say of a frame and a trigger. */
typedef struct pair_evidence {
    int64_t number;
    uint32_t witnesses, against;
    uint32_t known; /* OPMS_PAIR_HAS_CAMERA_RESIDUAL, OPMS_PAIR_HAS_ARRIVAL_DELAY */
    int64_t camera_residual_ns, arrival_delay_ns, id_residual;
} pair_evidence_t;

typedef struct pair_frame {
    opms_frame_t frame;
    int64_t id, camera_ns, arrival_box_ns;
    uint8_t has_id, has_camera, has_arrival;
    uint8_t phase;     /* pair_phase_t */
    uint8_t seen_before; /* a frame with its id came before */
    uint8_t later;     /* SUPPORTED: frames on time after it */
    uint8_t is_new;    /* id and stamp were beyond those of all before when it came */
    uint32_t camera_epoch; /* when it came */
    uint32_t lock_epoch;   /* when it was judged */
    uint64_t pairs_before;    /* of the lock by which it was judged */
    pair_evidence_t evidence; /* of the last judgement */
} pair_frame_t;

/** Frames that wait, in order of arrival: numbers tail to head - 1. */
typedef struct pair_queue {
    pair_frame_t *slots;
    uint64_t mask, tail, head;
    uint32_t pending; /* not decided */
} pair_queue_t;

/** A frame as a lock is sought with it. */
typedef struct pair_seen {
    uint64_t slot; /* in the queue, if it still waits */
    int64_t id, camera_ns, arrival_box_ns;
    uint8_t has_id, has_camera, has_arrival;
    uint8_t seen_before; /* perhaps a copy of one with the same id */
} pair_seen_t;

/** When a frame id was seen last. */
typedef struct pair_sighting {
    int valid;
    uint64_t frame_id, camera_time_ticks;
} pair_sighting_t;

/** Numbers over which a frame id offset was seen to hold. */
typedef struct pair_segment {
    int64_t offset, first, last;
} pair_segment_t;

typedef struct pair_lock {
    int ever;          /* a lock was had in this session */
    int64_t offset;    /* frame id less trigger number */
    int64_t first_id;  /* of the present lock */
    int64_t newest_id; /* of the newest trigger that was paired */
    uint32_t witnesses;
    uint32_t misses;   /* frames in a row that do not support it */
    uint32_t epoch;    /* another one with each new offset */
    uint64_t pairs;    /* by this offset */
    pair_segment_t segments[PAIR_SEGMENTS];
    uint32_t segment; /* the present one */
} pair_lock_t;

/** Results that wait to be polled. */
typedef struct pair_results {
    opms_pair_result_t *slots;
    uint32_t capacity, first, count;
    uint64_t sequence;
} pair_results_t;

struct opms_pairer {
    opms_pair_options_t options;
    opms_clock_t *clock;
    uint32_t clock_boot_id;
    int64_t max_wait_ns;
    uint32_t jump_max; /* most triggers that one report may add one by one */

    opms_pair_state_t state;
    uint32_t boot_id, session_id;
    int64_t min_gap_ns, period_ns, settle_ns;
    int64_t now_host_ns;
    uint32_t ended;
    int64_t start_edge_box_ns; /* 0: not known */

    pair_unwrap_t trigger_unwrap, id_unwrap, tick_unwrap;
    pair_ring_t triggers;
    pair_queue_t frames;
    pair_seen_t recent[PAIR_RECENT];
    uint64_t recent_count;
    pair_sighting_t sightings[PAIR_SIGHTINGS];
    uint64_t supported[PAIR_SUPPORTED]; /* queue slots */
    uint32_t supported_count;
    pair_lock_t lock;
    pair_camera_clock_t camera;
    pair_floor_t floor;

    pair_results_t results;
    opms_pair_counters_t counters;
};

static inline pair_frame_t *pair_queue_at(const pair_queue_t *queue, uint64_t slot)
{
    return &queue->slots[slot & queue->mask];
}

/** The n-th last frame, 0 the newest; n < recent_count and < PAIR_RECENT. */
static inline const pair_seen_t *pair_recent(const opms_pairer_t *pairer, uint32_t n)
{
    return &pairer->recent[(pairer->recent_count - 1 - n) % PAIR_RECENT];
}

#endif
