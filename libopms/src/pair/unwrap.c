/* SPDX-License-Identifier: Apache-2.0 */
#include "pair/unwrap.h"

/** What `number` is modulo the counter's period, 0 to period - 1. */
static uint64_t phase_of(int64_t number, uint64_t period)
{
    const int64_t rest = number % (int64_t)period;
    return (uint64_t)(rest < 0 ? rest + (int64_t)period : rest);
}

static int64_t nearest(int64_t last, uint64_t phase, uint64_t period)
{
    const uint64_t ahead = (phase + period - phase_of(last, period)) % period;
    return ahead < period - ahead ? last + (int64_t)ahead : last - (int64_t)(period - ahead);
}

int64_t pair_unwrap(pair_unwrap_t *counter, uint64_t raw)
{
    const uint64_t mask = counter->bits >= 64 ? UINT64_MAX : ((uint64_t)1 << counter->bits) - 1;
    /* Without 0 there are `mask` numbers, 1 to mask; an impossible 0 is taken for 1. */
    uint64_t phase = raw & mask;
    uint64_t period = mask;
    if (counter->skips_0) {
        phase = phase > 0 ? phase - 1 : 0;
    } else {
        ++period; /* 0 for 64 bit */
    }
    if (counter->bits >= 62) { /* no wrap in the life of a camera */
        counter->last = (int64_t)(phase & INT64_MAX / 2);
    } else if (!counter->started) {
        counter->last = (int64_t)phase;
    } else {
        counter->last = nearest(counter->last, phase, period);
    }
    counter->started = 1;
    return counter->last;
}
