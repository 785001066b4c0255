/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How exact will a position be? Asked of a calibrated camera before any picture of the bar is
 * taken.
 *
 * The bar is projected as the camera would see it from a place of the detector, each side of a
 * square is given the least standard deviation that blur and noise allow (the Cramer-Rao bound of a
 * blurred straight edge), and opms_pose_solve() and opms_pose_detector() say what follows: the part
 * of the image noise, and the part of the calibration (lens, mounting, and what ties both). */
#ifndef OPMS_EXPECT_H
#define OPMS_EXPECT_H

#include <opms/pose.h>
#include <opms/status.h>
#include <opms/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The picture of the bar; fill with opms_expect_options_init() first. */
typedef struct opms_expect_options {
    uint32_t struct_size;
    double bar_tilt_rad;  /**< as for opms_pose_detector(); default 0 */
    double contrast;      /**< grey levels from black to white, > 0; default 150 */
    double noise;         /**< standard deviation of the grey levels, > 0; default 3 */
    double blur_px;       /**< standard deviation of the blur, > 0; default 0.75 */
    double min_square_px; /**< squares with a shorter side do not count, >= 0; default 7 */
} opms_expect_options_t;

/** What is to be expected of the detector's pose at one place. */
typedef struct opms_expectation {
    /** FOUND: the figures below hold. Else too little of the bar is in the picture. */
    opms_pose_state_t state;
    uint32_t square_count; /**< of the bar, whole in the picture */
    /** 6 x 6 covariances of the detector's (w, d), opms_pose_t's convention: from the image noise
     * alone, and from the calibration alone. They are independent; their sum is that of the pose.
     */
    double covariance_image[36];
    double covariance_calibration[36]; /**< 0 where the camera holds no covariance */
} opms_expectation_t;

/** Fill in the defaults. @param[out] options not NULL. @since 0.4 */
OPMS_API void opms_expect_options_init(opms_expect_options_t *options);

/** Expected uncertainty of the detector's pose at one place over a bar that lies in full view:
 * nothing hides it, and it is not saturated. Pure: any thread, any time; allocates nothing.
 *
 * @param camera   With has_detector_camera; of its covariances those that it holds count.
 * @param ground_detector  Detector to ground: where the head is.
 * @param options  NULL for the defaults.
 * @param[out] expectation  Not NULL.
 * @return OPMS_OK (whatever the state); OPMS_ERR_ARG; OPMS_ERR_DOMAIN where the lens folds.
 * @since 0.4 */
OPMS_API opms_status_t opms_expect_pose(const opms_camera_t *camera,
                                        const opms_transform_t *ground_detector,
                                        const opms_expect_options_t *options,
                                        opms_expectation_t *expectation, opms_error_t *err);

#ifdef __cplusplus
}
#endif
#endif
