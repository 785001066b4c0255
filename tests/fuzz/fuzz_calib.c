/* SPDX-License-Identifier: Apache-2.0 */
/* Any options, and pictures that are views of a plane bent by any bytes: whatever the calibrator
 * makes of them, it keeps the promises of opms/calib.h and says the same again.
 *
 * The first bytes are the options (struct setup), then one record a picture (struct view); what
 * follows disturbs the points, over and over again. make_calib_corpus.py writes seeds of this
 * form. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <opms/calib.h>
#include <opms/lens.h>

#define VIEWS_MAX 8
#define POINTS_MAX 64

/* All of one byte, so that a fuzzer's change of a byte is a change of one thing. */
struct setup {
    uint8_t width, height; /* 16 px each */
    uint8_t focal;         /* 2 per cent of the width */
    int8_t k1, k2;         /* per cent */
    uint8_t views;
    uint8_t flags;         /* enum flag */
    uint8_t odd;           /* which point of which picture is not a number or has no sigma */
};

enum flag { FLAG_COCKLE = 1, FLAG_NAN = 2, FLAG_NO_SIGMA = 4, FLAG_RAW = 8, FLAG_TWICE = 16 };

struct view {
    int8_t tilt[2], turn;  /* 1/100 rad, 1/40 rad */
    int8_t at[2];          /* mm */
    uint8_t distance;      /* 4 mm, from 0.1 m */
    uint8_t points;        /* at most POINTS_MAX count */
    uint8_t disturbance;   /* largest, 1/16 px; 255: 16 times the picture */
};

struct bytes {
    const uint8_t *data;
    size_t size, next;
};

static void require(int holds)
{
    if (!holds) {
        abort();
    }
}

/* -1 to 1 */
static double take(struct bytes *bytes)
{
    return bytes->size ? (bytes->data[bytes->next++ % bytes->size] - 127.5) / 127.5 : 0.0;
}

static void rotate(double R[9], int axis, double angle)
{
    const double c = cos(angle), s = sin(angle);
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    for (int i = 0; i < 3; ++i) {
        const double u = R[3 * i + a], v = R[3 * i + b];
        R[3 * i + a] = c * u + s * v;
        R[3 * i + b] = c * v - s * u;
    }
}

/* A pinhole's picture of the target's points, distorted, and disturbed. */
static uint32_t look(const struct setup *setup, const struct view *view, struct bytes *bytes,
                     opms_calib_point_t *points)
{
    const double width = 16.0 * setup->width, height = 16.0 * setup->height;
    const double focal = 0.02 * (setup->focal + 1) * width;
    const double most = view->disturbance == 255 ? 16.0 * width : view->disturbance / 16.0;
    const double distance = 0.1 + 0.004 * view->distance;
    const uint32_t count = view->points % (POINTS_MAX + 1);
    double R[9] = {1, 0, 0, 0, -1, 0, 0, 0, -1};
    rotate(R, 2, view->turn / 40.0);
    rotate(R, 0, view->tilt[0] / 100.0);
    rotate(R, 1, view->tilt[1] / 100.0);
    for (uint32_t i = 0; i < count; ++i) {
        const double X = 0.025 * ((int)(i % 8) - 3.5), Y = 0.025 * ((int)(i / 8) - 3.5);
        const double d[3] = {X - 0.001 * view->at[0] + distance * R[2],
                             Y - 0.001 * view->at[1] + distance * R[5], distance * R[8]};
        double p[3];
        for (int k = 0; k < 3; ++k) {
            p[k] = R[k] * d[0] + R[3 + k] * d[1] + R[6 + k] * d[2];
        }
        const double x = p[0] / p[2], y = p[1] / p[2], r2 = x * x + y * y;
        const double bent = 1.0 + 0.01 * setup->k1 * r2 + 0.01 * setup->k2 * r2 * r2;
        const int raw = (setup->flags & FLAG_RAW) != 0;
        points[i].target_m[0] = raw ? take(bytes) : X;
        points[i].target_m[1] = raw ? take(bytes) : Y;
        points[i].px[0] = focal * x * bent + 0.5 * width + most * take(bytes);
        points[i].px[1] = focal * y * bent + 0.5 * height + most * take(bytes);
        points[i].sigma_px = 0.05 + 0.04 * take(bytes);
    }
    if (count > 0 && setup->flags & FLAG_NAN) {
        points[setup->odd % count].px[setup->odd & 1] = NAN;
    }
    if (count > 0 && setup->flags & FLAG_NO_SIGMA) {
        points[setup->odd % count].sigma_px = 0.0;
    }
    return count;
}

