/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The profile of an edge under a Gaussian blur of one: its step and its derivative, by table. */
#ifndef OPMS_BAR_EDGE_PROFILE_H
#define OPMS_BAR_EDGE_PROFILE_H

#define EDGE_PROFILE_REACH 5
#define EDGE_PROFILE_STEPS 64 /* a unit */
#define EDGE_PROFILE_SIZE (2 * EDGE_PROFILE_REACH * EDGE_PROFILE_STEPS + 2)

typedef struct edge_profile {
    float step;  /**< 0 on the dark side to 1 on the light one */
    float pulse; /**< derivative of the step */
} edge_profile_t;

extern const edge_profile_t edge_profile_table[EDGE_PROFILE_SIZE];

/** Profile at z standard deviations from the edge; linear between entries (error below 1e-5). */
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

#endif
