/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes as a picture, with any lens, region and hint: whatever is seen in them, what comes out
 * keeps the promises of opms/locate.h, and a second call gives the same.
 *
 * The first bytes set up the call (struct setup), the others are the pixels, over and over again
 * until the picture is full. make_locate_corpus.py writes seeds of this form. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <opms/opms.h>

#include "fuzz_picture.h"

/* All of one byte, so that a fuzzer's change of a byte is a change of one thing. */
struct setup {
    uint8_t width, height;  /* less one */
    uint8_t flags;          /* enum flag */
    uint8_t min_square;
    int8_t focal, cx, cy;   /* 2, 1, 1 per cent of the longer side, about 0.6 and the middle */
    int8_t k1, k2, p1, p2;  /* per cent, per cent, per mille, per mille */
    uint8_t roi[4];
    uint8_t padding;        /* bytes after each row */
};

enum flag { FLAG_16_BIT = 1, FLAG_ROI = 2, FLAG_HINT = 4, FLAG_WHITE_LEVEL = 8 };

static opms_camera_t make_camera(const struct setup *setup)
{
    opms_camera_t camera = {0};
    opms_lens_t *lens = &camera.lens;
    lens->width_px = setup->width + 1;
    lens->height_px = setup->height + 1;
    const double longer = fmax(lens->width_px, lens->height_px);
    lens->fx_px = lens->fy_px = longer * (0.6 + setup->focal / 50.0);
    lens->cx_px = (lens->width_px - 1) / 2.0 + longer * setup->cx / 100.0;
    lens->cy_px = (lens->height_px - 1) / 2.0 + longer * setup->cy / 100.0;
    lens->k1 = setup->k1 / 100.0;
    lens->k2 = setup->k2 / 100.0;
    lens->p1 = setup->p1 / 1000.0;
    lens->p2 = setup->p2 / 1000.0;
    return camera;
}

static void require_finite(const double *values, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        require(isfinite(values[i]));
    }
}

static void check_squares(const opms_locator_t *locator)
{
    uint32_t count = 0;
    const opms_square_t *squares = opms_locator_squares(locator, &count);
    require(count <= OPMS_BAR_SQUARES);
    for (uint32_t i = 0; i < count; ++i) {
        require(squares[i].index >= 0 && squares[i].index < OPMS_BAR_SQUARES);
        require(i == 0 || squares[i].index > squares[i - 1].index);
        require_finite(&squares[i].corners_px[0][0], 8);
    }
}

static void check_edges(const opms_locator_t *locator)
{
    uint32_t count = 0;
    const opms_edge_t *edges = opms_locator_edges(locator, &count);
    require(count <= OPMS_BAR_EDGES_MAX);
    for (uint32_t i = 0; i < count; ++i) {
        require(edges[i].square >= 0 && edges[i].square < OPMS_BAR_SQUARES);
        require(edges[i].side >= 0 && edges[i].side < 4);
        require_finite(edges[i].px, 2);
        require(isfinite(edges[i].sigma_px) && edges[i].sigma_px > 0);
        require(fabs(hypot(edges[i].normal[0], edges[i].normal[1]) - 1) < 1e-6);
    }
    const double *residuals = opms_locator_residuals_px(locator);
    if (residuals) {
        require_finite(residuals, count);
    }
}

static void check_location(const opms_location_t *location)
{
    require(location->state == OPMS_BAR_ABSENT || location->state == OPMS_BAR_LOCATED ||
            location->state == OPMS_BAR_AMBIGUOUS);
    if (location->state == OPMS_BAR_LOCATED) {
        const opms_pose_t *pose = &location->pose.bar_camera;
        require(location->pose.state == OPMS_POSE_FOUND);
        require_finite(pose->transform.R, 9);
        require_finite(pose->transform.t_m, 3);
        require_finite(pose->covariance, 36);
        for (int i = 0; i < 6; ++i) {
            require(pose->covariance[7 * i] > 0);
        }
    }
}

static void locate_twice(opms_locator_t *locator, const opms_image_t *image, const opms_roi_t *roi,
                         const opms_transform_t *hint)
{
    opms_location_t first, second;
    if (opms_locator_locate(locator, image, roi, hint, &first, NULL) != OPMS_OK) {
        return;
    }
    check_location(&first);
    check_squares(locator);
    check_edges(locator);
    require(opms_locator_locate(locator, image, roi, hint, &second, NULL) == OPMS_OK);
    require(second.state == first.state);
    if (first.state == OPMS_BAR_LOCATED) {
        require(memcmp(first.pose.bar_camera.transform.t_m, second.pose.bar_camera.transform.t_m,
                       sizeof first.pose.bar_camera.transform.t_m) == 0);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct setup setup;
    if (size < sizeof setup) {
        return 0;
    }
    memcpy(&setup, data, sizeof setup);

    const opms_camera_t camera = make_camera(&setup);
    opms_locator_options_t options;
    opms_locator_options_init(&options);
    options.bar.min_square_px = setup.min_square;
    opms_locator_t *locator = NULL;
    if (opms_locator_create(&camera, &options, &locator, NULL) != OPMS_OK) {
        return 0;
    }
    opms_image_t image;
    const struct fuzz_picture picture = {setup.width, setup.height, setup.padding,
                                         setup.flags & FLAG_16_BIT,
                                         setup.flags & FLAG_WHITE_LEVEL};
    void *pixels = make_pixels(&picture, data + sizeof setup, size - sizeof setup, &image);
    const opms_roi_t roi = {setup.roi[0], setup.roi[1], setup.roi[2], setup.roi[3]};
    const opms_transform_t hint = {.R = {0, 1, 0, 1, 0, 0, 0, 0, -1},
                                   .t_m = {setup.roi[0] / 1000.0, setup.roi[1] / 1000.0, 0.4}};
    locate_twice(locator, &image, setup.flags & FLAG_ROI ? &roi : NULL,
                 setup.flags & FLAG_HINT ? &hint : NULL);
    free(pixels);
    opms_locator_destroy(locator);
    return 0;
}
