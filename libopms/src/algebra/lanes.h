/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Four floats at a time, as every vector unit has them (SSE2, NEON). Without one the compiler
 * takes them one by one, with the same result. */
#ifndef OPMS_ALGEBRA_LANES_H
#define OPMS_ALGEBRA_LANES_H

#include <stdint.h>
#include <string.h>

#define LANES 4

typedef float lanes_t __attribute__((vector_size(LANES * sizeof(float))));
typedef int32_t lanes_int_t __attribute__((vector_size(LANES * sizeof(float))));

static inline lanes_t lanes_of(float v)
{
    return (lanes_t){v, v, v, v};
}

static inline lanes_t lanes_load(const float *from)
{
    lanes_t v;
    memcpy(&v, from, sizeof v);
    return v;
}

static inline void lanes_store(float *to, lanes_t v)
{
    memcpy(to, &v, sizeof v);
}

static inline float lanes_sum(lanes_t v)
{
    return (v[0] + v[1]) + (v[2] + v[3]);
}

/** `yes` where the mask is set, `no` elsewhere; masks come of comparisons of lanes. */
static inline lanes_t lanes_pick(lanes_int_t mask, lanes_t yes, lanes_t no)
{
    return (lanes_t)((mask & (lanes_int_t)yes) | (~mask & (lanes_int_t)no));
}

static inline lanes_t lanes_abs(lanes_t v)
{
    return (lanes_t)((lanes_int_t)v & INT32_MAX);
}

static inline lanes_t lanes_min(lanes_t a, lanes_t b)
{
    return lanes_pick(a < b, a, b);
}

static inline lanes_t lanes_max(lanes_t a, lanes_t b)
{
    return lanes_pick(a > b, a, b);
}

#endif
