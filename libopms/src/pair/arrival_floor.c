/* SPDX-License-Identifier: Apache-2.0 */
#include "pair/arrival_floor.h"

#define BLOCK 64
#define SLACK_MAX_NS 2000000  /* the host's clock is known to better than 1 ms */
#define WINDOW_MAX_NS 20000000

static int64_t least(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

void pair_floor_learn(pair_floor_t *floor, int64_t delay_ns)
{
    if (!floor->known) {
        floor->known = 1;
        floor->in_block = 0;
        floor->now_ns = floor->before_ns = delay_ns;
    }
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
