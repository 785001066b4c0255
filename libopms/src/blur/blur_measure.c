/* SPDX-License-Identifier: Apache-2.0 */
/* From the blur of single squares to a verdict on the picture.
 *
 * Motion is the same all over the bar, and in one direction. A lens that is out of focus blurs in
 * all directions: everywhere, or, where the depth of field is too short, more the further a square
 * is from the distance that is sharp; along a bar that is seen at a slant that is a slope. */
#include <opms/blur.h>

#include <math.h>
#include <string.h>

#include "algebra/median.h"
#include "base/fail.h"
#include "blur/square_blur.h"
#include "image/image_check.h"

#define STAGE "blur"
#define SQUARES_LEAST 3
#define WINDOW 5         /* squares that are smoothed over */
#define MOTION_RATIO 1.35 /* of the most to the least blurred direction */
#define SLOPE_RATIO 1.35 /* of the softest to the sharpest place */

void opms_blur_options_init(opms_blur_options_t *options)
{
    if (options) {
        memset(options, 0, sizeof *options);
        options->struct_size = sizeof *options;
        options->sharp_most_px = 1.0;
    }
}

const char *opms_blur_verdict_name(opms_blur_verdict_t verdict)
{
    static const char *const NAMES[] = {"unknown", "sharp", "focus", "motion", "aperture"};
    return (unsigned)verdict < sizeof NAMES / sizeof *NAMES ? NAMES[verdict] : "?";
}

/* Standard deviations in the most and the least blurred direction of a covariance. */
static void axes_of(double uu, double uv, double vv, double *most, double *least)
{
    const double middle = 0.5 * (uu + vv), half = 0.5 * (uu - vv);
    const double spread = sqrt(half * half + uv * uv);
    *most = sqrt(fmax(middle + spread, 0.0));
    *least = sqrt(fmax(middle - spread, 0.0));
}

static float median_from(const square_blur_t *squares, int count, size_t offset)
{
    float values[OPMS_BAR_SQUARES];
    for (int i = 0; i < count; ++i) {
        memcpy(&values[i], (const char *)&squares[i] + offset, sizeof values[i]);
    }
    return median_of(values, count);
}

#define MEDIAN(field) (double)median_from(squares, count, offsetof(square_blur_t, field))

/* What all squares have in common. @return Blur in the most blurred direction. */
static double measure_all(const square_blur_t *squares, int count, opms_blur_t *blur)
{
    const double uu = MEDIAN(cov_uu), uv = MEDIAN(cov_uv), vv = MEDIAN(cov_vv);
    double most = 0.0, least = 0.0;
    axes_of(uu, uv, vv, &most, &least);
    const double angle = 0.5 * atan2(2.0 * uv, uu - vv); /* of the most blurred */
    blur->blur_px[0] = MEDIAN(across[0]);
    blur->blur_px[1] = MEDIAN(across[1]);
    blur->still_px = least;
    blur->motion_px = sqrt(12.0 * fmax(most * most - least * least, 0.0));
    blur->motion_direction[0] = cos(angle);
    blur->motion_direction[1] = sin(angle);
    return most;
}

/* Where along the bar it is sharpest and softest, by the direction that motion spares. */
static void measure_slope(const square_blur_t *squares, int count, opms_blur_t *blur)
{
    float still[OPMS_BAR_SQUARES], window[WINDOW];
    const double c = blur->motion_direction[0], s = blur->motion_direction[1];
    for (int i = 0; i < count; ++i) {
        const square_blur_t *square = &squares[i];
        still[i] = (float)sqrt(fmax(square->cov_uu * s * s - 2.0 * square->cov_uv * s * c +
                                    square->cov_vv * c * c, 0.0));
    }
    const int width = count < WINDOW ? count : WINDOW;
    blur->sharpest_square = blur->softest_square = -1;
    for (int i = 0; i + width <= count; ++i) {
        memcpy(window, still + i, (size_t)width * sizeof *window);
        const double here = (double)median_of(window, width);
        const int32_t index = squares[i + width / 2].index;
        if (blur->sharpest_square < 0 || here < blur->sharpest_px) {
            blur->sharpest_px = here;
            blur->sharpest_square = index;
        }
        if (blur->softest_square < 0 || here > blur->softest_px) {
            blur->softest_px = here;
            blur->softest_square = index;
        }
    }
}

static opms_blur_verdict_t judge(const opms_blur_t *blur, double most, double limit)
{
    if (most > limit && most > MOTION_RATIO * blur->still_px) {
        return OPMS_BLUR_MOTION;
    }
    if (blur->softest_px > limit && blur->sharpest_px <= limit &&
        blur->softest_px > SLOPE_RATIO * blur->sharpest_px) {
        return OPMS_BLUR_APERTURE;
    }
    return blur->still_px > limit ? OPMS_BLUR_FOCUS : OPMS_BLUR_SHARP;
}

static opms_status_t check(const opms_image_t *image, const opms_square_t *squares,
                           uint32_t count, const opms_blur_options_t *options,
                           const opms_blur_t *blur, opms_error_t *err)
{
    if (!blur || !image || (count > 0 && !squares)) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL",
                         !blur ? "blur" : !image ? "image" : "squares");
    }
    if (count > OPMS_BAR_SQUARES) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%u squares; a bar has %d",
                         (unsigned)count, OPMS_BAR_SQUARES);
    }
    if (options && (options->struct_size != sizeof *options ||
                    !(options->sharp_most_px >= 0.3 && options->sharp_most_px <= 20.0))) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "options: fill in by opms_blur_options_init(); sharp_most_px 0.3 to 20");
    }
    OPMS_TRY(image_check(image, image->width_px, image->height_px, "picture", STAGE, err));
    return image->width_px > 0 && image->height_px > 0
               ? OPMS_OK
               : opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "image is %d x %d px",
                           (int)image->width_px, (int)image->height_px);
}

opms_status_t opms_blur_measure(const opms_image_t *image, const opms_square_t *squares,
                                uint32_t count, const opms_blur_options_t *options,
                                opms_blur_t *blur, opms_error_t *err)
{
    square_blur_t measured[OPMS_BAR_SQUARES];
    int found = 0;
    OPMS_TRY(check(image, squares, count, options, blur, err));
    const view_t view = view_of(image);
    memset(blur, 0, sizeof *blur);
    blur->sharpest_square = blur->softest_square = -1;
    for (uint32_t i = 0; i < count; ++i) {
        found += square_blur_measure(&view, &squares[i], &measured[found]);
    }
    blur->squares = (uint32_t)found;
    if (found > 0) {
        const double most = measure_all(measured, found, blur);
        measure_slope(measured, found, blur);
        blur->verdict = found < SQUARES_LEAST
                            ? OPMS_BLUR_UNKNOWN
                            : judge(blur, most, options ? options->sharp_most_px : 1.0);
    }
    return OPMS_OK;
}
