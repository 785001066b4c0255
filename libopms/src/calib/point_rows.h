/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Points of a picture as rows of the least-squares problem, column by column.
 *
 * Each of the two coordinates has its own focal length and its own centre, and nothing to do with
 * the other's: so both have the same columns, those of the lens (f, c, k1, k2, p1, p2), of the
 * cockle where there is one, of the pose (w, d), and the residual. */
#ifndef OPMS_CALIB_POINT_ROWS_H
#define OPMS_CALIB_POINT_ROWS_H

#include <opms/calib.h>

#include "calib/gram_sums.h"

#ifdef __cplusplus
extern "C" {
#endif

#define LENS_COLUMNS 6

/** How points are looked at. */
typedef struct point_view {
    double R[9];       /**< target to camera, row-major */
    double origin[3];  /**< of the target, in the camera */
    opms_lens_t lens;
    const double *cockle; /**< heights of the terms; not looked at for scale 0 */
    double cockle_scale_m; /**< 0: flat */
    int cockle_columns;    /**< OPMS_CALIB_COCKLE_TERMS, or 0 where the heights are no unknowns */
    double window2;    /**< Tukey's, in sigma^2 */
    int inliers_only;  /**< a point counts wholly or not at all, instead of by its weight */
    double inlier_rest; /**< square root of the weight of an inlier */
} point_view_t;

/** Write the rows of points[0], points[stride] ... `n` of them, at most GRAM_ROWS; the rows after
 * them are 0, and so is the row of a point that does not count.
 *
 * @param[out] columns  of u, then of v: LENS_COLUMNS, cockle_columns, 6 and 1 each
 * @param apart         numbers from a column of u to the same of v
 * @param[out] in_front set to 0 where a point is not before the camera, else left as it is
 * @return robust cost, in sigma^2 */
double point_rows(const point_view_t *view, const opms_calib_point_t *points, uint32_t stride,
                  int n, double *columns, int apart, int *in_front);

/** The cost alone. */
double point_costs(const point_view_t *view, const opms_calib_point_t *points, uint32_t stride,
                   int n, int *in_front);

#ifdef __cplusplus
}
#endif
#endif
