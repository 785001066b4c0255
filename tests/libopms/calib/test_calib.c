/* SPDX-License-Identifier: Apache-2.0 */
/* Calibration on points whose truth another projection made. */
#include "calib_scene.h"
#include "../counting_allocator.h"

static scene_t scene;
static opms_error_t err;
static opms_calib_result_t result;

void setUp(void)
{
    memset(&err, 0, sizeof err);
    memset(&result, 0, sizeof result);
}

void tearDown(void)
{
}

static void take(scene_plan_t plan, uint64_t seed)
{
    scene_take(&scene, &plan, &seed);
}

static void solve(double cockle_sigma_m)
{
    opms_calibrator_t *calibrator = scene_calibrator(&scene, cockle_sigma_m);
    TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK, opms_calibrator_solve(calibrator, &result, &err),
                              err.message);
    opms_calibrator_destroy(calibrator);
}

static void exact_points_give_the_lens_to_rounding(void)
{
    for (uint64_t seed = 1; seed <= 8; ++seed) {
        scene_plan_t plan = scene_usual_plan();
        double off[8];
        plan.sigma_px = 1e-7;
        take(plan, seed);
        solve(0.0);
        scene_lens_error(&scene, &result.lens, off);
        for (int i = 0; i < 4; ++i)
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.0, off[i]);
        for (int i = 4; i < 8; ++i)
            TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0.0, off[i]);
    }
}

static void any_camera_is_solved_without_a_guess(void)
{
    for (uint64_t seed = 100; seed < 130; ++seed) {
        double off[8];
        take(scene_usual_plan(), seed);
        solve(0.0);
        scene_lens_error(&scene, &result.lens, off);
        TEST_ASSERT_TRUE(truth_chi2(result.covariance, 8, off, 8) < 40.0);
        TEST_ASSERT_DOUBLE_WITHIN(0.15, 1.0, result.chi2_dof);
        TEST_ASSERT_DOUBLE_WITHIN(0.003, 0.0283, result.residual_rms_px);
    }
}

static void a_wrong_point_in_twenty_is_found_and_does_no_harm(void)
{
    uint64_t random = 9;
    double off[8];
    uint32_t wrong = 0;
    take(scene_usual_plan(), 3);
    for (uint32_t k = 0; k < scene.picture_count; ++k)
        for (uint32_t i = k; i < scene.point_count[k]; i += 20, ++wrong)
            scene.points[k][i].px[truth_random(&random) % 2] += truth_uniform(&random, 2.0, 40.0);
    solve(0.0);
    scene_lens_error(&scene, &result.lens, off);
    TEST_ASSERT_TRUE(truth_chi2(result.covariance, 8, off, 8) < 30.0);
    TEST_ASSERT_UINT32_WITHIN(5, wrong, result.outliers);
}

static void a_picture_of_another_camera_is_left_out(void)
{
    static scene_t other;
    uint64_t random = 77;
    const scene_plan_t plan = scene_usual_plan();
    opms_calib_picture_t picture;
    take(plan, 4);
    do {
        scene_take(&other, &plan, &random);
    } while (other.lens.width_px != scene.lens.width_px);
    memcpy(scene.points[5], other.points[5], sizeof scene.points[5]);
    scene.point_count[5] = other.point_count[5];
    opms_calibrator_t *calibrator = scene_calibrator(&scene, 0.0);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_solve(calibrator, &result, &err));
    TEST_ASSERT_EQUAL_UINT32(11, result.pictures_used);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_picture(calibrator, 5, &picture, &err));
    TEST_ASSERT_EQUAL(OPMS_CALIB_NO_FIT, picture.use);
    opms_calibrator_destroy(calibrator);
}

static void parallel_views_are_told(void)
{
    scene_plan_t plan = scene_usual_plan();
    plan.tilt_rad = 0.01;
    take(plan, 6);
    opms_calibrator_t *calibrator = scene_calibrator(&scene, 0.0);
    const opms_status_t status = opms_calibrator_solve(calibrator, &result, &err);
    if (status == OPMS_OK)
        TEST_ASSERT_TRUE((result.warnings & OPMS_CALIB_ALL_PARALLEL) != 0);
    else
        TEST_ASSERT_EQUAL(OPMS_ERR_DOMAIN, status);
    opms_calibrator_destroy(calibrator);
}

