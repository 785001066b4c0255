/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The profile of a blurred edge: a step under a Gaussian, and under uniform motion besides. */
#ifndef OPMS_BAR_EDGE_PROFILE_H
#define OPMS_BAR_EDGE_PROFILE_H

#include <math.h>

#define EDGE_PROFILE_REACH 5
#define EDGE_PROFILE_STEPS 64 /* a unit */
#define EDGE_PROFILE_SIZE (2 * EDGE_PROFILE_REACH * EDGE_PROFILE_STEPS + 2)

typedef struct edge_profile {
    float step;  /**< 0 on the dark side to 1 on the light one */
    float pulse; /**< derivative of the step */
} edge_profile_t;

/** Entry i at z = i / 64 - 5: the normal distribution and its density. */
extern const edge_profile_t edge_profile_table[EDGE_PROFILE_SIZE];

/** A blur across an edge, px: Gaussian, and a box as wide as the picture moved during exposure. */
typedef struct edge_blur {
    float gauss, per_gauss;
    float box, per_box; /**< 0: still */
} edge_blur_t;

/** Blur with a total standard deviation `sigma`, of which `still` is not from motion. */
static inline edge_blur_t edge_blur_of(double sigma, double still)
{
    const double box = sigma > 1.15 * still ? sqrt(12.0 * (sigma * sigma - still * still)) : 0;
    const double gauss = box > 0 ? still : sigma;
    const edge_blur_t blur = {(float)gauss, (float)(1 / gauss), (float)box,
                              box > 0 ? (float)(1 / box) : 0.f};
    return blur;
}

/** The unit Gaussian's profile at z standard deviations; linear between entries (error below 1e-4).
 */
static inline edge_profile_t edge_profile(float z)
{
    float at = (z + (float)EDGE_PROFILE_REACH) * (float)EDGE_PROFILE_STEPS;
    at = at < 0.f ? 0.f : at;
    at = at > (float)(EDGE_PROFILE_SIZE - 2) ? (float)(EDGE_PROFILE_SIZE - 2) : at;
    const int i = (int)at;
    const float part = at - (float)i;
    const edge_profile_t a = edge_profile_table[i], b = edge_profile_table[i + 1];
    const edge_profile_t profile = {a.step + part * (b.step - a.step),
                                    a.pulse + part * (b.pulse - a.pulse)};
    return profile;
}

/** Profile at s px from the edge; the pulse is per px. */
static inline edge_profile_t edge_profile_blurred(const edge_blur_t *blur, float s)
{
    if (blur->box <= 0.f) {
        edge_profile_t p = edge_profile(s * blur->per_gauss);
        p.pulse *= blur->per_gauss;
        return p;
    }
    /* The box averages the Gaussian step from s - box/2 to s + box/2; the integral of the normal
     * distribution is z step + pulse. */
    const float high = (s + 0.5f * blur->box) * blur->per_gauss;
    const float low = (s - 0.5f * blur->box) * blur->per_gauss;
    const edge_profile_t a = edge_profile(low), b = edge_profile(high);
    const edge_profile_t p = {
        ((high * b.step + b.pulse) - (low * a.step + a.pulse)) * blur->gauss * blur->per_box,
        (b.step - a.step) * blur->per_box};
    return p;
}

#endif
