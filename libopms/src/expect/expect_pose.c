/* SPDX-License-Identifier: Apache-2.0 */
/* A straight edge of contrast A in noise s, blurred by a Gaussian of b px, tells its place with an
 * information of A^2 / (2 b sqrt(pi) s^2) a px of its length: the integral of the squared slope of
 * its profile, over the noise. */
#include <opms/expect.h>

#include <math.h>
#include <string.h>

#include "base/fail.h"
#include "expect/bar_in_view.h"

#define STAGE "expect"
#define SQRT_PI 1.7724538509055159
#define QUARTER_TURN 1.5707963267948968
/* opms_pose_solve() states 0.8626 of the inverse of the curvature that it meets, which noise has
 * lessened to 0.846 of that of exact edges; here they are exact, and what an M-estimate of Tukey's
 * with 6 sigmas reaches is 1.0193 of the inverse. */
#define OF_EXACT_EDGES (1.0193 / 0.8626)

void opms_expect_options_init(opms_expect_options_t *options)
{
    memset(options, 0, sizeof *options);
    options->struct_size = sizeof *options;
    options->contrast = 150.0;
    options->noise = 3.0;
    options->blur_px = 0.75;
    options->min_square_px = 7.0;
}

static int is_positive(double value)
{
    return isfinite(value) && value > 0.0;
}

static opms_status_t check_options(const opms_expect_options_t *options, opms_error_t *err)
{
    if (options->struct_size != sizeof *options) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "options->struct_size is %u: fill in by opms_expect_options_init()",
                         (unsigned)options->struct_size);
    }
    if (!is_positive(options->contrast) || !is_positive(options->noise) ||
        !is_positive(options->blur_px)) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "contrast %g, noise %g and blur_px %g must be above 0", options->contrast,
                         options->noise, options->blur_px);
    }
    if (!isfinite(options->min_square_px) || options->min_square_px < 0.0) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "min_square_px is %g",
                         options->min_square_px);
    }
    if (!(fabs(options->bar_tilt_rad) <= QUARTER_TURN)) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "bar_tilt_rad is %g, not -pi/2 to pi/2",
                         options->bar_tilt_rad);
    }
    return OPMS_OK;
}

static opms_status_t check_place(const opms_transform_t *ground_detector, opms_error_t *err)
{
    for (int i = 0; i < 3; ++i) {
        if (!isfinite(ground_detector->t_m[i])) {
            return opms_fail(err, OPMS_ERR_ARG, STAGE, i, "ground_detector->t_m is not finite");
        }
        for (int j = 0; j <= i; ++j) {
            double dot = 0.0;
            for (int k = 0; k < 3; ++k) {
                dot += ground_detector->R[3 * i + k] * ground_detector->R[3 * j + k];
            }
            if (!(fabs(dot - (i == j)) < 1e-6)) {
                return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                                 "ground_detector->R is no rotation");
            }
        }
    }
    return OPMS_OK;
}

/** c = a b of 3 x 3 row-major matrices. */
static void multiply(const double a[9], const double b[9], double c[9])
{
    for (int i = 0; i < 9; ++i) {
        const double *row = a + 3 * (i / 3), *column = b + i % 3;
        c[i] = row[0] * column[0] + row[1] * column[3] + row[2] * column[6];
    }
}

/** a_c from a_b and b_c. */
static void chain(const opms_transform_t *a_b, const opms_transform_t *b_c, opms_transform_t *a_c)
{
    multiply(a_b->R, b_c->R, a_c->R);
    for (int i = 0; i < 3; ++i) {
        const double *row = a_b->R + 3 * i;
        a_c->t_m[i] = row[0] * b_c->t_m[0] + row[1] * b_c->t_m[1] + row[2] * b_c->t_m[2] +
                      a_b->t_m[i];
    }
}

static opms_transform_t bar_camera_of(const opms_camera_t *camera,
                                      const opms_transform_t *ground_detector, double tilt_rad)
{
    const double c = cos(tilt_rad), s = sin(tilt_rad);
    const opms_transform_t bar_ground = {{c, 0, s, 0, 1, 0, -s, 0, c}, {0, 0, 0}};
    opms_transform_t ground_camera, bar_camera;
    chain(ground_detector, &camera->detector_camera, &ground_camera);
    chain(&bar_ground, &ground_camera, &bar_camera);
    return bar_camera;
}

/** The detector's covariance as a whole, and from the image alone. */
static opms_status_t split(const opms_pose_result_t *seen, const opms_camera_t *camera,
                           double tilt_rad, opms_expectation_t *expectation, opms_error_t *err)
{
    opms_camera_t exact = {0};
    opms_pose_t whole, image;
    exact.lens = camera->lens;
    exact.detector_camera = camera->detector_camera;
    exact.has_detector_camera = 1;
    OPMS_TRY(opms_pose_detector(seen, camera, tilt_rad, &whole, NULL, err));
    OPMS_TRY(opms_pose_detector(seen, &exact, tilt_rad, &image, NULL, err));
    for (int i = 0; i < 36; ++i) {
        expectation->covariance_image[i] = OF_EXACT_EDGES * image.covariance[i];
        expectation->covariance_calibration[i] = whole.covariance[i] - image.covariance[i];
    }
    return OPMS_OK;
}

opms_status_t opms_expect_pose(const opms_camera_t *camera, const opms_transform_t *ground_detector,
                               const opms_expect_options_t *options,
                               opms_expectation_t *expectation, opms_error_t *err)
{
    if (!camera || !ground_detector || !expectation) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL",
                         !camera            ? "camera"
                         : !ground_detector ? "ground_detector"
                                            : "expectation");
    }
    opms_expect_options_t chosen;
    opms_expect_options_init(&chosen);
    if (options) {
        chosen = *options;
    }
    OPMS_TRY(check_options(&chosen, err));
    OPMS_TRY(opms_camera_check(camera, err));
    if (!camera->has_detector_camera) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "camera does not say where it sits on the detector");
    }
    OPMS_TRY(check_place(ground_detector, err));
    memset(expectation, 0, sizeof *expectation);
    const opms_transform_t bar_camera =
        bar_camera_of(camera, ground_detector, chosen.bar_tilt_rad);
    const bar_in_view_light_t light = {
        sqrt(2.0 * SQRT_PI * chosen.blur_px) * chosen.noise / chosen.contrast,
        chosen.min_square_px};
    opms_edge_t edges[BAR_IN_VIEW_EDGES_MAX];
    const uint32_t count =
        bar_in_view(&camera->lens, &bar_camera, light, edges, &expectation->square_count);
    opms_pose_result_t seen;
    OPMS_TRY(opms_pose_solve(&camera->lens, edges, count, NULL, &seen, err));
    expectation->state = seen.state;
    return seen.state == OPMS_POSE_FOUND
               ? split(&seen, camera, chosen.bar_tilt_rad, expectation, err)
               : OPMS_OK;
}