static void require_covariance(const double *values, int size)
{
    for (int i = 0; i < size * size; ++i) {
        require(isfinite(values[i]));
    }
    for (int i = 0; i < size; ++i) {
        require(values[i * size + i] > 0.0);
    }
}

static void check_picture(const opms_calibrator_t *calibrator, uint32_t k)
{
    opms_calib_picture_t picture;
    double residuals[2 * POINTS_MAX], weights[POINTS_MAX];
    require(opms_calibrator_picture(calibrator, k, &picture, NULL) == OPMS_OK);
    require(opms_calibrator_residuals(calibrator, k, residuals, weights, NULL) == OPMS_OK);
    require(picture.points <= POINTS_MAX && picture.outliers <= picture.points);
    if (picture.use != OPMS_CALIB_USED) {
        return;
    }
    require_covariance(picture.target_camera.covariance, 6);
    require(isfinite(picture.residual_rms_px) && isfinite(picture.gain));
    for (uint32_t i = 0; i < picture.points; ++i) {
        require(weights[i] >= 0.0 && weights[i] <= 1.0);
        require(isfinite(residuals[2 * i]) && isfinite(residuals[2 * i + 1]));
    }
}

static void check_answers(const opms_calibrator_t *calibrator, const opms_calib_result_t *result)
{
    uint32_t chosen[VIEWS_MAX], count = 0;
    opms_camera_t camera = {0};
    const opms_footprint_t footprint = {0, 0.3, 0.0, 0.1, 0.001, 0.01};
    require(opms_lens_check(&result->lens, NULL) == OPMS_OK);
    require_covariance(result->covariance, 8);
    require(result->pictures_used >= 3);
    require(isfinite(result->residual_rms_px) && isfinite(result->chi2_dof));
    require(result->coverage >= 0.0 && result->coverage <= 1.0);
    require(isfinite(result->cockle_peak_m));
    require(opms_calibrator_choose(calibrator, VIEWS_MAX, chosen, &count, NULL) == OPMS_OK);
    require(count <= result->pictures_used);
    if (opms_calibrator_camera(calibrator, &footprint, 1, &camera, NULL) == OPMS_OK) {
        require_covariance(camera.covariance_intrinsics, 8);
        require_covariance(camera.covariance_detector_camera, 6);
    }
}

/* Solve, once more from the solution, and with a picture less. */
static void solve(opms_calibrator_t *calibrator, uint32_t pictures, int twice)
{
    opms_calib_result_t result;
    for (int round = 0; round <= twice; ++round) {
        const opms_status_t status = opms_calibrator_solve(calibrator, &result, NULL);
        require(status == OPMS_OK || status == OPMS_ERR_DOMAIN || status == OPMS_ERR_CONVERGE);
        if (status == OPMS_OK) {
            check_answers(calibrator, &result);
        }
        for (uint32_t k = 0; k < pictures; ++k) {
            check_picture(calibrator, k);
        }
        if (pictures > 0) {
            require(opms_calibrator_use(calibrator, 0, 0, NULL) == OPMS_OK);
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct setup setup;
    opms_calib_options_t options;
    opms_calibrator_t *calibrator = NULL;
    opms_calib_point_t points[POINTS_MAX];
    if (size < sizeof setup) {
        return 0;
    }
    memcpy(&setup, data, sizeof setup);
    opms_calib_options_init(&options);
    options.width_px = 16 * setup.width;
    options.height_px = 16 * setup.height;
    options.pictures_max = VIEWS_MAX;
    options.points_max = POINTS_MAX;
    options.cockle_sigma_m = setup.flags & FLAG_COCKLE ? 0.002 : 0.0;
    if (opms_calibrator_create(&options, &calibrator, NULL) != OPMS_OK) {
        return 0;
    }
    const uint32_t views = setup.views % (VIEWS_MAX + 1);
    const size_t head = sizeof setup + views * sizeof(struct view);
    struct bytes bytes = {data + head, size > head ? size - head : 0, 0};
    uint32_t pictures = 0;
    for (uint32_t k = 0; k < views && size >= head; ++k) {
        struct view view;
        memcpy(&view, data + sizeof setup + k * sizeof view, sizeof view);
        const uint32_t count = look(&setup, &view, &bytes, points);
        pictures += opms_calibrator_add(calibrator, points, count, NULL, NULL) == OPMS_OK;
    }
    solve(calibrator, pictures, (setup.flags & FLAG_TWICE) != 0);
    opms_calibrator_destroy(calibrator);
    return 0;
}
