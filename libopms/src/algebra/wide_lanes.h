/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Eight floats at a time: one register where there is AVX2, two of any other vector unit, with the
 * same result to the last bit. All is inlined into functions that are compiled for either, see
 * WIDE_AVX2. Comparisons go by signs, which compilers keep in registers of any width. */
#ifndef OPMS_ALGEBRA_WIDE_LANES_H
#define OPMS_ALGEBRA_WIDE_LANES_H

#include <stdint.h>
#include <string.h>

#include "algebra/wide_doubles.h"

#define WIDE 8

typedef float wide_t __attribute__((vector_size(WIDE * sizeof(float))));
typedef int32_t wide_int_t __attribute__((vector_size(WIDE * sizeof(float))));
typedef float wide_half_t __attribute__((vector_size(WIDE / 2 * sizeof(float))));

WIDE_INLINE wide_t wide_of(float v)
{
    return (wide_t){v, v, v, v, v, v, v, v};
}

/** 0, 1, 2 ... 7 */
WIDE_INLINE wide_t wide_number(void)
{
    return (wide_t){0, 1, 2, 3, 4, 5, 6, 7};
}

WIDE_INLINE wide_t wide_load(const float *from)
{
    wide_t v;
    memcpy(&v, from, sizeof v);
    return v;
}

WIDE_INLINE void wide_store(float *to, wide_t v)
{
    memcpy(to, &v, sizeof v);
}

/** Eight whole numbers from 0 to 65535. */
WIDE_INLINE wide_t wide_load_short(const uint16_t *from)
{
    typedef uint16_t wide_short_t __attribute__((vector_size(WIDE * sizeof(uint16_t))));
    wide_short_t v;
    memcpy(&v, from, sizeof v);
    return __builtin_convertvector(__builtin_convertvector(v, wide_int_t), wide_t);
}

/** Set where a is less than b. */
WIDE_INLINE wide_int_t wide_less(wide_t a, wide_t b)
{
    return (wide_int_t)(a - b) >> 31;
}

/** The lanes from the first to the one before `count`, set. */
WIDE_INLINE wide_int_t wide_first(int count)
{
    static const int32_t set[2 * WIDE] = {-1, -1, -1, -1, -1, -1, -1, -1};
    const int some = count < WIDE ? count : WIDE;
    wide_int_t mask;
    memcpy(&mask, &set[WIDE - some], sizeof mask);
    return mask;
}

/** `v` where the mask is set, 0 elsewhere. */
WIDE_INLINE wide_t wide_where(wide_int_t mask, wide_t v)
{
    return (wide_t)(mask & (wide_int_t)v);
}

/** `yes` where the mask is set, `no` elsewhere. */
WIDE_INLINE wide_t wide_pick(wide_int_t mask, wide_t yes, wide_t no)
{
    return (wide_t)((mask & (wide_int_t)yes) | (~mask & (wide_int_t)no));
}

WIDE_INLINE wide_t wide_abs(wide_t v)
{
    return (wide_t)((wide_int_t)v & INT32_MAX);
}

/** `size` with its sign turned where `v` is negative. */
WIDE_INLINE wide_t wide_signed(wide_t size, wide_t v)
{
    return (wide_t)((wide_int_t)size ^ ((wide_int_t)v & INT32_MIN));
}

WIDE_INLINE wide_t wide_min(wide_t a, wide_t b)
{
    return wide_pick(wide_less(a, b), a, b);
}

WIDE_INLINE wide_t wide_max(wide_t a, wide_t b)
{
    return wide_pick(wide_less(a, b), b, a);
}

#ifdef __clang__
#define WIDE_HALF_SHUFFLE(a, b, p, q, r, s) __builtin_shufflevector(a, b, p, q, r, s)
#else
typedef int32_t wide_half_int_t __attribute__((vector_size(WIDE / 2 * sizeof(float))));
#define WIDE_HALF_SHUFFLE(a, b, p, q, r, s)                                                       \
    __builtin_shuffle(a, b, (wide_half_int_t){p, q, r, s})
#endif

WIDE_INLINE wide_half_t wide_half(const wide_t *v, int upper)
{
    wide_half_t half[2];
    memcpy(half, v, sizeof half);
    return half[upper];
}

/** The sums over the lower half of the lanes of each of four, then over the upper half. */
WIDE_INLINE void wide_half_sums(const wide_t v[4], float lower[4], float upper[4])
{
    for (int half = 0; half < 2; ++half) {
        const wide_half_t a = wide_half(&v[0], half), b = wide_half(&v[1], half);
        const wide_half_t c = wide_half(&v[2], half), d = wide_half(&v[3], half);
        const wide_half_t ab =
            WIDE_HALF_SHUFFLE(a, b, 0, 4, 1, 5) + WIDE_HALF_SHUFFLE(a, b, 2, 6, 3, 7);
        const wide_half_t cd =
            WIDE_HALF_SHUFFLE(c, d, 0, 4, 1, 5) + WIDE_HALF_SHUFFLE(c, d, 2, 6, 3, 7);
        const wide_half_t all =
            WIDE_HALF_SHUFFLE(ab, cd, 0, 1, 4, 5) + WIDE_HALF_SHUFFLE(ab, cd, 2, 3, 6, 7);
        memcpy(half ? upper : lower, &all, sizeof all);
    }
}

WIDE_INLINE float wide_sum(wide_t v)
{
    const wide_half_t half = wide_half(&v, 0) + wide_half(&v, 1);
    return (half[0] + half[2]) + (half[1] + half[3]);
}

WIDE_INLINE int wide_count(wide_int_t mask)
{
    int count = 0;
    for (int k = 0; k < WIDE; ++k) {
        count -= mask[k];
    }
    return count;
}

#endif
