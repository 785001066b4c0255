/* SPDX-License-Identifier: Apache-2.0 */
/* From measured edges to the pose. The edges here are made from a known pose, so that the result
 * can be compared; a program gets them from opms_bar_detect() or from a detector of its own.
 *
 * Each side is measured in two stretches. With its middle alone nothing would tell how the squares
 * narrow with distance, and a bar turned about its long axis one way looks like one turned the
 * other way. */
#include <math.h>
#include <stdio.h>

#include <opms/lens.h>
#include <opms/pose.h>

#include "example_camera.h"

#define FIRST_SQUARE 10
#define LAST_SQUARE 22
#define STRETCHES 2 /* of each of the four sides */
#define EDGES ((LAST_SQUARE - FIRST_SQUARE + 1) * 4 * STRETCHES)

/** Pixel of the point (x, y, 0) of the bar for a camera at bar_camera. */
static opms_status_t see(const opms_lens_t *lens, const opms_transform_t *bar_camera, double x,
                         double y, double px[2], opms_error_t *err)
{
    const double d[3] = {x - bar_camera->t_m[0], y - bar_camera->t_m[1], -bar_camera->t_m[2]};
    double camera_m[3];
    for (int i = 0; i < 3; ++i) { /* the inverse of a rotation is its transpose */
        camera_m[i] = bar_camera->R[i] * d[0] + bar_camera->R[3 + i] * d[1] +
                      bar_camera->R[6 + i] * d[2];
    }
    return opms_lens_project(lens, camera_m, px, NULL, NULL, err);
}

/** One of the edges, as a detector would measure it. */
static opms_status_t measure(const opms_lens_t *lens, const opms_transform_t *bar_camera,
                             int number, opms_edge_t *edge, opms_error_t *err)
{
    static const double outward[4][2] = {{-1, 0}, {0, -1}, {1, 0}, {0, 1}};
    const int square = FIRST_SQUARE + number / (4 * STRETCHES), side = number / STRETCHES % 4;
    const double *out = outward[side];
    const double half = OPMS_BAR_SQUARE_M / 2, step = 1e-4;
    const double along_m = number % STRETCHES == 0 ? -0.6 * half : 0.6 * half;
    const double x = half * out[0] - along_m * out[1];
    const double y = (square - OPMS_BAR_ORIGIN) * OPMS_BAR_PITCH_M + half * out[1] +
                     along_m * out[0];
    double ahead[2], outside[2];
    *edge = (opms_edge_t){.square = square, .side = side, .bar_m = {x, y}, .sigma_px = 0.02,
                          .shift_gain = 1.0};
    opms_status_t status = see(lens, bar_camera, x, y, edge->px, err);
    if (status == OPMS_OK) {
        status = see(lens, bar_camera, x - step * out[1], y + step * out[0], ahead, err);
    }
    if (status == OPMS_OK) {
        status = see(lens, bar_camera, x + step * out[0], y + step * out[1], outside, err);
    }
    if (status == OPMS_OK) { /* the normal is square to the side in the picture, and points out */
        const double along[2] = {ahead[0] - edge->px[0], ahead[1] - edge->px[1]};
        const double to_out = -along[1] * (outside[0] - edge->px[0]) +
                              along[0] * (outside[1] - edge->px[1]);
        const double scale = copysign(1.0 / hypot(along[0], along[1]), to_out);
        edge->normal[0] = -scale * along[1];
        edge->normal[1] = scale * along[0];
    }
    return status;
}

int main(void)
{
    const opms_camera_t camera = example_camera();
    opms_transform_t truth = camera.detector_camera; /* the detector level and square to the bar */
    truth.t_m[0] += 0.30;
    opms_edge_t edges[EDGES];
    opms_pose_result_t result;
    opms_pose_t detector;
    opms_error_t err;

    opms_status_t status = OPMS_OK;
    for (int i = 0; i < EDGES && status == OPMS_OK; ++i) {
        status = measure(&camera.lens, &truth, i, &edges[i], &err);
    }
    if (status == OPMS_OK) {
        status = opms_pose_solve(&camera.lens, edges, EDGES, NULL, &result, &err);
    }
    if (status == OPMS_OK && result.state != OPMS_POSE_FOUND) {
        fprintf(stderr, "no pose\n");
        return 1;
    }
    if (status == OPMS_OK) {
        status = opms_pose_detector(&result, &camera, 0.0, &detector, NULL, &err);
    }
    if (status != OPMS_OK) {
        fprintf(stderr, "%s: %s\n", err.stage, err.message);
        return 1;
    }
    for (int i = 0; i < 3; ++i) {
        printf("detector %c = %8.3f mm +- %.3f mm (truth %8.3f mm)\n", "XYZ"[i],
               1e3 * detector.transform.t_m[i], 1e3 * sqrt(detector.covariance[7 * (3 + i)]),
               i == 0 ? 300.0 : 0.0);
    }
    return fabs(detector.transform.t_m[0] - 0.30) < 1e-4 ? 0 : 1;
}
