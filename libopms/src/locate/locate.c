/* SPDX-License-Identifier: Apache-2.0 */
#include <opms/locate.h>

#include <string.h>

#include <opms/lens.h>

#include "base/fail.h"
#include "base/memory.h"

#define STAGE "locate"

struct opms_locator {
    opms_camera_t camera;
    opms_locator_options_t options;
    opms_bar_detector_t *detector;
    /* Of the last picture. */
    const opms_square_t *squares;
    const opms_edge_t *edges;
    uint32_t square_count, edge_count;
    int has_residuals;
    double residuals_px[OPMS_BAR_EDGES_MAX];
    opms_edge_t given[OPMS_BAR_EDGES_MAX]; /* edges of opms_locator_solve() */
    opms_square_t seen[OPMS_BAR_SQUARES];  /* squares of opms_locator_solve() */
};

void opms_locator_options_init(opms_locator_options_t *options)
{
    if (options) {
        memset(options, 0, sizeof *options);
        options->struct_size = sizeof *options;
        opms_bar_options_init(&options->bar);
    }
}

opms_status_t opms_locator_create(const opms_camera_t *camera,
                                  const opms_locator_options_t *options, opms_locator_t **locator,
                                  opms_error_t *err)
{
    if (!camera || !locator) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL", camera ? "locator" : "camera");
    }
    OPMS_TRY(opms_camera_check(camera, err));
    opms_locator_options_t chosen;
    opms_locator_options_init(&chosen);
    if (options) {
        if (options->struct_size != sizeof chosen) {
            return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                             "options.struct_size is %u, this library needs %u",
                             (unsigned)options->struct_size, (unsigned)sizeof chosen);
        }
        chosen = *options;
    }
    if (!(chosen.bar_tilt_rad > -1.5707964 && chosen.bar_tilt_rad < 1.5707964)) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "bar_tilt_rad is %g, allowed is -pi/2 to pi/2", chosen.bar_tilt_rad);
    }
    opms_bar_detector_t *detector;
    OPMS_TRY(opms_bar_detector_create(&camera->lens, &chosen.bar, &detector, err));
    opms_locator_t *fresh = opms_take(&chosen.bar.allocator, sizeof *fresh);
    if (!fresh) {
        opms_bar_detector_destroy(detector);
        return opms_fail(err, OPMS_ERR_MEMORY, STAGE, -1, "no memory for a locator (%zu bytes)",
                         sizeof *fresh);
    }
    fresh->camera = *camera;
    fresh->options = chosen;
    fresh->detector = detector;
    *locator = fresh;
    return OPMS_OK;
}

void opms_locator_destroy(opms_locator_t *locator)
{
    if (locator) {
        opms_bar_detector_destroy(locator->detector);
        opms_give_back(&locator->options.bar.allocator, locator);
    }
}

/** Pose of the locator's edges, and of the detector where the camera knows it. */
static opms_status_t solve(opms_locator_t *locator, opms_location_t *location, opms_error_t *err)
{
    OPMS_TRY(opms_pose_solve(&locator->camera.lens, locator->edges, locator->edge_count,
                             locator->residuals_px, &location->pose, err));
    if (location->pose.state != OPMS_POSE_FOUND) {
        location->state = OPMS_BAR_AMBIGUOUS;
        return OPMS_OK;
    }
    location->state = OPMS_BAR_LOCATED;
    locator->has_residuals = 1;
    if (locator->camera.has_detector_camera) {
        OPMS_TRY(opms_pose_detector(&location->pose, &locator->camera,
                                    locator->options.bar_tilt_rad, &location->ground_detector,
                                    &location->covariance_includes, err));
        location->has_ground_detector = 1;
    }
    return OPMS_OK;
}

opms_status_t opms_locator_locate(opms_locator_t *locator, const opms_image_t *image,
                                  const opms_roi_t *roi, const opms_transform_t *hint,
                                  opms_location_t *location, opms_error_t *err)
{
    if (!locator || !location) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL",
                         locator ? "location" : "locator");
    }
    opms_bar_summary_t summary;
    OPMS_TRY(opms_bar_detect(locator->detector, image, roi, hint, &summary, err));
    memset(location, 0, sizeof *location);
    location->bar = summary;
    location->state = summary.state;
    location->followed = summary.followed;
    locator->squares = opms_bar_squares(locator->detector, &locator->square_count);
    locator->edges = opms_bar_edges(locator->detector, &locator->edge_count);
    locator->has_residuals = 0;
    return summary.state == OPMS_BAR_LOCATED ? solve(locator, location, err) : OPMS_OK;
}