/* Cameras that lean by one angle, each to another side of the picture, or all to the same one while
 * the camera is turned about the target's normal. */
static void lean(uint32_t count, double lean_rad, double side_step_rad, double turn_step_rad)
{
    const double down[3] = {3.141592653589793, 0.0, 0.0};
    uint64_t random = 21;
    const scene_plan_t plan = scene_usual_plan();
    const opms_lens_t lens = {1024,  768,    585.0, 585.0,  517.3,
                              379.6, -0.118, 0.031, 0.0011, -0.0007};
    scene.lens = lens;
    scene.picture_count = count;
    for (uint32_t k = 0; k < count; ++k) {
        const double side = k * side_step_rad;
        const double turn[3] = {0.0, 0.0, k * turn_step_rad};
        const double leaning[3] = {lean_rad * cos(side), lean_rad * sin(side), 0.0};
        double a[9], b[9], c[9];
        opms_transform_t *pose = &scene.target_camera[k];
        truth_rotation(down, a);
        truth_rotation(turn, b);
        truth_multiply(a, b, c);
        truth_rotation(leaning, a);
        truth_multiply(c, a, pose->R);
        for (int i = 0; i < 3; ++i)
            pose->t_m[i] = -(0.4 + 0.02 * k) * pose->R[3 * i + 2];
        scene_look(&scene, k, &plan, &random);
    }
}

static void expect_parallel(int is_parallel)
{
    double off[8];
    solve(0.0);
    TEST_ASSERT_EQUAL(is_parallel, (result.warnings & OPMS_CALIB_ALL_PARALLEL) != 0);
    scene_lens_error(&scene, &result.lens, off);
    if (!is_parallel)
        TEST_ASSERT_TRUE(truth_chi2(result.covariance, 8, off, 8) < 30.0);
}

static void three_pictures_that_lean_to_three_sides_are_not_parallel(void)
{
    lean(3, 0.26, 2.0944, 0.0);
    expect_parallel(0);
}

static void three_pictures_that_lean_the_same_way_are_parallel_however_they_are_turned(void)
{
    lean(3, 0.1, 0.0, 0.0);
    expect_parallel(1);
    lean(3, 0.1, 0.0, 2.0944);
    expect_parallel(1);
}

static void a_focal_length_that_is_fixed_all_the_same_is_no_reason_to_warn(void)
{
    lean(12, 0.52, 0.0, 0.52);
    expect_parallel(0);
    TEST_ASSERT_TRUE(sqrt(result.covariance[0]) < 3e-4 * result.lens.fx_px);
}

/* Of a dozen pictures none is worth the whole lens, and none nothing. */
static void expect_usual_gains(double cockle_sigma_m)
{
    opms_calibrator_t *calibrator = scene_calibrator(&scene, cockle_sigma_m);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_solve(calibrator, &result, &err));
    for (uint32_t k = 0; k < scene.picture_count; ++k) {
        opms_calib_picture_t picture;
        TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_picture(calibrator, k, &picture, &err));
        TEST_ASSERT_TRUE(picture.gain > 0.0 && picture.gain < 5.0);
    }
    opms_calibrator_destroy(calibrator);
}

static void the_cockle_of_the_target_is_estimated(void)
{
    scene_plan_t plan = scene_usual_plan();
    double off[8];
    plan.cockle_m = 0.002;
    take(plan, 7);
    solve(0.003);
    scene_lens_error(&scene, &result.lens, off);
    TEST_ASSERT_TRUE(truth_chi2(result.covariance, 8, off, 8) < 30.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 1.0, result.chi2_dof);
    expect_usual_gains(0.003);
    solve(0.0); /* a plane does not fit: the residuals say so */
    TEST_ASSERT_TRUE(result.chi2_dof > 2.0);
}

