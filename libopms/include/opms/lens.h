/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The camera model: rays to pixels and back (Beumier and Yvinec, equations 1 to 5).
 *
 * With x = X/Z, y = Y/Z, r2 = x^2 + y^2:
 *   xd = x (1 + k1 r2 + k2 r2^2) + 2 p1 x y + p2 (r2 + 2 x^2)
 *   yd = y (1 + k1 r2 + k2 r2^2) + p1 (r2 + 2 y^2) + 2 p2 x y
 *   u = fx xd + cx, v = fy yd + cy
 *
 * All calls are pure: any thread, any time, no state. */
#ifndef OPMS_LENS_H
#define OPMS_LENS_H

#include <opms/status.h>
#include <opms/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Check that a lens can be used over its whole picture.
 *
 * Everything finite; picture 1 to 16384 px a side; focal lengths positive and 0.05 to 100 times
 * the longer side; the principal point within one picture size of the picture; and the model
 * one-to-one (positive Jacobian, invertible) from the principal point out to all four borders.
 *
 * @return OPMS_OK, OPMS_ERR_ARG (message names the parameter), or OPMS_ERR_DOMAIN where the
 *         distortion folds inside the picture.
 * @since 0.1 */
OPMS_API opms_status_t opms_lens_check(const opms_lens_t *lens, opms_error_t *err);

/** Project a point in the camera frame.
 *
 * @param point_m     (X, Y, Z) in the camera frame, Z > 0. Any common unit will do.
 * @param[out] px     (u, v)
 * @param[out] jac    NULL, or 2 x 3 row-major d(u, v)/d(X, Y, Z).
 * @param[out] jac_intrinsics NULL, or 2 x 8 row-major d(u, v)/d(fx fy cx cy k1 k2 p1 p2).
 *
 * @return OPMS_OK; OPMS_ERR_ARG for NULL; OPMS_ERR_DOMAIN where Z <= 0, a value is not finite, or
 *         the ray lies beyond the fold of the distortion (where the model would mirror it back
 *         into the picture).
 * @since 0.1 */
OPMS_API opms_status_t opms_lens_project(const opms_lens_t *lens, const double point_m[3],
                                         double px[2], double *jac, double *jac_intrinsics,
                                         opms_error_t *err);

/** The ray of a pixel: normalised coordinates (x, y) with opms_lens_project((x, y, 1)) = px.
 *
 * Exact: reprojection within 1e-10 px of px (relative to the picture's size) everywhere in a
 * picture that passes opms_lens_check(). Newton's method on the exact Jacobian with a guarded
 * start.
 *
 * @param px          (u, v); up to half a picture outside the borders is accepted where the model
 *                    is still one-to-one.
 * @param[out] ray    (x, y)
 * @param[out] jac    NULL, or 2 x 2 row-major d(x, y)/d(u, v).
 *
 * @return OPMS_OK, OPMS_ERR_ARG, or OPMS_ERR_DOMAIN where no ray reaches the pixel.
 * @since 0.1 */
OPMS_API opms_status_t opms_lens_unproject(const opms_lens_t *lens, const double px[2],
                                           double ray[2], double *jac, opms_error_t *err);

#ifdef __cplusplus
}
#endif
#endif
