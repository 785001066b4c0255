/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * From measured edges of a planar bar to the pose of the camera and of the detector. */
#ifndef OPMS_POSE_H
#define OPMS_POSE_H

#include <opms/bar.h>
#include <opms/status.h>
#include <opms/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A pose with its uncertainty.
 *
 * The 6 x 6 covariance is that of (w, d): R_true = R Exp(w), t_true = t + d, in rad and m. */
typedef struct opms_pose {
    opms_transform_t transform;
    double covariance[36]; /**< row-major */
} opms_pose_t;

typedef enum opms_pose_state {
    OPMS_POSE_NONE = 0,     /**< too few edges, or none that agree */
    OPMS_POSE_FOUND = 1,
    OPMS_POSE_AMBIGUOUS = 2 /**< both solutions of a plane fit alike and differ; no pose is given */
} opms_pose_state_t;

/** Result of opms_pose_solve(). */
typedef struct opms_pose_result {
    opms_pose_state_t state;
    uint32_t edges_used;   /**< edges with a robust weight above one half */
    opms_pose_t bar_camera; /**< camera to bar; covariance from the image noise alone */
    double edge_shift_px;  /**< common outward shift of all edges of the black squares */
    double residual_px;    /**< weighted RMS of the used edges' distances from the solution */
    double chi2_dof;       /**< mean squared residual in units of the stated sigmas, used edges */
    double chi2_other;     /**< chi2 excess of the other planar solution; large is good */
    /** 6 x 8, row-major: d(w, d)/d(fx fy cx cy k1 k2 p1 p2) at the solution. */
    double intrinsics_jacobian[48];
} opms_pose_result_t;

/** Pose from edges.
 *
 * Start: the linear homography of the edges' lines in normalised coordinates, decomposed into both
 * planar solutions; then Gauss-Newton with analytic gradients on the edges through the full lens
 * model, robust (Tukey), with the common edge shift as a seventh unknown. The covariance is the
 * inverse information of the edges' sigmas, scaled up by chi2 where the residuals are larger than
 * stated. Pure: any thread, any time; allocates nothing.
 *
 * @param lens       Must pass opms_lens_check(); checked for finiteness only.
 * @param edges      At least 8, on at least 2 squares, for a pose; finite, sigma_px > 0.
 * @param count      0 to OPMS_BAR_EDGES_MAX.
 * @param[out] residuals_px  NULL, or count signed distances (measured - model, along the normal,
 *                   the shift taken off); not written where state is not FOUND.
 * @param[out] result Not NULL.
 * @return OPMS_OK (whatever the state) or OPMS_ERR_ARG (err->index is the edge).
 * @since 0.1 */
OPMS_API opms_status_t opms_pose_solve(const opms_lens_t *lens, const opms_edge_t *edges,
                                       uint32_t count, double *residuals_px,
                                       opms_pose_result_t *result, opms_error_t *err);

/** What a detector pose's covariance holds (bits). */
enum {
    OPMS_COVARIANCE_IMAGE = 1,
    OPMS_COVARIANCE_INTRINSICS = 2,
    OPMS_COVARIANCE_DETECTOR_CAMERA = 4
};

/** Pose of the detector in the ground frame from the pose of the camera in the bar frame.
 *
 * @param bar_camera   A result whose state is OPMS_POSE_FOUND.
 * @param camera       With has_detector_camera; covariances it holds are added, that of mounting
 *                     and intrinsics with its sign: of a calibrated camera it lowers the sum.
 * @param bar_tilt_rad Positive: printed face turned away from the operator,
 *                     R_ground_bar = Ry(-tilt); -pi/2 to pi/2.
 * @param[out] ground_detector  Detector to ground, covariance of the same convention.
 * @param[out] includes  NULL, or the OPMS_COVARIANCE_ bits that went in.
 * @return OPMS_OK or OPMS_ERR_ARG.
 * @since 0.1 */
OPMS_API opms_status_t opms_pose_detector(const opms_pose_result_t *bar_camera,
                                          const opms_camera_t *camera, double bar_tilt_rad,
                                          opms_pose_t *ground_detector, uint32_t *includes,
                                          opms_error_t *err);

/** Check a camera: its lens, rotation (orthonormal to 1e-6, right-handed) and covariances (finite,
 * symmetric, no negative variance in any direction; lens and mounting together, too, where
 * covariance_detector_camera_intrinsics is there).
 * @return OPMS_OK, OPMS_ERR_ARG or OPMS_ERR_DOMAIN. @since 0.1 */
OPMS_API opms_status_t opms_camera_check(const opms_camera_t *camera, opms_error_t *err);

#ifdef __cplusplus
}
#endif
#endif
