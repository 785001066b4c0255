/* SPDX-License-Identifier: Apache-2.0 */
/* Are the stated uncertainties of a calibration true? */
#include "calib_scene.h"

#define RUNS 200
#define CHI2_6_95 12.592
#define CHI2_8_95 15.507
#define CHI2_14_95 23.685

static scene_t scene;
static double lens_chi2[RUNS], pose_chi2[RUNS], joint_chi2[RUNS], mounting_chi2[RUNS];

void setUp(void)
{
}

void tearDown(void)
{
}

static double held(const double *chi2, double limit)
{
    int count = 0;
    for (int i = 0; i < RUNS; ++i)
        count += chi2[i] < limit;
    return (double)count / RUNS;
}

static void pose_error(const opms_transform_t *found, const opms_transform_t *truth, double x[6])
{
    truth_small_rotation(found->R, truth->R, x);
    for (int i = 0; i < 3; ++i)
        x[3 + i] = truth->t_m[i] - found->t_m[i];
}

/* chi2 of pose and lens together: their covariance is one matrix. */
static double joint(const opms_calib_picture_t *picture, const opms_calib_result_t *result,
                    const double pose[6], const double lens[8])
{
    static double c[14 * 14];
    double x[14];
    for (int i = 0; i < 14; ++i) {
        x[i] = i < 6 ? pose[i] : lens[i - 6];
        for (int j = 0; j < 14; ++j) {
            c[14 * i + j] = i < 6 && j < 6   ? picture->target_camera.covariance[6 * i + j]
                            : i >= 6 && j >= 6 ? result->covariance[8 * (i - 6) + j - 6]
                            : i < 6            ? picture->covariance_with_lens[8 * i + j - 6]
                                               : picture->covariance_with_lens[8 * j + i - 6];
        }
    }
    return truth_chi2(c, 14, x, 14);
}

/* The head stood at x, y, turned by yaw: the mounting that this picture truly has. */
static opms_transform_t true_mounting(const opms_transform_t *target_camera,
                                      const opms_footprint_t *footprint)
{
    const double c = cos(footprint->yaw_rad), s = sin(footprint->yaw_rad);
    const double turn[9] = {c, s, 0, -s, c, 0, 0, 0, 1};
    const double off[3] = {target_camera->t_m[0] - footprint->x_m,
                           target_camera->t_m[1] - footprint->y_m, target_camera->t_m[2]};
    opms_transform_t mounting;
    truth_multiply(turn, target_camera->R, mounting.R);
    for (int i = 0; i < 3; ++i)
        mounting.t_m[i] =
            turn[3 * i] * off[0] + turn[3 * i + 1] * off[1] + turn[3 * i + 2] * off[2];
    return mounting;
}

static void run(int i, uint64_t *random)
{
    scene_plan_t plan = scene_usual_plan();
    opms_calib_result_t result;
    opms_calib_picture_t picture;
    opms_camera_t camera;
    double lens[8], pose[6];
    plan.step = 3;
    scene_take(&scene, &plan, random);
    opms_calibrator_t *calibrator = scene_calibrator(&scene, 0.0);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_solve(calibrator, &result, NULL));
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_picture(calibrator, 0, &picture, NULL));
    scene_lens_error(&scene, &result.lens, lens);
    pose_error(&picture.target_camera.transform, &scene.target_camera[0], pose);
    lens_chi2[i] = truth_chi2(result.covariance, 8, lens, 8);
    pose_chi2[i] = truth_chi2(picture.target_camera.covariance, 6, pose, 6);
    joint_chi2[i] = joint(&picture, &result, pose, lens);
    /* Placed with an error: a millimetre, and a fifth of a degree. */
    opms_footprint_t footprint = {0, 0.35, -0.02, 0.1, 0.001, 0.0035};
    const opms_transform_t mounting = true_mounting(&scene.target_camera[0], &footprint);
    footprint.x_m += footprint.sigma_m * truth_gauss(random);
    footprint.y_m += footprint.sigma_m * truth_gauss(random);
    footprint.yaw_rad += footprint.sigma_rad * truth_gauss(random);
    memset(&camera, 0, sizeof camera);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_camera(calibrator, &footprint, 1, &camera, NULL));
    pose_error(&camera.detector_camera, &mounting, pose);
    mounting_chi2[i] = truth_chi2(camera.covariance_detector_camera, 6, pose, 6);
    opms_calibrator_destroy(calibrator);
}

/* 95 % of 200 are 190; chance alone stays within 3 sigma of it, which is 4.6 %. */
static void stated_regions_hold_as_often_as_they_say(void)
{
    uint64_t random = 2026;
    for (int i = 0; i < RUNS; ++i)
        run(i, &random);
    TEST_ASSERT_DOUBLE_WITHIN(0.046, 0.95, held(lens_chi2, CHI2_8_95));
    TEST_ASSERT_DOUBLE_WITHIN(0.046, 0.95, held(pose_chi2, CHI2_6_95));
    TEST_ASSERT_DOUBLE_WITHIN(0.046, 0.95, held(joint_chi2, CHI2_14_95));
    TEST_ASSERT_DOUBLE_WITHIN(0.046, 0.95, held(mounting_chi2, CHI2_6_95));
    printf("held: lens %.3f, pose %.3f, both %.3f, mounting %.3f\n", held(lens_chi2, CHI2_8_95),
           held(pose_chi2, CHI2_6_95), held(joint_chi2, CHI2_14_95),
           held(mounting_chi2, CHI2_6_95));
}

/* Two placings, each off by its own error, are better than one; but the lens stays the same. */
static void a_second_footprint_halves_the_variance_of_the_placing(void)
{
    uint64_t random = 5;
    const scene_plan_t plan = scene_usual_plan();
    opms_calib_result_t result;
    opms_camera_t one = {0}, two = {0};
    scene_take(&scene, &plan, &random);
    opms_calibrator_t *calibrator = scene_calibrator(&scene, 0.0);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_solve(calibrator, &result, NULL));
    opms_footprint_t footprints[2] = {{0, 0.0, 0.0, 0.0, 0.01, 0.0}, {0, 0.0, 0.0, 0.0, 0.01, 0.0}};
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_camera(calibrator, footprints, 1, &one, NULL));
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_camera(calibrator, footprints, 2, &two, NULL));
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.5,
                              two.covariance_detector_camera[21] /
                                  one.covariance_detector_camera[21]);
    footprints[1].picture = 99;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG,
                      opms_calibrator_camera(calibrator, footprints, 2, &two, NULL));
    opms_calibrator_destroy(calibrator);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(stated_regions_hold_as_often_as_they_say);
    RUN_TEST(a_second_footprint_halves_the_variance_of_the_placing);
    return UNITY_END();
}