static void the_next_solution_starts_from_the_last(void)
{
    take(scene_usual_plan(), 8);
    const uint32_t all = scene.picture_count;
    opms_calib_result_t again;
    scene.picture_count = all - 1;
    opms_calibrator_t *calibrator = scene_calibrator(&scene, 0.0);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_solve(calibrator, &result, &err));
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_add(calibrator, scene.points[all - 1],
                                                   scene.point_count[all - 1], NULL, &err));
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_solve(calibrator, &again, &err));
    TEST_ASSERT_EQUAL_UINT32(all, again.pictures_used);
    for (int i = 0; i < 8; ++i)
        TEST_ASSERT_TRUE(again.covariance[9 * i] < result.covariance[9 * i] * 1.1);
    opms_calibrator_destroy(calibrator);
}

static void a_calibration_that_grows_is_as_good_as_one_made_at_once(void)
{
    opms_calib_options_t options;
    opms_calibrator_t *growing;
    scene_plan_t plan = scene_usual_plan();
    plan.pictures = 16;
    take(plan, 41);
    opms_calib_options_init(&options);
    options.width_px = scene.lens.width_px;
    options.height_px = scene.lens.height_px;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_create(&options, &growing, &err));
    for (uint32_t k = 0; k < scene.picture_count; ++k) {
        TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_add(growing, scene.points[k],
                                                       scene.point_count[k], NULL, &err));
        if (k >= 4) {
            TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_solve(growing, &result, &err));
        }
    }
    /* At once, and again from there until nothing moves any more. */
    opms_calib_result_t whole = {0};
    opms_calibrator_t *calibrator = scene_calibrator(&scene, 0.0);
    for (int i = 0; i < 4; ++i) {
        TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_solve(calibrator, &whole, &err));
    }
    for (int i = 0; i < 8; ++i) {
        const double sigma = sqrt(whole.covariance[9 * i]);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * sigma, *truth_intrinsic(&whole.lens, i),
                                  *truth_intrinsic(&result.lens, i));
    }
    opms_calibrator_destroy(calibrator);
    opms_calibrator_destroy(growing);
}

static void the_chosen_dozen_is_nearly_as_good_as_all(void)
{
    scene_plan_t plan = scene_usual_plan();
    uint32_t chosen[12], count = 0;
    opms_calib_result_t dozen;
    plan.pictures = 36;
    take(plan, 10);
    opms_calibrator_t *calibrator = scene_calibrator(&scene, 0.0);
    TEST_ASSERT_EQUAL(OPMS_ERR_DOMAIN,
                      opms_calibrator_choose(calibrator, 12, chosen, &count, &err));
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_solve(calibrator, &result, &err));
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_choose(calibrator, 12, chosen, &count, &err));
    TEST_ASSERT_EQUAL_UINT32(12, count);
    for (uint32_t k = 0; k < 36; ++k)
        TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_use(calibrator, k, 0, &err));
    for (uint32_t i = 0; i < 12; ++i)
        TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_use(calibrator, chosen[i], 1, &err));
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_solve(calibrator, &dozen, &err));
    TEST_ASSERT_EQUAL_UINT32(12, dozen.pictures_used);
    for (int i = 0; i < 8; ++i) /* a dozen at random would have three times the variance */
        TEST_ASSERT_TRUE(dozen.covariance[9 * i] < 2.6 * result.covariance[9 * i]);
    opms_calibrator_destroy(calibrator);
}

