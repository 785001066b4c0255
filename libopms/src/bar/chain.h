/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Squares next to squares: from one quadrilateral to a row of the bar. */
#ifndef OPMS_BAR_CHAIN_H
#define OPMS_BAR_CHAIN_H

#include <opms/types.h>

#include "bar/plane_map.h"
#include "bar/quad.h"

#define CHAIN_MAX 33

/** Squares of one row, in rising order along +Y of a bar frame whose origin is not yet known. */
typedef struct chain {
    int count;
    struct chain_square {
        int place;         /**< counted from the seed, gaps included */
        point_t corner[4]; /**< (-X,-Y), (+X,-Y), (+X,+Y), (-X,+Y) */
    } square[CHAIN_MAX];
} chain_t;

/** Grow a row from a seed along both of its axes and keep the longer one.
 *
 * @param contrast  Least grey levels from black to white.
 * @param most      Squares after which the row is long enough, up to CHAIN_MAX.
 * @return The number of squares in the row, 1 where nothing stands beside the seed. */
int chain_grow(const view_t *view, const quad_t *seed, float contrast, const quad_limits_t *limits,
               point_t *points, int most, chain_t *chain);

/** Fit the row's map to rays, places times the pitch as Y; squares that do not fit are dropped.
 * Before that all sides are moved by their common shift, which is returned: saturated white and
 * motion can make the squares a good deal smaller than they are.
 *
 * @return 1 if at least two squares agree. */
int chain_fit(chain_t *chain, const opms_lens_t *lens, double ray_limit, plane_map_t *map,
              double *shift_px);

/** Corners of a contour's quadrilateral in bar order, so that they are next to the predicted ones;
 * 0 where they are not. */
int chain_match_corners(const quad_t *quad, const point_t predicted[4], point_t corner[4]);

/** Look at one square where it is predicted. 1 with its corners where it is. */
int chain_find_square(const view_t *view, const point_t predicted[4], float contrast,
                      const quad_limits_t *limits, point_t *points, point_t corner[4]);

/** As chain_fit(), for a few squares far apart whose places are known: all of them have to fit. */
int chain_fit_far(chain_t *chain, const opms_lens_t *lens, double ray_limit, plane_map_t *map,
                  double *shift_px);

#endif
