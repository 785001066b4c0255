/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * From points of a plane seen in several pictures to the camera: lens, poses, and how good they
 * are.
 *
 * The points are those of any planar target: nodes of the calibration grid (opms/grid.h), corners
 * of a chessboard. All pictures are solved together, Z. Zhang's way (A flexible new technique for
 * camera calibration, PAMI 2000), with the lens model of opms/lens.h. */
#ifndef OPMS_CALIB_H
#define OPMS_CALIB_H

#include <opms/pose.h>
#include <opms/status.h>
#include <opms/types.h>

#ifdef __cplusplus
extern "C" {
#endif

#define OPMS_CALIB_PICTURES_MAX 1024 /**< most pictures that options may ask for */
#define OPMS_CALIB_POINTS_MAX 8192   /**< most points of one picture */
/** x^i y^j with 2 <= i + j <= 4: x2 xy y2 x3 x2y xy2 y3 x4 x3y x2y2 xy3 y4 */
#define OPMS_CALIB_COCKLE_TERMS 12

/** A point of the target and where it is seen. */
typedef struct opms_calib_point {
    double target_m[2]; /**< (X, Y) in the target's plane */
    double px[2];       /**< (u, v) */
    double sigma_px;    /**< standard deviation of each coordinate, > 0 */
} opms_calib_point_t;

/** Options of a calibrator; fill with opms_calib_options_init() first. */
typedef struct opms_calib_options {
    uint32_t struct_size;
    int32_t width_px, height_px; /**< of all pictures; 16 to 16384, no default */
    uint32_t pictures_max;       /**< 3 to OPMS_CALIB_PICTURES_MAX, default 64 */
    uint32_t points_max;         /**< in one picture; 4 to OPMS_CALIB_POINTS_MAX, default 1485 */
    /** Estimate the target's departure from a plane, for targets that may be this much off it
     * (standard deviation at half the target's size); 0 (default): it is a plane. */
    double cockle_sigma_m;
    opms_allocator_t allocator;
} opms_calib_options_t;

/** What the pictures do not fix well enough (bits of opms_calib_result_t.warnings). */
enum {
    /** The target's normal, as the camera sees it, has nearly one direction in all pictures, and
     * the focal length is known no better than 0.03 %. */
    OPMS_CALIB_ALL_PARALLEL = 1U << 0,
    OPMS_CALIB_FEW_PICTURES = 1U << 1, /**< fewer than 5 */
    OPMS_CALIB_POOR_COVERAGE = 1U << 2, /**< much of the picture's border never held a point */
    OPMS_CALIB_FOCAL_OPEN = 1U << 3,   /**< focal length known no better than 1 % */
    OPMS_CALIB_CENTRE_OPEN = 1U << 4,  /**< principal point no better than 2 % of the width */
    OPMS_CALIB_LARGE_RESIDUAL = 1U << 5, /**< residuals far beyond the stated sigmas */
    OPMS_CALIB_MANY_OUTLIERS = 1U << 6 /**< more than 5 % of the points do not agree */
};

/** A calibration. */
typedef struct opms_calib_result {
    opms_lens_t lens;
    double covariance[64]; /**< row-major, order fx fy cx cy k1 k2 p1 p2, px and 1 */
    uint32_t pictures_used;
    uint32_t points_used;  /**< with a robust weight above one quarter (4.2 sigmas) */
    uint32_t outliers;     /**< the others */
    uint32_t warnings;     /**< OPMS_CALIB_... */
    uint32_t iterations;
    double residual_rms_px; /**< RMS length of the residuals (u, v) of the points used */
    double chi2_dof;        /**< mean square of the residuals over the stated sigmas */
    double coverage;        /**< part of 8 x 8 cells of the picture that held points */
    double cockle_m[OPMS_CALIB_COCKLE_TERMS]; /**< of (X/s)^i (Y/s)^j, s = cockle_scale_m */
    double cockle_scale_m;  /**< half the target's size, 0 where no cockle was estimated */
    double cockle_peak_m;   /**< largest less smallest height over the target's points */
} opms_calib_result_t;

/** What became of one picture. */
typedef enum opms_calib_use {
    OPMS_CALIB_USED = 0,
    OPMS_CALIB_NOT_SOLVED = 1, /**< no solution since it was added, or the last one failed */
    OPMS_CALIB_NO_PLANE = 2,   /**< its points are no view of a plane */
    OPMS_CALIB_NO_FIT = 3,     /**< a plane, but not seen by this camera */
    OPMS_CALIB_SWITCHED_OFF = 4 /**< by opms_calibrator_use() */
} opms_calib_use_t;

/** One picture of a calibration. */
typedef struct opms_calib_picture {
    opms_calib_use_t use;
    uint32_t points, outliers;
    opms_pose_t target_camera; /**< camera to target; covariance with the lens's uncertainty */
    /** 6 x 8 row-major covariance of the pose's (w, d) and the lens's eight parameters. */
    double covariance_with_lens[48];
    double residual_rms_px;
    double tilt_rad;           /**< between optical axis and the target's normal */
    /** Part of the lens's information (sum over its eight parameters, 1 = all of one parameter's)
     * that would be lost without this picture. */
    double gain;
} opms_calib_picture_t;

/** Solves one camera. Holds all memory; one handle, one thread at a time. */
typedef struct opms_calibrator opms_calibrator_t;

/** Fill in the defaults. @param[out] options not NULL. @since 0.3 */
OPMS_API void opms_calib_options_init(opms_calib_options_t *options);

/** Create a calibrator.
 * @param options  Not NULL, with the pictures' size; copied.
 * @param[out] calibrator  Freed by opms_calibrator_destroy().
 * @return OPMS_OK, OPMS_ERR_ARG or OPMS_ERR_MEMORY. @since 0.3 */
OPMS_API opms_status_t opms_calibrator_create(const opms_calib_options_t *options,
                                              opms_calibrator_t **calibrator, opms_error_t *err);

/** Free a calibrator. NULL is allowed. @since 0.3 */
OPMS_API void opms_calibrator_destroy(opms_calibrator_t *calibrator);

/** Add a picture.
 *
 * @param points  `count` points, copied; at least 4, no three of which are in one line for some 4.
 * @param[out] picture  NULL, or its index: 0, 1, ... in the order of the calls.
 * @return OPMS_OK; OPMS_ERR_ARG (err->index is the point); OPMS_ERR_CAPACITY; OPMS_ERR_DOMAIN
 *         where the points determine no view of a plane: nothing was added. @since 0.3 */
OPMS_API opms_status_t opms_calibrator_add(opms_calibrator_t *calibrator,
                                           const opms_calib_point_t *points, uint32_t count,
                                           uint32_t *picture, opms_error_t *err);

/** Switch a picture off (`used` 0) or on again; it takes effect with the next solution.
 * @return OPMS_OK or OPMS_ERR_ARG. @since 0.3 */
OPMS_API opms_status_t opms_calibrator_use(opms_calibrator_t *calibrator, uint32_t picture,
                                           uint32_t used, opms_error_t *err);

/** Solve for the camera from all pictures that are switched on.
 *
 * Start: focal length from the homographies, pose by pose; then Levenberg-Marquardt on all
 * 8 + 6N unknowns with analytic gradients, the poses eliminated block by block (Schur), weights by
 * Tukey. After a solution the next one starts from it. Deterministic.
 *
 * @param[out] result  Not NULL.
 * @return OPMS_OK; OPMS_ERR_ARG; OPMS_ERR_DOMAIN where fewer than 3 pictures can be used or
 *         nothing fits them; OPMS_ERR_CONVERGE. @since 0.3 */
OPMS_API opms_status_t opms_calibrator_solve(opms_calibrator_t *calibrator,
                                             opms_calib_result_t *result, opms_error_t *err);

/** One picture of the last solution. @return OPMS_OK or OPMS_ERR_ARG. @since 0.3 */
OPMS_API opms_status_t opms_calibrator_picture(const opms_calibrator_t *calibrator,
                                               uint32_t picture, opms_calib_picture_t *result,
                                               opms_error_t *err);

/** Residuals of one picture in the last solution.
 * @param[out] residuals  2 x count: (u, v) measured less model; NaN where the picture is not used.
 * @param[out] weights    NULL, or count robust weights, 0 to 1; below one quarter is an outlier.
 * @return OPMS_OK or OPMS_ERR_ARG. @since 0.3 */
OPMS_API opms_status_t opms_calibrator_residuals(const opms_calibrator_t *calibrator,
                                                 uint32_t picture, double *residuals,
                                                 double *weights, opms_error_t *err);

/** Choose pictures that together fix the lens best: greedily, the one that lowers the summed
 * relative variances most comes first.
 * @param count    How many are wanted; fewer are returned where fewer are used.
 * @param[out] chosen  `count` indices, best first.
 * @param[out] chosen_count  Not NULL.
 * @return OPMS_OK; OPMS_ERR_ARG; OPMS_ERR_DOMAIN before a solution. @since 0.3 */
OPMS_API opms_status_t opms_calibrator_choose(const opms_calibrator_t *calibrator, uint32_t count,
                                              uint32_t *chosen, uint32_t *chosen_count,
                                              opms_error_t *err);

/** Where the detector's head stood on the target when a picture was taken. */
typedef struct opms_footprint {
    uint32_t picture;
    double x_m, y_m;    /**< head centre in the target's frame, its Z is 0 and it is level */
    double yaw_rad;     /**< about Z */
    double sigma_m;     /**< standard deviation of the placing, along X and along Y; >= 0 */
    double sigma_rad;   /**< and of the yaw; >= 0 */
} opms_footprint_t;

/** Camera to detector from pictures on footprints.
 *
 * @param footprints  `count` >= 1; of pictures that the last solution used.
 * @param[in,out] camera  lens, detector_camera and all three covariances are filled in from the
 *                        last solution.
 * @return OPMS_OK; OPMS_ERR_ARG (err->index is the footprint); OPMS_ERR_DOMAIN before a solution.
 * @since 0.3 */
OPMS_API opms_status_t opms_calibrator_camera(const opms_calibrator_t *calibrator,
                                              const opms_footprint_t *footprints, uint32_t count,
                                              opms_camera_t *camera, opms_error_t *err);

/** A picture that might be taken. */
typedef struct opms_calib_view {
    opms_transform_t target_camera;     /**< from there: camera to target */
    const double *target_m;             /**< the target's points, 2 x count: X, Y; z is 0 */
    uint32_t count;                     /**< >= 1; those outside of the picture do not count */
    uint32_t footprint_count;           /**< 0 where the camera's place does not matter */
    double sigma_px;                    /**< of a point's coordinate; 0: as in the pictures */
    const opms_footprint_t *footprints; /**< as for opms_calibrator_camera() */
} opms_calib_view_t;

/** What a further picture would do. */
typedef struct opms_calib_foresight {
    uint32_t points; /**< of the target in the picture */
    uint32_t reserved;
    /** Part of the lens's variances that would be gone, summed over its eight parameters: 0 to 8.
     */
    double gain;
    /** As opms_calibrator_camera() would give it with that picture, to first order: with
     * covariances that have shrunk, and unmoved. Without footprints the lens alone. */
    opms_camera_t camera;
} opms_calib_foresight_t;

/** Foresee what one more picture would do, before it is taken: ask for each that could be, and
 * take the best. Allocates nothing; some 10 us for 100 points.
 *
 * @param[out] foresight  Where fewer than 4 points would be in the picture, it changes nothing.
 * @return OPMS_OK; OPMS_ERR_ARG; OPMS_ERR_DOMAIN before a solution. @since 0.4 */
OPMS_API opms_status_t opms_calibrator_foresee(const opms_calibrator_t *calibrator,
                                               const opms_calib_view_t *view,
                                               opms_calib_foresight_t *foresight,
                                               opms_error_t *err);

/** Limits of chi2 that one camera in 1000 exceeds by chance where nothing was touched. */
#define OPMS_CALIB_CHI2_LENS 26.12     /**< 8 degrees of freedom */
#define OPMS_CALIB_CHI2_MOUNTING 22.46 /**< 6 degrees of freedom */

/** What new pictures say of a lens that was calibrated before. */
typedef struct opms_calib_lens_check {
    uint32_t pictures_used;
    uint32_t points_used;        /**< with a robust weight above one quarter (4.2 sigmas) */
    uint32_t outliers;
    double residual_rms_px;      /**< RMS length of the residuals, the lens as stated */
    double residual_free_rms_px; /**< the lens free, too: what the points are good for */
    /** Standard deviation of the points over the stated one, never below 1: from the residuals with
     * the lens free, and from how alike neighbours are. Everything here allows for it. */
    double noise_factor;
    double chi2;                 /**< of 8: above OPMS_CALIB_CHI2_LENS the stated lens is wrong */
    double change[8];            /**< of fx fy cx cy k1 k2 p1 p2 that would explain the points */
    /** Smallest changes that these pictures would show 19 times of 20: of fx and fy alike, in parts
     * of them; of cx and of cy in px. Each is relative to what the pose cannot feign. */
    double shows_focal, shows_centre_px[2];
} opms_calib_lens_check_t;

/** What a picture on a footprint says of a mounting that was found before. */
typedef struct opms_calib_mounting_check {
    opms_transform_t detector_camera; /**< as this picture has it, through the stated lens */
    double change[6];      /**< (w, d) from the stated mounting to this one, rad and m */
    double covariance[36]; /**< of the change where nothing moved, the placing included */
    double chi2;           /**< of 6: above OPMS_CALIB_CHI2_MOUNTING the camera has moved */
    /** Smallest turn of the camera about the detector's X, Y, Z, and smallest shift along them,
     * that would show 19 times of 20. */
    double shows_turn_rad[3], shows_shift_m[3];
} opms_calib_mounting_check_t;

/** Does a camera that was calibrated before still hold? One picture is enough for an answer, though
 * not always for a sharp one: see shows_focal and its neighbours.
 *
 * The poses are found with the stated lens; what is left of the residuals is compared with what the
 * lens's covariance and the points' noise allow. A solution of the handle is lost; the next
 * opms_calibrator_solve() starts afresh. opms_calibrator_picture() and opms_calibrator_residuals()
 * then tell of the stated lens.
 *
 * @param camera      As it was calibrated; its lens is exact where it holds no covariance.
 * @param footprints  NULL, or `count` pictures whose place is known; camera then needs
 *                    has_detector_camera.
 * @param[out] lens   Not NULL.
 * @param[out] mountings  `count` answers; not NULL where count is not 0.
 * @return OPMS_OK (whatever the answer); OPMS_ERR_ARG (err->index is the footprint);
 *         OPMS_ERR_DOMAIN where no picture is seen by such a lens at all. @since 0.3 */
OPMS_API opms_status_t opms_calibrator_check(opms_calibrator_t *calibrator,
                                             const opms_camera_t *camera,
                                             const opms_footprint_t *footprints, uint32_t count,
                                             opms_calib_lens_check_t *lens,
                                             opms_calib_mounting_check_t *mountings,
                                             opms_error_t *err);

#ifdef __cplusplus
}
#endif
#endif
