/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Dark quadrilaterals: contour following on grey levels, four corners. */
#ifndef OPMS_BAR_QUAD_H
#define OPMS_BAR_QUAD_H

#include "image/view.h"

#define QUAD_POINTS_MAX 8192

typedef struct point {
    float x, y;
} point_t;

typedef struct quad {
    point_t
        corner[4]; /**< in turn; the sense is that of X to Y in the picture (clockwise as seen) */
    point_t centre;
    float shortest, longest; /**< sides, px */
    float black, white;      /**< grey levels that set the threshold */
} quad_t;

/** Longest contour and smallest side that are followed. */
typedef struct quad_limits {
    int longest_contour;
    float shortest_side;
} quad_limits_t;

/** Follow the contour of the dark region that holds (x, y) at a grey level and fit a quadrilateral.
 *
 * @param x, y    A pixel darker than the threshold.
 * @param points  Room for QUAD_POINTS_MAX contour points.
 * @return 1 when the contour is closed inside the picture and is a convex quadrilateral. */
int quad_trace(const view_t *view, int x, int y, float threshold, const quad_limits_t *limits,
               point_t *points, quad_t *quad);

#endif
