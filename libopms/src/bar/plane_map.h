/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The projective map from the bar's plane to rays, and through the lens to pixels.
 *
 * The detector works with this map of eight parameters rather than a pose: it needs no decision
 * between the two solutions of a plane, and it takes up what a camera file has slightly wrong. */
#ifndef OPMS_BAR_PLANE_MAP_H
#define OPMS_BAR_PLANE_MAP_H

#include <opms/types.h>

#define PLANE_MAP_X_MM 10.0

/** ray ~ h (X / 10 mm, (Y - y0) / scale, 1), h[8] = 1, rows of h row-major. */
typedef struct plane_map {
    double h[9];
    double y0_mm, scale_mm;
} plane_map_t;

/** A correspondence: a point of the bar's plane and its ray. */
typedef struct plane_pair {
    double x_mm, y_mm;
    double ray[2];
} plane_pair_t;

/** Least-squares map from pairs (direct linear transformation). 1 if it exists. */
int plane_map_fit(plane_map_t *map, const plane_pair_t *pairs, int count);

/** Pixel of a point of the plane. `jac` is NULL or 2 x 2 d(u, v)/d(X_mm, Y_mm). 0 behind the camera
 * or farther from the axis than `ray_limit`. */
int plane_map_project(const plane_map_t *map, const opms_lens_t *lens, double ray_limit,
                      double x_mm, double y_mm, double px[2], double *jac);

/** Distance of the camera from the plane, mm; its sign is that of Z. */
double plane_map_height(const plane_map_t *map);

/** Rename the plane's coordinates: Y becomes Y + shift; with `turn`, X becomes -X and Y shift - Y.
 */
void plane_map_relabel(plane_map_t *map, int turn, double shift_mm);

#endif
