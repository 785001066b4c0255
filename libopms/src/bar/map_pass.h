/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * One pass of the refinement: measure squares, throw out what cannot be this bar's, fit. */
#ifndef OPMS_BAR_MAP_PASS_H
#define OPMS_BAR_MAP_PASS_H

#include "bar/map_refine.h"

/** By how much a pass moved the edges and changed the blur, and the range it confirmed. */
typedef struct pass_result {
    float moved_px, blurred_px;
    int low, high;
} pass_result_t;

/** Squares of a range that can be seen, at most `most` of them, evenly spread with both ends. */
int map_visible_squares(const edge_scene_t *scene, int from, int to, int most, int *index);

/** Measure the given squares where the scene expects them and move it to where they are.
 *
 * @param contrast  Least grey levels from black to white.
 * @param reach_px  Sides farther off are none of this bar's.
 * @return 0 when too little agrees. */
int map_pass(edge_scene_t *scene, const int *index, int count, float contrast, float reach_px,
             bar_fit_t *fit, pass_result_t *result);

/** Learn black and white from the stretches of a pass, those of one family of sides or, -1, of
 * both, and solve these again with them. */
void map_learn_levels(bar_fit_t *fit, int family);

/** Mean logarithm of the variance that a pass left of the pixels: the same pixels under two models
 * tell apart what two noises would not. */
double map_misfit(const bar_fit_t *fit);

#endif
