/* SPDX-License-Identifier: Apache-2.0 */
/* Is the stated uncertainty true? Noise of the stated size is put on exact edges, intrinsics and
 * mountings; the squared distance of the result from the truth, in its own covariance, must be as
 * chi2 is. */
#include <stdlib.h>

#include <unity.h>

#include <opms/pose.h>

#include "truth_chi2.h"
#include "truth_scene.h"

#define RUNS 2000
#define QUARTER (RUNS / 4)
#define CHI2_6_95 12.592
#define CHI2_3_95 7.815

static opms_error_t err;
static opms_edge_t edges[OPMS_BAR_EDGES_MAX];

/** One run: the stated position sigma, and chi2 of position and pose. */
typedef struct outcome {
    double sigma_m, chi2_3, chi2_6;
} outcome_t;

static outcome_t outcomes[RUNS];

void setUp(void)
{
    memset(&err, 0, sizeof err);
}

void tearDown(void)
{
}

static outcome_t compare(const opms_pose_t *found, const opms_transform_t *truth)
{
    double x[6];
    truth_small_rotation(found->transform.R, truth->R, x);
    for (int i = 0; i < 3; ++i) {
        x[3 + i] = truth->t_m[i] - found->transform.t_m[i];
    }
    const double *const c = found->covariance;
    const outcome_t outcome = {sqrt(c[21] + c[28] + c[35]), truth_chi2(c + 21, 6, x + 3, 3),
                               truth_chi2(c, 6, x, 6)};
    return outcome;
}

static int by_sigma(const void *a, const void *b)
{
    const double x = ((const outcome_t *)a)->sigma_m, y = ((const outcome_t *)b)->sigma_m;
    return (x > y) - (x < y);
}

/* 95 % of 500 are 475; chance alone stays within 4 sigma of it, which is 4 %. */
static void expect_calibrated(void)
{
    qsort(outcomes, RUNS, sizeof outcomes[0], by_sigma);
    double all3 = 0.0, all6 = 0.0;
    for (int quarter = 0; quarter < 4; ++quarter) {
        double hold3 = 0.0, hold6 = 0.0;
        for (int i = quarter * QUARTER; i < (quarter + 1) * QUARTER; ++i) {
            hold3 += outcomes[i].chi2_3 < CHI2_3_95;
            hold6 += outcomes[i].chi2_6 < CHI2_6_95;
        }
        TEST_ASSERT_DOUBLE_WITHIN(0.04, 0.95, hold3 / QUARTER);
        TEST_ASSERT_DOUBLE_WITHIN(0.04, 0.95, hold6 / QUARTER);
        all3 += hold3 / RUNS;
        all6 += hold6 / RUNS;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.95, all3);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.95, all6);
}

/** How the measurements of a run differ from the truth. */
typedef struct disturbance {
    double noise;    /**< of the edges, in stated sigmas */
    double outliers; /**< part of the edges */
    double shift_px;
} disturbance_t;

static uint32_t measure(uint64_t *random, const opms_lens_t *lens, const opms_transform_t *truth,
                        disturbance_t by)
{
    const uint32_t count = truth_edges(lens, truth, 0, 32, 3, edges);
    for (uint32_t i = 0; i < count; ++i) {
        edges[i].sigma_px = truth_uniform(random, 0.02, 0.08);
        truth_move_edge(&edges[i],
                        by.shift_px + by.noise * edges[i].sigma_px * truth_gauss(random));
        if (truth_uniform(random, 0.0, 1.0) < by.outliers) {
            truth_move_edge(&edges[i], truth_uniform(random, -4.0, 4.0));
        }
    }
    return count;
}

