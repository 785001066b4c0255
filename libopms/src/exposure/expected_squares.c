/* SPDX-License-Identifier: Apache-2.0 */
#include <opms/exposure.h>

#include <math.h>

#include <opms/lens.h>

#include "base/fail.h"

#define STAGE "exposure"
#define NEAR_M 0.02 /* nothing nearer is in focus, or in the picture */

/* A point of the bar's plane in the picture; 0 where it is not there. */
static int see(const opms_lens_t *lens, const opms_transform_t *bar_camera, double x_m, double y_m,
               double px[2])
{
    const double *R = bar_camera->R, *t = bar_camera->t_m;
    const double p[3] = {x_m - t[0], y_m - t[1], -t[2]};
    double camera[3];
    for (int i = 0; i < 3; ++i) {
        camera[i] = R[i] * p[0] + R[3 + i] * p[1] + R[6 + i] * p[2];
    }
    return camera[2] > NEAR_M && opms_lens_project(lens, camera, px, NULL, NULL, NULL) == OPMS_OK &&
           px[0] >= 0.0 && px[1] >= 0.0 && px[0] <= lens->width_px - 1 &&
           px[1] <= lens->height_px - 1;
}

opms_status_t opms_exposure_expect(const opms_lens_t *lens, const opms_transform_t *bar_camera,
                                   opms_square_t *squares, uint32_t *count, opms_error_t *err)
{
    static const double sign[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    if (!bar_camera || !squares || !count) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL",
                         !bar_camera ? "bar_camera" : !squares ? "squares" : "count");
    }
    OPMS_TRY(opms_lens_check(lens, err));
    *count = 0;
    for (int k = 0; k < OPMS_BAR_SQUARES; ++k) {
        opms_square_t *square = &squares[*count];
        int seen = 1;
        for (int c = 0; c < 4 && seen; ++c) {
            const double x_m = 0.5 * OPMS_BAR_SQUARE_M * sign[c][0];
            const double y_m =
                OPMS_BAR_PITCH_M * (k - OPMS_BAR_ORIGIN) + 0.5 * OPMS_BAR_SQUARE_M * sign[c][1];
            seen = see(lens, bar_camera, x_m, y_m, square->corners_px[c]);
        }
        if (seen) {
            square->index = k;
            square->edges = 0;
            ++*count;
        }
    }
    return OPMS_OK;
}
