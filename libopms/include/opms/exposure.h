/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Exposure and gain for the next picture, by the light on the bar alone. Pure logic: it reads
 * pictures and numbers, and says what to set; it talks to no camera.
 *
 * A picture is judged by what it was exposed with as the *frame* reports it, never by what was
 * asked for: so the delay of the camera does not matter and nothing swings. */
#ifndef OPMS_EXPOSURE_H
#define OPMS_EXPOSURE_H

#include <opms/bar.h>
#include <opms/status.h>
#include <opms/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/** How bright a picture is where it matters. Levels are parts of the saturation level, 0 to 1. */
typedef struct opms_exposure_light {
    uint32_t squares;     /**< of the bar that were measured; 0: the next four are 0 */
    uint32_t reserved;
    double white;         /**< median of the white beside the squares */
    double white_high;    /**< its 95th percentile */
    double black;         /**< median of the squares' insides */
    double saturated;     /**< part of the white that is saturated */
    double picture_white; /**< 90th percentile of the whole picture */
    double picture_black; /**< 10th percentile of it */
} opms_exposure_light_t;

/** Measure the light on the bar.
 *
 * @param image    Read only during the call.
 * @param squares  Where the bar is, or is expected (opms_exposure_expect()); `count` may be 0: then
 *                 the picture alone is measured. Parts outside of the picture are left out.
 * @param[out] light  Not NULL.
 * @return OPMS_OK or OPMS_ERR_ARG. Pure: any thread. @since 0.3 */
OPMS_API opms_status_t opms_exposure_measure(const opms_image_t *image,
                                             const opms_square_t *squares, uint32_t count,
                                             opms_exposure_light_t *light, opms_error_t *err);

/** Where the squares will be seen from a pose (that of the last picture, or a predicted one).
 * @param lens        Must pass opms_lens_check().
 * @param bar_camera  Camera to bar.
 * @param[out] squares  OPMS_BAR_SQUARES of them at most: those whose corners lie in the picture.
 * @param[out] count    How many; not NULL.
 * @return OPMS_OK or OPMS_ERR_ARG. Pure: any thread. @since 0.3 */
OPMS_API opms_status_t opms_exposure_expect(const opms_lens_t *lens,
                                            const opms_transform_t *bar_camera,
                                            opms_square_t *squares, uint32_t *count,
                                            opms_error_t *err);

/** Options of a control; fill with opms_exposure_options_init() first. */
typedef struct opms_exposure_options {
    uint32_t struct_size;
    uint32_t reserved;
    double exposure_min_us, exposure_max_us; /**< of the camera; default 20 and 30,000 */
    double gain_min_db, gain_max_db;         /**< of the camera; 20 dB are ten times; 0 and 24 */
    double white_low, white_high;            /**< where the white shall be; default 0.70, 0.80 */
    double saturated_most;                   /**< of the white; default 0.005 */
    double blur_most_px; /**< way of the picture during the exposure; default 2 */
    opms_allocator_t allocator;
} opms_exposure_options_t;

/** One picture, as it was taken. */
typedef struct opms_exposure_frame {
    double exposure_us, gain_db;     /**< as the frame reports them; exposure > 0 */
    opms_exposure_light_t light;     /**< by opms_exposure_measure() */
    uint32_t squares_located;        /**< 0 where the bar was not located */
    uint32_t squares_expected;       /**< in the picture by the pose, or 0 where none is known */
    double speed_px_s;               /**< of the bar in the picture; 0 where it is not known */
} opms_exposure_frame_t;

typedef enum opms_exposure_state {
    OPMS_EXPOSURE_SEARCHING = 0, /**< the bar is lost: by the picture, and around that */
    OPMS_EXPOSURE_HOLDING = 1,   /**< the white is where it shall be */
    OPMS_EXPOSURE_MOVING = 2,    /**< on its way there */
    OPMS_EXPOSURE_TOO_DARK = 3,  /**< the limits of exposure and gain are reached */
    OPMS_EXPOSURE_TOO_BRIGHT = 4
} opms_exposure_state_t;

/** What to set. */
typedef struct opms_exposure_command {
    double exposure_us, gain_db;
    opms_exposure_state_t state;
    uint32_t blur_limited; /**< a longer exposure would smear: there is gain instead */
} opms_exposure_command_t;

/** Controls one camera. One handle, one thread at a time. */
typedef struct opms_exposure opms_exposure_t;

/** Fill in the defaults. @param[out] options not NULL. @since 0.3 */
OPMS_API void opms_exposure_options_init(opms_exposure_options_t *options);

/** Create a control.
 * @param options  NULL for the defaults; copied.
 * @param[out] exposure  Freed by opms_exposure_destroy().
 * @return OPMS_OK, OPMS_ERR_ARG or OPMS_ERR_MEMORY. @since 0.3 */
OPMS_API opms_status_t opms_exposure_create(const opms_exposure_options_t *options,
                                            opms_exposure_t **exposure, opms_error_t *err);

/** Free a control. NULL is allowed. @since 0.3 */
OPMS_API void opms_exposure_destroy(opms_exposure_t *exposure);

/** What the next pictures shall be taken with, after this one.
 *
 * The white decides: shutter first, up to the limit that the bar's speed sets, then gain. Where the
 * white is as it shall be and yet squares are missing (half of the bar in the sun, half in the
 * shade), brighter and darker are tried in turn and what shows most squares is kept: the number of
 * squares is the measure that the paper used (Beumier and Yvinec, 2017). Where the bar is lost, the
 * light on the ground around it stands in, and exposures are bracketed around what it says.
 *
 * @param frame  A picture, in the order they were taken.
 * @param[out] command  Not NULL.
 * @return OPMS_OK or OPMS_ERR_ARG (nothing changed). @since 0.3 */
OPMS_API opms_status_t opms_exposure_push(opms_exposure_t *exposure,
                                          const opms_exposure_frame_t *frame,
                                          opms_exposure_command_t *command, opms_error_t *err);

#ifdef __cplusplus
}
#endif
#endif