static void run_camera(uint64_t seed, disturbance_t by)
{
    uint64_t random = seed;
    const opms_lens_t lens = truth_lens();
    const opms_transform_t mounting = truth_mounting();
    for (int i = 0; i < RUNS; ++i) {
        const double tilt = i % 2 ? 0.3368 : 0.0;
        const opms_transform_t detector = truth_detector(&random, 0.1);
        const opms_transform_t truth = truth_bar_camera(&detector, &mounting, tilt);
        const uint32_t count = measure(&random, &lens, &truth, by);
        opms_pose_result_t result;
        TEST_ASSERT_EQUAL(OPMS_OK, opms_pose_solve(&lens, edges, count, NULL, &result, &err));
        TEST_ASSERT_EQUAL(OPMS_POSE_FOUND, result.state);
        outcomes[i] = compare(&result.bar_camera, &truth);
    }
    expect_calibrated();
}

static void test_the_stated_covariance_is_true_for_the_stated_noise(void)
{
    const disturbance_t by = {1.0, 0.0, -0.1};
    run_camera(1, by);
}

static void test_the_stated_covariance_is_true_with_one_outlier_in_ten(void)
{
    const disturbance_t by = {1.0, 0.1, 0.2};
    run_camera(2, by);
}

static void test_the_stated_covariance_grows_with_noise_above_the_stated(void)
{
    const disturbance_t by = {2.0, 0.0, 0.0};
    run_camera(3, by);
}

/* A covariance of the eight intrinsics like a calibration's, with correlations; its factor l has
 * the given standard deviations. */
static void draw_intrinsics(uint64_t *random, const double l[8][8], opms_lens_t *lens)
{
    double g[8];
    for (int i = 0; i < 8; ++i) {
        g[i] = truth_gauss(random);
        for (int j = 0; j <= i; ++j) {
            *truth_intrinsic(lens, i) += l[i][j] * g[j];
        }
    }
}

static void make_factor(uint64_t *random, double l[8][8], double covariance[64])
{
    static const double sigma[8] = {0.3, 0.3, 0.3, 0.3, 1e-3, 1e-3, 1e-4, 1e-4};
    for (int i = 0; i < 8; ++i) {
        for (int j = 0; j < 8; ++j) {
            l[i][j] = j < i ? 0.4 * sigma[i] * truth_uniform(random, -1, 1) : i == j ? sigma[i] : 0;
        }
    }
    for (int i = 0; i < 64; ++i) {
        covariance[i] = 0.0;
        for (int k = 0; k < 8; ++k) {
            covariance[i] += l[i / 8][k] * l[i % 8][k];
        }
    }
}

static void test_the_detectors_covariance_is_true_with_intrinsics_and_mounting(void)
{
    uint64_t random = 4;
    const disturbance_t by = {1.0, 0.0, -0.1};
    double l[8][8];
    opms_camera_t camera = {0};
    camera.has_detector_camera = camera.has_covariance_intrinsics = 1;
    camera.has_covariance_detector_camera = 1;
    make_factor(&random, l, camera.covariance_intrinsics);
    for (int i = 0; i < 6; ++i) {
        camera.covariance_detector_camera[7 * i] = i < 3 ? 1e-6 : 0.25e-6; /* 1 mrad, 0.5 mm */
    }
    for (int i = 0; i < RUNS; ++i) {
        const double tilt = i % 2 ? 0.3368 : 0.0;
        const opms_lens_t lens = truth_lens();
        const opms_transform_t mounting = truth_mounting();
        const opms_transform_t detector = truth_detector(&random, 0.1);
        const opms_transform_t truth = truth_bar_camera(&detector, &mounting, tilt);
        const uint32_t count = measure(&random, &lens, &truth, by);
        double w[3], turn[9];
        camera.lens = lens; /* what the calibration believes, off by what it says */
        draw_intrinsics(&random, (const double(*)[8])l, &camera.lens);
        for (int k = 0; k < 3; ++k) {
            w[k] = 1e-3 * truth_gauss(&random);
            camera.detector_camera.t_m[k] = mounting.t_m[k] + 0.5e-3 * truth_gauss(&random);
        }
        truth_rotation(w, turn);
        truth_multiply(mounting.R, turn, camera.detector_camera.R);
        opms_pose_result_t result;
        opms_pose_t found;
        uint32_t includes;

        TEST_ASSERT_EQUAL(OPMS_OK,
                          opms_pose_solve(&camera.lens, edges, count, NULL, &result, &err));
        TEST_ASSERT_EQUAL(OPMS_POSE_FOUND, result.state);
        TEST_ASSERT_EQUAL(OPMS_OK,
                          opms_pose_detector(&result, &camera, tilt, &found, &includes, &err));

        TEST_ASSERT_EQUAL_UINT32(7, includes);
        outcomes[i] = compare(&found, &detector);
    }
    expect_calibrated();
}

