/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Where the map expects the four sides of a square in the picture. */
#ifndef OPMS_BAR_SIDE_CURVE_H
#define OPMS_BAR_SIDE_CURVE_H

#include <opms/types.h>

#include "bar/plane_map.h"

/** A side as a parabola through three projected points. */
typedef struct side_curve {
    int seen;              /**< 0: behind the camera or too small, nothing else holds */
    int along_axis;        /**< 0: lines of pixels are columns, 1: rows */
    double p0[2], p1[2], p2[2]; /**< px(tau) = p0 + tau p1 + tau^2 p2, tau = -1..1 over 20 mm */
    double normal[2];      /**< outward, at the middle */
    double cosine;         /**< of the angle between the normal and the direction of the lines */
    double sign;           /**< of that direction, +1 when the coordinate grows outwards */
    double px_per_mm;      /**< across the side, outwards */
    double half_px;        /**< half the side's length */
    double border_px;      /**< distance of the bar's border beyond the sides along Y, else 0 */
    double along_mm[2];    /**< gradient of the position along the side, mm per px of u and v, */
    double along_turn[2];  /**< its change by tau: the ends are seldom parallel in the picture */
} side_curve_t;

/** Sides in the order X = -10, Y = -10, X = +10, Y = +10 mm. */
void side_curves(const plane_map_t *map, const opms_lens_t *lens, double ray_limit, int square,
                 side_curve_t curve[4]);

/** Cosine of the angle between the normals of the side and of its ends: 0 at right angles. */
double side_curve_lean(const side_curve_t *curve);

#endif
