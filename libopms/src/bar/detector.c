/* SPDX-License-Identifier: Apache-2.0 */
#include <opms/bar.h>

#include <math.h>
#include <string.h>

#include <opms/lens.h>

#include "bar/bar_search.h"
#include "bar/stretch_fit.h"
#include "base/fail.h"
#include "base/memory.h"
#include "image/image_check.h"

#define STAGE "bar"
#define WORK_LEAST 4000000L

void opms_bar_options_init(opms_bar_options_t *options)
{
    if (options) {
        memset(options, 0, sizeof *options);
        options->struct_size = sizeof *options;
        options->min_square_px = 7;
    }
}

/** The largest radius of a ray inside the picture, with a little to spare. */
static double ray_limit_of(const opms_lens_t *lens)
{
    double most = 0;
    for (int i = 0; i <= 16; ++i) {
        const double u = lens->width_px * i / 16.0 - 0.5, v = lens->height_px * i / 16.0 - 0.5;
        const double border[4][2] = {
            {u, -0.5}, {u, lens->height_px - 0.5}, {-0.5, v}, {lens->width_px - 0.5, v}};
        for (int k = 0; k < 4; ++k) {
            double ray[2];
            if (opms_lens_unproject(lens, border[k], ray, NULL, NULL) == OPMS_OK) {
                most = fmax(most, hypot(ray[0], ray[1]));
            }
        }
    }
    return 1.03 * most;
}

opms_status_t opms_bar_detector_create(const opms_lens_t *lens, const opms_bar_options_t *options,
                                       opms_bar_detector_t **detector, opms_error_t *err)
{
    if (!detector) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "detector is NULL");
    }
    OPMS_TRY(opms_lens_check(lens, err));
    opms_bar_options_t chosen;
    opms_bar_options_init(&chosen);
    if (options) {
        if (options->struct_size < sizeof chosen.struct_size ||
            options->struct_size > sizeof chosen) {
            return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                             "options.struct_size is %u, this library knows up to %u",
                             (unsigned)options->struct_size, (unsigned)sizeof chosen);
        }
        memcpy(&chosen, options, options->struct_size);
    }
    if (chosen.min_square_px < 6 || chosen.min_square_px > 64) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "min_square_px is %d, allowed are 6 to 64",
                         (int)chosen.min_square_px);
    }
    OPMS_TRY(opms_check_allocator(&chosen.allocator, STAGE, err));
    opms_bar_detector_t *fresh = opms_take(&chosen.allocator, sizeof *fresh);
    if (!fresh) {
        return opms_fail(err, OPMS_ERR_MEMORY, STAGE, -1, "no memory for a detector (%zu bytes)",
                         sizeof *fresh);
    }
    fresh->lens = *lens;
    fresh->options = chosen;
    fresh->kernel = stretch_kernel(1);
    fresh->ray_limit = ray_limit_of(lens);
    *detector = fresh;
    return OPMS_OK;
}

void opms_bar_detector_destroy(opms_bar_detector_t *detector)
{
    if (detector) {
        opms_give_back(&detector->options.allocator, detector);
    }
}

static opms_status_t check_roi(const opms_image_t *image, const opms_roi_t *roi, opms_roi_t *whole,
                               opms_error_t *err)
{
    const opms_roi_t all = {0, 0, image->width_px, image->height_px};
    *whole = all;
    if (!roi || roi->width_px == 0 || roi->height_px == 0) {
        return OPMS_OK;
    }
    if (roi->x_px < 0 || roi->y_px < 0 || roi->width_px < 0 || roi->height_px < 0 ||
        roi->width_px > image->width_px - roi->x_px ||
        roi->height_px > image->height_px - roi->y_px) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "roi %d,%d %d x %d is not inside the picture", (int)roi->x_px,
                         (int)roi->y_px, (int)roi->width_px, (int)roi->height_px);
    }
    *whole = *roi;
    return OPMS_OK;
}

static opms_status_t check_hint(const opms_transform_t *hint, opms_error_t *err)
{
    for (int i = 0; hint && i < 12; ++i) {
        if (!isfinite(i < 9 ? hint->R[i] : hint->t_m[i - 9])) {
            return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                             "hint holds a number that is not finite");
        }
    }
    return OPMS_OK;
}

static void begin(opms_bar_detector_t *d, const opms_image_t *image, const opms_roi_t *roi)
{
    opms_image_t part = *image;
    const ptrdiff_t size = image->format == OPMS_PIXEL_GREY16 ? 2 : 1;
    part.pixels =
        (const uint8_t *)image->pixels + roi->y_px * image->stride_bytes + roi->x_px * size;
    part.width_px = roi->width_px;
    part.height_px = roi->height_px;
    d->view = view_of(&part);
    d->local_lens = d->lens;
    d->local_lens.cx_px -= roi->x_px;
    d->local_lens.cy_px -= roi->y_px;
    const int longer = d->view.width > d->view.height ? d->view.width : d->view.height;
    d->limits.longest_contour = longer < QUAD_POINTS_MAX ? longer : QUAD_POINTS_MAX;
    d->limits.shortest_side = 5.f;
    /* Bounds the time of pictures that are full of what might be a square. */
    d->work_left = WORK_LEAST + (long)d->view.width * d->view.height / 5;
    d->rejected_count = 0;
    d->settled = 0;
    d->square_count = d->edge_count = 0;
}

opms_status_t opms_bar_detect(opms_bar_detector_t *detector, const opms_image_t *image,
                              const opms_roi_t *roi, const opms_transform_t *hint,
                              opms_bar_summary_t *summary, opms_error_t *err)
{
    if (!detector || !summary) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL",
                         detector ? "summary" : "detector");
    }
    OPMS_TRY(image_check(image, detector->lens.width_px, detector->lens.height_px, "lens", STAGE,
                         err));
    opms_roi_t whole;
    OPMS_TRY(check_roi(image, roi, &whole, err));
    OPMS_TRY(check_hint(hint, err));
    memset(summary, 0, sizeof *summary);
    begin(detector, image, &whole);
    const int floor_grey = 8 * detector->view.white_level / 255;
    const int least =
        image->format == OPMS_PIXEL_GREY8 ? floor_grey : (floor_grey < 32 ? floor_grey : 32);
    bar_search(detector, hint, least, &whole, summary);
    return OPMS_OK;
}

const opms_square_t *opms_bar_squares(const opms_bar_detector_t *detector, uint32_t *count)
{
    if (count) {
        *count = detector ? detector->square_count : 0;
    }
    return detector ? detector->squares : NULL;
}

const opms_edge_t *opms_bar_edges(const opms_bar_detector_t *detector, uint32_t *count)
{
    if (count) {
        *count = detector ? detector->edge_count : 0;
    }
    return detector ? detector->edges : NULL;
}