/* A mounting found through the very lens that it is used with: what the lens does to the pose of a
 * picture it does to the mounting that is found from that picture. Here that is one of a bar, seen
 * from the middle of the working volume with the head level, so that the axes are the same.
 * `by_lens` is d(w, d)/d(intrinsics). */
static void mounting_by_lens(const opms_lens_t *lens, const opms_transform_t *mounting,
                             double by_lens[6][8])
{
    const opms_transform_t detector = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.35, 0.0, 0.05}};
    const opms_transform_t truth = truth_bar_camera(&detector, mounting, 0.0);
    opms_pose_result_t view;
    const uint32_t count = truth_edges(lens, &truth, 0, 32, 3, edges);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pose_solve(lens, edges, count, NULL, &view, &err));
    memcpy(by_lens, view.intrinsics_jacobian, sizeof view.intrinsics_jacobian);
}

/* covariance = own variances + by_lens C by_lens^T, shared = by_lens C */
static void mounting_covariances(const double by_lens[6][8], const double own[6],
                                 opms_camera_t *camera)
{
    double *const shared = camera->covariance_detector_camera_intrinsics;
    for (int i = 0; i < 48; ++i) {
        shared[i] = 0.0;
        for (int k = 0; k < 8; ++k) {
            shared[i] += by_lens[i / 8][k] * camera->covariance_intrinsics[8 * k + i % 8];
        }
    }
    for (int i = 0; i < 36; ++i) {
        camera->covariance_detector_camera[i] = i % 7 ? 0.0 : own[i / 6] * own[i / 6];
        for (int k = 0; k < 8; ++k) {
            camera->covariance_detector_camera[i] += shared[8 * (i / 6) + k] * by_lens[i % 6][k];
        }
    }
}

static outcome_t run_calibrated(uint64_t *random, const double l[8][8], opms_camera_t *camera,
                                int shared)
{
    static const double own[6] = {3e-4, 3e-4, 3e-4, 1e-4, 1e-4, 1e-4};
    const disturbance_t by = {1.0, 0.0, 0.0};
    const opms_lens_t lens = truth_lens();
    const opms_transform_t mounting = truth_mounting();
    const opms_transform_t detector = truth_detector(random, 0.1);
    const opms_transform_t truth = truth_bar_camera(&detector, &mounting, 0.0);
    double by_lens[6][8], error[6], turn[9];
    opms_pose_result_t result;
    opms_pose_t found;
    mounting_by_lens(&lens, &mounting, by_lens);
    mounting_covariances((const double(*)[8])by_lens, own, camera);
    const uint32_t count = measure(random, &lens, &truth, by);
    camera->lens = lens;
    draw_intrinsics(random, l, &camera->lens);
    for (int i = 0; i < 6; ++i) {
        error[i] = own[i] * truth_gauss(random);
        for (int k = 0; k < 8; ++k) {
            opms_lens_t right = lens;
            error[i] += by_lens[i][k] *
                        (*truth_intrinsic(&camera->lens, k) - *truth_intrinsic(&right, k));
        }
    }
    truth_rotation(error, turn);
    truth_multiply(mounting.R, turn, camera->detector_camera.R);
    for (int i = 0; i < 3; ++i) {
        camera->detector_camera.t_m[i] = mounting.t_m[i] + error[3 + i];
    }
    camera->has_covariance_detector_camera_intrinsics = (uint32_t)shared;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pose_solve(&camera->lens, edges, count, NULL, &result, &err));
    TEST_ASSERT_EQUAL(OPMS_POSE_FOUND, result.state);
    TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK,
                              opms_pose_detector(&result, camera, 0.0, &found, NULL, &err),
                              err.message);
    return compare(&found, &detector);
}

