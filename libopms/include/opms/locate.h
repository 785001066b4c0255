/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * From a picture to the detector's pose in one call: bar.h, then pose.h. */
#ifndef OPMS_LOCATE_H
#define OPMS_LOCATE_H

#include <opms/bar.h>
#include <opms/pose.h>
#include <opms/status.h>
#include <opms/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Everything one picture gives. Squares, edges and residuals are read from the locator. */
typedef struct opms_location {
    opms_bar_state_t state;      /**< LOCATED only when the pose is found, too */
    uint32_t has_ground_detector; /**< the camera holds the camera-to-detector transform */
    uint32_t covariance_includes; /**< OPMS_COVARIANCE_ bits of ground_detector */
    uint32_t followed;           /**< the hint was taken up */
    opms_bar_summary_t bar;
    opms_pose_result_t pose;     /**< valid where state is LOCATED */
    opms_pose_t ground_detector; /**< valid where has_ground_detector and LOCATED */
} opms_location_t;

/** Options of a locator; fill with opms_locator_options_init() first. */
typedef struct opms_locator_options {
    uint32_t struct_size;
    uint32_t reserved;
    double bar_tilt_rad;     /**< as in opms_pose_detector(), default 0 */
    opms_bar_options_t bar;
} opms_locator_options_t;

/** Finds the bar and solves for the pose. One handle, one thread at a time. */
typedef struct opms_locator opms_locator_t;

/** Fill in the defaults. @param[out] options not NULL. @since 0.1 */
OPMS_API void opms_locator_options_init(opms_locator_options_t *options);

/** Create a locator for one camera.
 * @param camera   Must pass opms_camera_check(); copied.
 * @param options  NULL for the defaults; copied.
 * @param[out] locator  Freed by opms_locator_destroy().
 * @return OPMS_OK, OPMS_ERR_ARG, OPMS_ERR_DOMAIN or OPMS_ERR_MEMORY. @since 0.1 */
OPMS_API opms_status_t opms_locator_create(const opms_camera_t *camera,
                                           const opms_locator_options_t *options,
                                           opms_locator_t **locator, opms_error_t *err);

/** Free a locator. NULL is allowed. @since 0.1 */
OPMS_API void opms_locator_destroy(opms_locator_t *locator);

/** Locate the bar in one picture. Never allocates; bounded time.
 * @param image  As large as the lens says.
 * @param roi    NULL for the whole picture.
 * @param hint   NULL, or the expected camera-to-bar pose (that of the last picture).
 * @param[out] location  Not NULL.
 * @return OPMS_OK (whatever the state) or OPMS_ERR_ARG. @since 0.1 */
OPMS_API opms_status_t opms_locator_locate(opms_locator_t *locator, const opms_image_t *image,
                                           const opms_roi_t *roi, const opms_transform_t *hint,
                                           opms_location_t *location, opms_error_t *err);

/** Solve for the pose from edges found elsewhere (another kind of bar, a recording).
 *
 * Squares of the location are those given; the edges become those of the locator.
 * @param edges, count  As opms_pose_solve(); copied.
 * @return OPMS_OK or OPMS_ERR_ARG. @since 0.1 */
OPMS_API opms_status_t opms_locator_solve(opms_locator_t *locator, const opms_edge_t *edges,
                                          uint32_t count, opms_location_t *location,
                                          opms_error_t *err);

/** Squares of the last picture, by rising index. @param[out] count may be NULL.
 * @return Owned by the locator, valid until its next call. @since 0.1 */
OPMS_API const opms_square_t *opms_locator_squares(const opms_locator_t *locator, uint32_t *count);

/** Edges of the last picture. @param[out] count may be NULL.
 * @return Owned by the locator, valid until its next call. @since 0.1 */
OPMS_API const opms_edge_t *opms_locator_edges(const opms_locator_t *locator, uint32_t *count);

/** Residual of each edge of the last picture as of opms_pose_solve(); NULL where none was located.
 * @return Owned by the locator, valid until its next call. @since 0.1 */
OPMS_API const double *opms_locator_residuals_px(const opms_locator_t *locator);

#ifdef __cplusplus
}
#endif
#endif
