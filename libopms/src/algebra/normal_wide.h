/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The normal distribution of eight numbers at a time: what a blurred step looks like. Computed,
 * since a vector unit cannot look up eight places of a table at once. */
#ifndef OPMS_ALGEBRA_NORMAL_WIDE_H
#define OPMS_ALGEBRA_NORMAL_WIDE_H

#include "algebra/wide_lanes.h"

#define NORMAL_WIDE_REACH 5.f /**< standard deviations */

typedef struct normal_wide {
    wide_t step;  /**< the distribution, 0 to 1 */
    wide_t pulse; /**< the density, derivative of the step */
} normal_wide_t;

/** 2^y for y from -64 to 0, over sqrt(2 pi): the whole part goes to the exponent, the rest is a
 * minimax polynomial on -1 to 0 (relative error below 3e-6). */
WIDE_INLINE wide_t exp2_density(wide_t y)
{
    const wide_int_t whole = __builtin_convertvector(y, wide_int_t);
    const wide_t f = y - __builtin_convertvector(whole, wide_t);
    const wide_t ff = f * f;
    const wide_t p = (0.398941246f + f * 0.27647905f) +
                     ff * ((0.0954832753f + f * 0.0211734898f) + ff * 0.0026996757f);
    return (wide_t)((wide_int_t)p + whole * (1 << 23));
}

/** The unit normal distribution and its density at z standard deviations, beyond
 * NORMAL_WIDE_REACH as there (errors below 3e-6).
 *
 * The tail over the density, Mills' ratio, is a minimax rational function on 0 to 5, found beside
 * the density so that neither waits for the other. */
WIDE_INLINE normal_wide_t normal_wide(wide_t z)
{
    const wide_t a = wide_min(wide_abs(z), wide_of(NORMAL_WIDE_REACH));
    const wide_t pulse = exp2_density(a * a * -0.721347520f);
    const wide_t ratio = (1.25330881f + a * (0.207067773f + a * 0.00766575743f)) /
                         (1.f + a * (0.962886121f + a * 0.276054121f));
    const wide_t tail = pulse * ratio;
    const normal_wide_t profile = {0.5f + wide_signed(0.5f - tail, z), pulse};
    return profile;
}

#endif
