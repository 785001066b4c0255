/* SPDX-License-Identifier: Apache-2.0 */
/* Beside each square there are 5 mm of white on both sides; nothing further off belongs to the bar.
 * A square's corners say where that is: they are carried on bilinearly, by a quarter of a square.
 * Levels are counted in histograms, so that a percentile of thousands of samples costs nothing. */
#include <opms/exposure.h>

#include <math.h>
#include <string.h>

#include "base/fail.h"
#include "image/image_check.h"
#include "image/view.h"

#define STAGE "exposure"
#define BINS 512
#define WHITE_X 1.24     /* half squares: 12.4 mm */
#define SIDE_MOST 0.8    /* half squares along the side */
#define ALONG 9          /* samples of the white on each side */
#define INSIDE 5         /* samples of the black, each way */
#define INSIDE_MOST 0.5  /* half squares */
#define PICTURE_STEPS 64 /* samples of the picture, each way */
#define SATURATED 0.995

typedef struct histogram {
    uint32_t count[BINS + 1];
    uint32_t total, saturated;
} histogram_t;

static void add(histogram_t *histogram, const view_t *view, double u, double v)
{
    if (!(u >= 0.0 && v >= 0.0 && u <= view->width - 1 && v <= view->height - 1)) {
        return;
    }
    const int grey = view_at(view, (int)(u + 0.5), (int)(v + 0.5));
    const double level = (double)grey / view->white_level;
    const int bin = (int)(level * BINS);
    ++histogram->count[bin < BINS ? bin : BINS];
    ++histogram->total;
    histogram->saturated += level >= SATURATED;
}

static double percentile(const histogram_t *histogram, double part)
{
    const double wanted = part * histogram->total;
    double below = 0.0;
    for (int i = 0; i <= BINS; ++i) {
        below += histogram->count[i];
        if (below >= wanted && histogram->count[i] > 0) {
            return i == BINS ? 1.0 : (i + 0.5) / BINS;
        }
    }
    return 0.0;
}

/* The place (x, y) of a square in half squares, corners at -1 and 1. */
static void place(const opms_square_t *square, double x, double y, double px[2])
{
    static const double corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    px[0] = px[1] = 0.0;
    for (int c = 0; c < 4; ++c) {
        const double weight = 0.25 * (1.0 + corner[c][0] * x) * (1.0 + corner[c][1] * y);
        px[0] += weight * square->corners_px[c][0];
        px[1] += weight * square->corners_px[c][1];
    }
}

static void add_square(const view_t *view, const opms_square_t *square, histogram_t *white,
                       histogram_t *black)
{
    double px[2];
    for (int side = -1; side <= 1; side += 2) {
        for (int i = 0; i < ALONG; ++i) {
            place(square, side * WHITE_X, SIDE_MOST * (2.0 * i / (ALONG - 1) - 1.0), px);
            add(white, view, px[0], px[1]);
        }
    }
    for (int i = 0; i < INSIDE * INSIDE; ++i) {
        const double x = INSIDE_MOST * (2.0 * (i % INSIDE) / (INSIDE - 1) - 1.0);
        const double y = INSIDE_MOST * (2.0 * (i / INSIDE) / (INSIDE - 1) - 1.0);
        place(square, x, y, px);
        add(black, view, px[0], px[1]);
    }
}

static int is_finite_square(const opms_square_t *square)
{
    for (int c = 0; c < 4; ++c) {
        if (!isfinite(square->corners_px[c][0]) || !isfinite(square->corners_px[c][1])) {
            return 0;
        }
    }
    return 1;
}

static void measure_picture(const view_t *view, opms_exposure_light_t *light)
{
    histogram_t all;
    memset(&all, 0, sizeof all);
    for (int i = 0; i < PICTURE_STEPS * PICTURE_STEPS; ++i) {
        add(&all, view, (i % PICTURE_STEPS + 0.5) / PICTURE_STEPS * (view->width - 1),
            (i / PICTURE_STEPS + 0.5) / PICTURE_STEPS * (view->height - 1));
    }
    light->picture_white = percentile(&all, 0.9);
    light->picture_black = percentile(&all, 0.1);
}

opms_status_t opms_exposure_measure(const opms_image_t *image, const opms_square_t *squares,
                                    uint32_t count, opms_exposure_light_t *light,
                                    opms_error_t *err)
{
    if (!light || (count > 0 && !squares)) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL", light ? "squares" : "light");
    }
    if (!image) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "image is NULL");
    }
    OPMS_TRY(image_check(image, image->width_px, image->height_px, "picture", STAGE, err));
    if (image->width_px < 1 || image->height_px < 1) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "image is %d x %d px",
                         (int)image->width_px, (int)image->height_px);
    }
    const view_t view = view_of(image);
    histogram_t white, black;
    memset(&white, 0, sizeof white);
    memset(&black, 0, sizeof black);
    memset(light, 0, sizeof *light);
    measure_picture(&view, light);
    for (uint32_t k = 0; k < count; ++k) {
        const uint32_t before = white.total;
        if (is_finite_square(&squares[k])) {
            add_square(&view, &squares[k], &white, &black);
        }
        light->squares += white.total > before;
    }
    if (white.total == 0 || black.total == 0) {
        light->squares = 0;
        return OPMS_OK;
    }
    light->white = percentile(&white, 0.5);
    light->white_high = percentile(&white, 0.95);
    light->black = percentile(&black, 0.5);
    light->saturated = (double)white.saturated / white.total;
    return OPMS_OK;
}
