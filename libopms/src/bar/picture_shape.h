/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What blur, motion and saturation make of all edges of a picture alike. */
#ifndef OPMS_BAR_PICTURE_SHAPE_H
#define OPMS_BAR_PICTURE_SHAPE_H

#include "bar/map_refine.h"

#define SHAPE_SATURATED_LEAST 0.05 /* part of these pixels that makes white saturated */

/** Part of the pixels next to the sides that is saturated. */
double shape_saturated_part(const bar_fit_t *fit);

/** Take over the blur that the last pass asks for. */
void shape_update_blur(edge_scene_t *scene, const bar_fit_t *fit);

/** How much each family of sides takes part in the common shift. */
void shape_update_gain(edge_scene_t *scene, const bar_fit_t *fit);

/** Note the scale at which the blur is as stated. */
void shape_scale(edge_scene_t *scene, const bar_fit_t *fit);

#endif
