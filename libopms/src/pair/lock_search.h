/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The search for what joins the camera's counting to the box's, in the last frames. */
#ifndef OPMS_PAIR_LOCK_SEARCH_H
#define OPMS_PAIR_LOCK_SEARCH_H

#include "pair/pairer_state.h"

/** A lock that the last frames agree on. */
typedef struct pair_candidate {
    int64_t offset;            /* frame id less trigger number */
    const pair_seen_t *first;  /* of the frames that speak for it */
    const pair_seen_t *newest; /* ... with a trigger whose time is known */
    uint32_t witnesses;
    int without_strobe;        /* the box may have seen no exposure of its frames */
    int has_floor;             /* the delays were not known before */
    int64_t floor_ns;
} pair_candidate_t;

/** By the camera's clock, which goes on while the ids have changed. */
int pair_seek_by_camera(const opms_pairer_t *pairer, pair_candidate_t *found);

/** What a search by arrival takes for granted. */
enum {
    PAIR_SEEK_COPIES = 1U << 0,   /* frames whose id was seen shortly before are new ones */
    PAIR_SEEK_NO_STROBE = 1U << 1 /* the box saw no exposure because its strobe input failed */
};

/** By arrivals, as late after their triggers as frames were before.
 * @param ways  PAIR_SEEK_ bits. */
int pair_seek_by_arrival(const opms_pairer_t *pairer, uint32_t ways, pair_candidate_t *found);

/** By gaps that no other part of the triggers repeats, such as the preamble's. */
int pair_seek_by_pattern(const opms_pairer_t *pairer, pair_candidate_t *found);

#endif
