/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The profile of a blurred edge for four pixels at a time: what edge_profile.h looks up in a table,
 * computed, since a vector unit cannot look up four places at once. */
#ifndef OPMS_BAR_EDGE_LANES_H
#define OPMS_BAR_EDGE_LANES_H

#include "bar/edge_profile.h"
#include "bar/lanes.h"

typedef struct edge_lanes {
    lanes_t step;  /**< 0 on the dark side to 1 on the light one */
    lanes_t pulse; /**< derivative of the step */
} edge_lanes_t;

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

/** The unit Gaussian's profile at z standard deviations: the normal distribution and its density
 * (errors below 3e-6).
 *
 * The tail over the density, Mills' ratio, is a minimax rational function on 0 to 5. */
static inline edge_lanes_t edge_lanes(lanes_t z)
{
    const lanes_t a = lanes_min(lanes_abs(z), lanes_of((float)EDGE_PROFILE_REACH));
    const lanes_t pulse = exp2_density(a * a * -0.721347520f);
    const lanes_t tail = pulse * (1.25330881f + a * (0.207067773f + a * 0.00766575743f)) /
                         (1.f + a * (0.962886121f + a * 0.276054121f));
    const edge_lanes_t profile = {lanes_pick(z > 0.f, 1.f - tail, tail), pulse};
    return profile;
}

/** Profile at s px from the edge; the pulse is per px. */
static inline edge_lanes_t edge_lanes_blurred(const edge_blur_t *blur, lanes_t s)
{
    if (blur->box <= 0.f) {
        edge_lanes_t p = edge_lanes(s * blur->per_gauss);
        p.pulse *= blur->per_gauss;
        return p;
    }
    /* The box averages the Gaussian step from s - box/2 to s + box/2; the integral of the normal
     * distribution is z step + pulse. */
    const lanes_t high = (s + 0.5f * blur->box) * blur->per_gauss;
    const lanes_t low = (s - 0.5f * blur->box) * blur->per_gauss;
    const edge_lanes_t a = edge_lanes(low), b = edge_lanes(high);
    const edge_lanes_t p = {
        ((high * b.step + b.pulse) - (low * a.step + a.pulse)) * (blur->gauss * blur->per_box),
        (b.step - a.step) * blur->per_box};
    return p;
}

#endif
