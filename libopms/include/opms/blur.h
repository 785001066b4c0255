/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How sharp the bar is in a picture, and what is wrong where it is not: for who turns a lens. */
#ifndef OPMS_BLUR_H
#define OPMS_BLUR_H

#include <opms/bar.h>
#include <opms/status.h>
#include <opms/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/** What a person should do something about. */
typedef enum opms_blur_verdict {
    OPMS_BLUR_UNKNOWN = 0, /**< too few squares, or their white is saturated */
    OPMS_BLUR_SHARP = 1,
    OPMS_BLUR_FOCUS = 2,   /**< blurred in all directions and nowhere sharp: turn the lens */
    OPMS_BLUR_MOTION = 3,  /**< blurred in one direction of the picture: expose shorter */
    OPMS_BLUR_APERTURE = 4 /**< sharp in places alone: close the aperture */
} opms_blur_verdict_t;

/** Blur is told as the standard deviation of what a point becomes, px, as the picture shows it: a
 * perfect lens leaves the pixel's own 0.29. */
typedef struct opms_blur {
    opms_blur_verdict_t verdict;
    uint32_t squares;          /**< that were measured */
    double blur_px[2];         /**< medians: across the sides along Y [0] and along X [1] */
    double still_px;           /**< median in the direction that is blurred least */
    /** Way of the picture that explains what is more in the other direction; to about a quarter,
     * up to a third of a square's side. */
    double motion_px;
    double motion_direction[2]; /**< (u, v) of that way, length 1; its sign means nothing */
    /** Blur in the least blurred direction, smoothed along the bar, where it is least and most. */
    double sharpest_px, softest_px;
    int32_t sharpest_square, softest_square; /**< their indices; -1 where squares is 0 */
} opms_blur_t;

/** Options; fill with opms_blur_options_init() first. */
typedef struct opms_blur_options {
    uint32_t struct_size;
    uint32_t reserved;
    double sharp_most_px; /**< up to here it counts as sharp; 0.3 to 20, default 1 */
} opms_blur_options_t;

/** Fill in the defaults. @param[out] options not NULL. @since 0.3 */
OPMS_API void opms_blur_options_init(opms_blur_options_t *options);

/** Measure the blur of the bar's squares. Bounded time, never allocates.
 *
 * Each side gives the blur across it, and a square's corners what lies between those directions:
 * together the blur in every direction of the picture.
 *
 * @param image    Read only during the call.
 * @param squares  As opms_bar_squares() gives them, by rising index; `count` up to
 *                 OPMS_BAR_SQUARES. Those that leave the picture are left out.
 * @param options  NULL for the defaults.
 * @param[out] blur  Not NULL.
 * @return OPMS_OK (whatever the verdict) or OPMS_ERR_ARG. Pure: any thread. @since 0.3 */
OPMS_API opms_status_t opms_blur_measure(const opms_image_t *image, const opms_square_t *squares,
                                         uint32_t count, const opms_blur_options_t *options,
                                         opms_blur_t *blur, opms_error_t *err);

/** Name of a verdict, e.g. "sharp", "focus"; "?" for other numbers. @return Static storage.
 * @since 0.3 */
OPMS_API const char *opms_blur_verdict_name(opms_blur_verdict_t verdict);

#ifdef __cplusplus
}
#endif
#endif