/** Project the corners of the squares that the given edges belong to. */
static void squares_of_pose(opms_locator_t *locator, const opms_transform_t *pose)
{
    uint32_t edges[OPMS_BAR_SQUARES] = {0};
    for (uint32_t i = 0; i < locator->edge_count; ++i) {
        ++edges[locator->edges[i].square];
    }
    locator->square_count = 0;
    for (int k = 0; k < OPMS_BAR_SQUARES; ++k) {
        opms_square_t *square = &locator->seen[locator->square_count];
        int all = edges[k] > 0;
        for (int c = 0; all && c < 4; ++c) {
            const double half = 0.5 * OPMS_BAR_SQUARE_M;
            const double p[3] = {(c == 1 || c == 2 ? half : -half) - pose->t_m[0],
                                 OPMS_BAR_PITCH_M * (k - OPMS_BAR_ORIGIN) +
                                     (c >= 2 ? half : -half) - pose->t_m[1],
                                 -pose->t_m[2]};
            const double *R = pose->R;
            const double in_camera[3] = {R[0] * p[0] + R[3] * p[1] + R[6] * p[2],
                                         R[1] * p[0] + R[4] * p[1] + R[7] * p[2],
                                         R[2] * p[0] + R[5] * p[1] + R[8] * p[2]};
            all = opms_lens_project(&locator->camera.lens, in_camera, square->corners_px[c], NULL,
                                    NULL, NULL) == OPMS_OK;
        }
        square->index = k;
        square->edges = edges[k];
        locator->square_count += (uint32_t)all;
    }
}

opms_status_t opms_locator_solve(opms_locator_t *locator, const opms_edge_t *edges, uint32_t count,
                                 opms_location_t *location, opms_error_t *err)
{
    if (!locator || !location || (!edges && count > 0)) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL",
                         !locator ? "locator" : !location ? "location" : "edges");
    }
    if (count > OPMS_BAR_EDGES_MAX) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "count is %u, at most %d edges are taken",
                         (unsigned)count, OPMS_BAR_EDGES_MAX);
    }
    for (uint32_t i = 0; i < count; ++i) {
        if (edges[i].square < 0 || edges[i].square >= OPMS_BAR_SQUARES) {
            return opms_fail(err, OPMS_ERR_ARG, STAGE, (int32_t)i, "edges[%u].square is %d",
                             (unsigned)i, (int)edges[i].square);
        }
    }
    if (count > 0) {
        memmove(locator->given, edges, count * sizeof edges[0]);
    }
    memset(location, 0, sizeof *location);
    locator->edges = locator->given;
    locator->edge_count = count;
    locator->squares = locator->seen;
    locator->square_count = 0;
    locator->has_residuals = 0;
    OPMS_TRY(solve(locator, location, err));
    if (location->pose.state == OPMS_POSE_NONE) {
        location->state = OPMS_BAR_ABSENT;
    }
    if (location->state == OPMS_BAR_LOCATED) {
        squares_of_pose(locator, &location->pose.bar_camera.transform);
    }
    location->bar.state = location->state;
    location->bar.edge_count = count;
    location->bar.square_count = locator->square_count;
    return OPMS_OK;
}

const opms_square_t *opms_locator_squares(const opms_locator_t *locator, uint32_t *count)
{
    if (count) {
        *count = locator ? locator->square_count : 0;
    }
    return locator ? locator->squares : NULL;
}

const opms_edge_t *opms_locator_edges(const opms_locator_t *locator, uint32_t *count)
{
    if (count) {
        *count = locator ? locator->edge_count : 0;
    }
    return locator ? locator->edges : NULL;
}

const double *opms_locator_residuals_px(const opms_locator_t *locator)
{
    return locator && locator->has_residuals ? locator->residuals_px : NULL;
}