static double run_calibrated_camera(int shared)
{
    uint64_t random = 6;
    double l[8][8], sigma = 0.0;
    opms_camera_t camera = {0};
    camera.has_detector_camera = camera.has_covariance_intrinsics = 1;
    camera.has_covariance_detector_camera = 1;
    make_factor(&random, l, camera.covariance_intrinsics);
    for (int i = 0; i < RUNS; ++i) {
        outcomes[i] = run_calibrated(&random, (const double(*)[8])l, &camera, shared);
        sigma += outcomes[i].sigma_m / RUNS;
    }
    return sigma;
}

static void test_a_mounting_found_through_the_lens_takes_part_of_its_error_back(void)
{
    const double apart = run_calibrated_camera(0);
    double held = 0.0;
    for (int i = 0; i < RUNS; ++i) {
        held += outcomes[i].chi2_6 < CHI2_6_95;
    }
    const double together = run_calibrated_camera(1);
    printf("as if lens and mounting were independent: held %.3f, sigma %.3f mm instead of %.3f\n",
           held / RUNS, 1e3 * apart, 1e3 * together);
    TEST_ASSERT_TRUE(held / RUNS > 0.98); /* too large */
    TEST_ASSERT_TRUE(together < 0.75 * apart);
    expect_calibrated();
}

static void test_the_jacobian_by_the_intrinsics_agrees_with_a_new_solution(void)
{
    uint64_t random = 5;
    const opms_transform_t mounting = truth_mounting();
    const disturbance_t by = {0.3, 0.0, 0.1};
    for (int i = 0; i < 20; ++i) {
        const opms_lens_t lens = truth_lens();
        const opms_transform_t detector = truth_detector(&random, 0.1);
        const opms_transform_t truth = truth_bar_camera(&detector, &mounting, 0.0);
        const uint32_t count = measure(&random, &lens, &truth, by);
        opms_pose_result_t here, low, high;
        TEST_ASSERT_EQUAL(OPMS_OK, opms_pose_solve(&lens, edges, count, NULL, &here, &err));
        for (int k = 0; k < 8; ++k) {
            const double step = k < 4 ? 0.1 : k < 6 ? 1e-4 : 3e-5;
            opms_lens_t less = lens, more = lens;
            double w[3];
            *truth_intrinsic(&less, k) -= step;
            *truth_intrinsic(&more, k) += step;
            TEST_ASSERT_EQUAL(OPMS_OK, opms_pose_solve(&less, edges, count, NULL, &low, &err));
            TEST_ASSERT_EQUAL(OPMS_OK, opms_pose_solve(&more, edges, count, NULL, &high, &err));
            truth_small_rotation(low.bar_camera.transform.R, high.bar_camera.transform.R, w);
            for (int a = 0; a < 6; ++a) {
                const double moved = a < 3 ? w[a]
                                           : high.bar_camera.transform.t_m[a - 3] -
                                                 low.bar_camera.transform.t_m[a - 3];
                const double sigma = sqrt(here.bar_camera.covariance[7 * a]);
                /* noise bends the way a little; what is hardly moved is measured by its sigma */
                TEST_ASSERT_DOUBLE_WITHIN(0.05 * fabs(moved) + 0.01 * sigma, moved,
                                          2 * step * here.intrinsics_jacobian[8 * a + k]);
            }
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_stated_covariance_is_true_for_the_stated_noise);
    RUN_TEST(test_the_stated_covariance_is_true_with_one_outlier_in_ten);
    RUN_TEST(test_the_stated_covariance_grows_with_noise_above_the_stated);
    RUN_TEST(test_the_detectors_covariance_is_true_with_intrinsics_and_mounting);
    RUN_TEST(test_a_mounting_found_through_the_lens_takes_part_of_its_error_back);
    RUN_TEST(test_the_jacobian_by_the_intrinsics_agrees_with_a_new_solution);
    return UNITY_END();
}
