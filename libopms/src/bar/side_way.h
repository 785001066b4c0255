/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How the sides of squares moved over the picture while the shutter was open. */
#ifndef OPMS_BAR_SIDE_WAY_H
#define OPMS_BAR_SIDE_WAY_H

#include "bar/edge_fit.h"

/** A side's way in the bar's plane, along X and Y: what the camera rises, the picture grows about
 * the point that it rises from. All is 0 where the picture stood still. */
typedef struct side_way {
    double mm[2];
    double by_rise[2]; /**< its derivative by the rise */
    double at_mm[2];   /**< middle of the side */
} side_way_t;

side_way_t side_way_of(const edge_scene_t *scene, int square, int side);

/** How far along the unit vector `normal` the mean of a side over its way lies beyond its middle
 * position, px: the picture's scale changes along the way, and with the camera's rise. */
double side_way_sag(const edge_scene_t *scene, const side_way_t *way, const double normal[2]);

#endif
