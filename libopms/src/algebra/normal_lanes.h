/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The normal distribution of four numbers at a time: what a blurred step looks like. Computed,
 * since a vector unit cannot look up four places of a table at once. */
#ifndef OPMS_ALGEBRA_NORMAL_LANES_H
#define OPMS_ALGEBRA_NORMAL_LANES_H

#include "algebra/lanes.h"

#define NORMAL_REACH 5.f /**< standard deviations */

typedef struct normal_lanes {
    lanes_t step;  /**< the distribution, 0 to 1 */
    lanes_t pulse; /**< the density, derivative of the step */
} normal_lanes_t;

/** 2^y for y from -64 to 0, over sqrt(2 pi): the whole part goes to the exponent, the rest is a
 * minimax polynomial on -1 to 0 (relative error below 3e-6). */
static inline lanes_t exp2_density(lanes_t y)
{
    const lanes_int_t whole = __builtin_convertvector(y, lanes_int_t);
    const lanes_t f = y - __builtin_convertvector(whole, lanes_t);
    const lanes_t p =
        0.398941246f +
        f * (0.27647905f + f * (0.0954832753f + f * (0.0211734898f + f * 0.0026996757f)));
    return (lanes_t)((lanes_int_t)p + whole * (1 << 23));
}

/** The unit normal distribution and its density at z standard deviations, beyond NORMAL_REACH as
 * there (errors below 3e-6).
 *
 * The tail over the density, Mills' ratio, is a minimax rational function on 0 to 5. */
static inline normal_lanes_t normal_lanes(lanes_t z)
{
    const lanes_t a = lanes_min(lanes_abs(z), lanes_of(NORMAL_REACH));
    const lanes_t pulse = exp2_density(a * a * -0.721347520f);
    const lanes_t tail = pulse * (1.25330881f + a * (0.207067773f + a * 0.00766575743f)) /
                         (1.f + a * (0.962886121f + a * 0.276054121f));
    const normal_lanes_t profile = {lanes_pick(z > 0.f, 1.f - tail, tail), pulse};
    return profile;
}

#endif
