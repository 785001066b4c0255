/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How long after its trigger a frame arrives at least.
 *
 * A frame may be as late as it likes, but none is early: the smallest delay is a property of
 * exposure, readout and transport. It is learnt from pairs on time, as the least of the last one to
 * two blocks. Late frames teach nothing, however many they are: a queue that drains makes hundreds.
 * Only where a whole block is late by the same has the delay itself changed. */
#ifndef OPMS_PAIR_ARRIVAL_FLOOR_H
#define OPMS_PAIR_ARRIVAL_FLOOR_H

#include <stdint.h>

typedef struct pair_floor {
    int known;
    uint32_t in_block;
    int64_t now_ns, before_ns; /* least of this block and of the one before */
    uint32_t late, late_alike; /* in a row, and of them near the least one */
    int64_t late_least_ns;
} pair_floor_t;

typedef enum pair_timing {
    PAIR_EARLY, /* cannot be: it is another trigger's */
    PAIR_ON_TIME,
    PAIR_LATE
} pair_timing_t;

/** Learn the delay of a pair. `min_gap_ns` is the shortest gap between triggers. */
void pair_floor_learn(pair_floor_t *floor, int64_t delay_ns, int64_t min_gap_ns);

int64_t pair_floor_ns(const pair_floor_t *floor);

/** Judge a delay. The window from early to late is less than a quarter of the shortest gap. */
pair_timing_t pair_floor_judge(const pair_floor_t *floor, int64_t delay_ns, int64_t min_gap_ns);

/** Width of what is on time, and of what is no more than jitter before it. */
int64_t pair_window_ns(int64_t min_gap_ns);
int64_t pair_slack_ns(int64_t min_gap_ns);

#endif
