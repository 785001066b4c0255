/* SPDX-License-Identifier: Apache-2.0 */
#include "pair/arrival_floor.h"

#define BLOCK 64
#define BLOCK_ALIKE 48
#define SLACK_MAX_NS 2000000  /* the host's clock is known to better than 1 ms */
#define WINDOW_MAX_NS 20000000

static int64_t least(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

static void start(pair_floor_t *floor, int64_t delay_ns)
{
    *floor = (pair_floor_t){.known = 1, .now_ns = delay_ns, .before_ns = delay_ns};
}

/** A block of late ones, most of them late by the same, is the new delay. */
static void learn_late(pair_floor_t *floor, int64_t delay_ns, int64_t window_ns)
{
    if (floor->late == 0 || delay_ns < floor->late_least_ns - window_ns) {
        floor->late_alike = 0;
    }
    if (floor->late == 0 || delay_ns < floor->late_least_ns) {
        floor->late_least_ns = delay_ns;
    }
    floor->late_alike += delay_ns <= floor->late_least_ns + window_ns;
    if (++floor->late < BLOCK) {
        return;
    }
    if (floor->late_alike >= BLOCK_ALIKE) {
        start(floor, floor->late_least_ns);
    }
    floor->late = 0;
}

void pair_floor_learn(pair_floor_t *floor, int64_t delay_ns, int64_t min_gap_ns)
{
    const int64_t window_ns = pair_window_ns(min_gap_ns);
    if (!floor->known) {
        start(floor, delay_ns);
    } else if (delay_ns > pair_floor_ns(floor) + window_ns) {
        learn_late(floor, delay_ns, window_ns);
        return;
    }
    floor->late = 0;
    floor->now_ns = floor->in_block == 0 ? delay_ns : least(floor->now_ns, delay_ns);
    if (++floor->in_block == BLOCK) {
        floor->before_ns = floor->now_ns;
        floor->in_block = 0;
    }
}

int64_t pair_floor_ns(const pair_floor_t *floor)
{
    return floor->in_block == 0 ? floor->before_ns : least(floor->now_ns, floor->before_ns);
}

int64_t pair_window_ns(int64_t min_gap_ns)
{
    return least(min_gap_ns / 8, WINDOW_MAX_NS);
}

int64_t pair_slack_ns(int64_t min_gap_ns)
{
    return least(min_gap_ns / 16, SLACK_MAX_NS);
}

pair_timing_t pair_floor_judge(const pair_floor_t *floor, int64_t delay_ns, int64_t min_gap_ns)
{
    const int64_t over_ns = delay_ns - pair_floor_ns(floor);
    if (over_ns < -pair_slack_ns(min_gap_ns)) {
        return PAIR_EARLY;
    }
    return over_ns <= pair_window_ns(min_gap_ns) ? PAIR_ON_TIME : PAIR_LATE;
}