static void bad_calls_say_what_is_wrong(void)
{
    opms_calib_options_t options;
    opms_calibrator_t *calibrator = NULL;
    opms_calib_options_init(&options);
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_calibrator_create(&options, &calibrator, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "16384"));
    options.width_px = 640;
    options.height_px = 480;
    options.pictures_max = 3;
    options.points_max = 100;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_create(&options, &calibrator, &err));
    opms_calib_point_t points[101];
    for (int i = 0; i < 101; ++i) {
        const opms_calib_point_t point = {{0.01 * (i % 10), 0.01 * (i / 10)},
                                          {100.0 + 20 * (i % 10), 100.0 + 20 * (i / 10)},
                                          0.1};
        points[i] = point;
    }
    TEST_ASSERT_EQUAL(OPMS_ERR_DOMAIN, opms_calibrator_add(calibrator, points, 3, NULL, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_DOMAIN, opms_calibrator_add(calibrator, points, 10, NULL, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_CAPACITY, opms_calibrator_add(calibrator, points, 101, NULL, &err));
    points[7].sigma_px = 0.0;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_calibrator_add(calibrator, points, 100, NULL, &err));
    TEST_ASSERT_EQUAL(7, err.index);
    points[7].sigma_px = 0.1;
    points[8].px[1] = NAN;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_calibrator_add(calibrator, points, 100, NULL, &err));
    TEST_ASSERT_EQUAL(8, err.index);
    points[8].px[1] = points[7].px[1];
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_add(calibrator, points, 100, NULL, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_DOMAIN, opms_calibrator_solve(calibrator, &result, &err));
    opms_calib_picture_t picture; /* has no place in a solution that there is not */
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_picture(calibrator, 0, &picture, &err));
    TEST_ASSERT_EQUAL(OPMS_CALIB_NOT_SOLVED, picture.use);
    opms_calibrator_destroy(calibrator);
    opms_calibrator_destroy(NULL);
}

static void the_same_picture_twenty_times_is_no_calibration(void)
{
    take(scene_usual_plan(), 11);
    for (uint32_t k = 1; k < scene.picture_count; ++k) {
        memcpy(scene.points[k], scene.points[0], sizeof scene.points[0]);
        scene.point_count[k] = scene.point_count[0];
    }
    opms_calibrator_t *calibrator = scene_calibrator(&scene, 0.0);
    const opms_status_t status = opms_calibrator_solve(calibrator, &result, &err);
    if (status == OPMS_OK)
        TEST_ASSERT_TRUE((result.warnings & OPMS_CALIB_ALL_PARALLEL) != 0);
    opms_calibrator_destroy(calibrator);
}

static void only_create_allocates(void)
{
    count_t count = {0, 0, 0};
    opms_calib_options_t options;
    opms_calibrator_t *calibrator = NULL;
    take(scene_usual_plan(), 12);
    opms_calib_options_init(&options);
    options.width_px = scene.lens.width_px;
    options.height_px = scene.lens.height_px;
    options.allocator.alloc = counting_alloc;
    options.allocator.free = counting_free;
    options.allocator.user = &count;
    count.fail_at = 1;
    TEST_ASSERT_EQUAL(OPMS_ERR_MEMORY, opms_calibrator_create(&options, &calibrator, &err));
    count.fail_at = 0;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_create(&options, &calibrator, &err));
    const int calls = count.calls;
    for (uint32_t k = 0; k < scene.picture_count; ++k)
        TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_add(calibrator, scene.points[k],
                                                       scene.point_count[k], NULL, &err));
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_solve(calibrator, &result, &err));
    TEST_ASSERT_EQUAL(calls, count.calls);
    opms_calibrator_destroy(calibrator);
    TEST_ASSERT_EQUAL(0, count.live);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(exact_points_give_the_lens_to_rounding);
    RUN_TEST(any_camera_is_solved_without_a_guess);
    RUN_TEST(a_wrong_point_in_twenty_is_found_and_does_no_harm);
    RUN_TEST(a_picture_of_another_camera_is_left_out);
    RUN_TEST(parallel_views_are_told);
    RUN_TEST(three_pictures_that_lean_to_three_sides_are_not_parallel);
    RUN_TEST(three_pictures_that_lean_the_same_way_are_parallel_however_they_are_turned);
    RUN_TEST(a_focal_length_that_is_fixed_all_the_same_is_no_reason_to_warn);
    RUN_TEST(the_cockle_of_the_target_is_estimated);
    RUN_TEST(the_next_solution_starts_from_the_last);
    RUN_TEST(a_calibration_that_grows_is_as_good_as_one_made_at_once);
    RUN_TEST(the_chosen_dozen_is_nearly_as_good_as_all);
    RUN_TEST(bad_calls_say_what_is_wrong);
    RUN_TEST(the_same_picture_twenty_times_is_no_calibration);
    RUN_TEST(only_create_allocates);
    return UNITY_END();
}
