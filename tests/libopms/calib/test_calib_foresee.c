/* SPDX-License-Identifier: Apache-2.0 */
/* What a further picture is said to do, and what it does once it is taken. */
#include "calib_scene.h"

#define SCENES 8
#define FEW 6 /* pictures before the further one */
#define CANDIDATES 6
#define DRAWS 8

static scene_t scene, next;
static opms_error_t err;
static opms_calib_result_t before, after;
static opms_calib_foresight_t foresight;
static double target_m[SCENE_POINTS][2];
static const opms_footprint_t footprint = {0, 0.35, 0.0, 0.0, 1e-5, 1e-6};

void setUp(void)
{
    memset(&err, 0, sizeof err);
}

void tearDown(void)
{
}

/* All nodes that scene_look() knows, seen or not. */
static opms_calib_view_t view_from(const opms_transform_t *target_camera, int step)
{
    opms_calib_view_t view;
    memset(&view, 0, sizeof view);
    for (int i = -16; i <= 16; i += step)
        for (int j = -22; j <= 22; j += step, ++view.count) {
            target_m[view.count][0] = 0.025 * i;
            target_m[view.count][1] = 0.025 * j;
        }
    view.target_m = target_m[0];
    view.target_camera = *target_camera;
    view.footprints = &footprint;
    view.footprint_count = 1;
    return view;
}

static void add_and_solve(opms_calibrator_t *calibrator, uint32_t k)
{
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_add(calibrator, next.points[k],
                                                   next.point_count[k], NULL, &err));
    TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK, opms_calibrator_solve(calibrator, &after, &err),
                              err.message);
}

/* The scatter of the residuals is measured anew with each picture; it is no part of what is
 * foreseen. */
static double scatter(void)
{
    return after.chi2_dof / before.chi2_dof;
}

static opms_calibrator_t *few_pictures(uint64_t seed, const scene_plan_t *plan)
{
    scene_take(&scene, plan, &seed);
    next = scene;
    scene.picture_count = FEW;
    opms_calibrator_t *calibrator = scene_calibrator(&scene, 0.0);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_solve(calibrator, &before, &err));
    return calibrator;
}

static void a_picture_that_is_taken_does_what_was_foreseen(void)
{
    scene_plan_t plan = scene_usual_plan();
    double ratio = 0.0, mounting = 0.0, shrunk = 0.0;
    plan.pictures = FEW + 1;
    for (uint64_t seed = 1; seed <= SCENES; ++seed) {
        opms_camera_t camera;
        memset(&camera, 0, sizeof camera);
        opms_calibrator_t *calibrator = few_pictures(seed, &plan);
        const opms_calib_view_t view = view_from(&next.target_camera[FEW], plan.step);
        TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK,
                                  opms_calibrator_foresee(calibrator, &view, &foresight, &err),
                                  err.message);
        TEST_ASSERT_UINT32_WITHIN(foresight.points / 10, foresight.points,
                                  next.point_count[FEW]);
        add_and_solve(calibrator, FEW);
        TEST_ASSERT_EQUAL(OPMS_OK,
                          opms_calibrator_camera(calibrator, &footprint, 1, &camera, &err));
        for (int i = 0; i < 8; ++i) {
            const double is = after.covariance[9 * i] / scatter();
            ratio += is / foresight.camera.covariance_intrinsics[9 * i] / (8 * SCENES);
            shrunk += is / before.covariance[9 * i] / (8 * SCENES);
        }
        for (int i = 3; i < 6; ++i)
            mounting += camera.covariance_detector_camera[7 * i] / scatter() /
                        foresight.camera.covariance_detector_camera[7 * i] / (3 * SCENES);
        opms_calibrator_destroy(calibrator);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.12, 1.0, ratio);
    TEST_ASSERT_DOUBLE_WITHIN(0.2, 1.0, mounting);
    TEST_ASSERT_TRUE(shrunk < 0.85); /* so that no change would not do */
}

/* Variances relative to those before, summed over the lens's parameters. */
static double what_is_left(const double *covariance)
{
    double sum = 0.0;
    for (int i = 0; i < 8; ++i)
        sum += covariance[9 * i] / before.covariance[9 * i];
    return sum;
}

/* What is left with one candidate, mean over draws of the noise. */
static double left_with(uint32_t candidate, const scene_plan_t *plan, double *gain)
{
    double left = 0.0;
    *gain = 0.0;
    for (uint64_t draw = 1; draw <= DRAWS; ++draw) {
        uint64_t random = draw;
        for (uint32_t k = 0; k < FEW + CANDIDATES; ++k)
            scene_look(&scene, k, plan, &random);
        next = scene;
        scene.picture_count = FEW;
        opms_calibrator_t *calibrator = scene_calibrator(&scene, 0.0);
        TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_solve(calibrator, &before, &err));
        const opms_calib_view_t view = view_from(&next.target_camera[candidate], plan->step);
        TEST_ASSERT_EQUAL(OPMS_OK,
                          opms_calibrator_foresee(calibrator, &view, &foresight, &err));
        add_and_solve(calibrator, candidate);
        *gain += foresight.gain / DRAWS;
        left += what_is_left(after.covariance) / scatter() / DRAWS;
        opms_calibrator_destroy(calibrator);
    }
    return left;
}

/* The stated covariances also grow with how alike neighbouring residuals are, which chance decides
 * anew with each picture: so the candidates are compared with each other. */
static void the_picture_that_is_advised_is_the_best_of_all(void)
{
    scene_plan_t plan = scene_usual_plan();
    double left[CANDIDATES], gain[CANDIDATES], mean_left = 0.0, mean_foreseen = 0.0;
    int advised = 0, best = 0;
    uint64_t seed = 31;
    plan.pictures = FEW + CANDIDATES;
    scene_take(&scene, &plan, &seed);
    for (int k = 0; k < CANDIDATES; ++k) {
        left[k] = left_with(FEW + (uint32_t)k, &plan, &gain[k]);
        mean_left += left[k] / CANDIDATES;
        mean_foreseen += (8.0 - gain[k]) / CANDIDATES;
        advised = gain[k] > gain[advised] ? k : advised;
        best = left[k] < left[best] ? k : best;
    }
    for (int k = 0; k < CANDIDATES; ++k)
        TEST_ASSERT_DOUBLE_WITHIN(0.15 * left[k] / mean_left, left[k] / mean_left,
                                  (8.0 - gain[k]) / mean_foreseen);
    TEST_ASSERT_DOUBLE_WITHIN(0.05 * left[best], left[best], left[advised]);
    TEST_ASSERT_TRUE(gain[advised] > 0.5);
}

static void with_a_cockle_to_be_estimated_a_picture_is_foreseen_too(void)
{
    scene_plan_t plan = scene_usual_plan();
    uint64_t seed = 5;
    double ratio = 0.0;
    plan.pictures = FEW + 1;
    plan.cockle_m = 0.002;
    scene_take(&scene, &plan, &seed);
    next = scene;
    scene.picture_count = FEW;
    opms_calibrator_t *calibrator = scene_calibrator(&scene, 0.003);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_solve(calibrator, &before, &err));
    const opms_calib_view_t view = view_from(&next.target_camera[FEW], plan.step);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_foresee(calibrator, &view, &foresight, &err));
    add_and_solve(calibrator, FEW);
    for (int i = 0; i < 8; ++i)
        ratio += after.covariance[9 * i] / scatter() /
                 foresight.camera.covariance_intrinsics[9 * i] / 8;
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 1.0, ratio);
    opms_calibrator_destroy(calibrator);
}

static void a_view_without_the_target_changes_nothing(void)
{
    const scene_plan_t plan = scene_usual_plan();
    opms_camera_t camera;
    memset(&camera, 0, sizeof camera);
    opms_calibrator_t *calibrator = few_pictures(3, &plan);
    opms_transform_t away = next.target_camera[0];
    away.t_m[0] += 20.0;
    opms_calib_view_t view = view_from(&away, 2);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_foresee(calibrator, &view, &foresight, &err));
    TEST_ASSERT_EQUAL_UINT32(0, foresight.points);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, foresight.gain);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_camera(calibrator, &footprint, 1, &camera, &err));
    TEST_ASSERT_EQUAL_MEMORY(&camera, &foresight.camera, sizeof camera);
    view.footprint_count = 0;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_foresee(calibrator, &view, &foresight, &err));
    TEST_ASSERT_EQUAL_UINT32(0, foresight.camera.has_detector_camera);
    TEST_ASSERT_EQUAL_MEMORY(before.covariance, foresight.camera.covariance_intrinsics,
                             sizeof before.covariance);
    opms_calibrator_destroy(calibrator);
}

static void foreseeing_leaves_the_solution_as_it_is(void)
{
    const scene_plan_t plan = scene_usual_plan();
    opms_calibrator_t *calibrator = few_pictures(4, &plan);
    const opms_calib_view_t view = view_from(&next.target_camera[FEW], 2);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_foresee(calibrator, &view, &foresight, &err));
    opms_camera_t camera;
    memset(&camera, 0, sizeof camera);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_camera(calibrator, &footprint, 1, &camera, &err));
    TEST_ASSERT_EQUAL_MEMORY(before.covariance, camera.covariance_intrinsics,
                             sizeof before.covariance);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_solve(calibrator, &after, &err));
    for (int i = 0; i < 8; ++i)
        TEST_ASSERT_DOUBLE_WITHIN(0.01, 1.0, after.covariance[9 * i] / before.covariance[9 * i]);
    opms_calibrator_destroy(calibrator);
}

static void assert_refused(const opms_calibrator_t *calibrator, const opms_calib_view_t *view,
                           opms_status_t status, const char *word)
{
    TEST_ASSERT_EQUAL(status, opms_calibrator_foresee(calibrator, view, &foresight, &err));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(err.message, word), err.message);
}

static void bad_calls_say_what_is_wrong(void)
{
    const scene_plan_t plan = scene_usual_plan();
    uint64_t seed = 6;
    scene_take(&scene, &plan, &seed);
    opms_calibrator_t *calibrator = scene_calibrator(&scene, 0.0);
    const opms_calib_view_t good = view_from(&scene.target_camera[0], 2);
    opms_calib_view_t bad = good;
    assert_refused(NULL, &good, OPMS_ERR_ARG, "NULL");
    assert_refused(calibrator, &good, OPMS_ERR_DOMAIN, "no solution");
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_solve(calibrator, &before, &err));
    bad.target_m = NULL;
    assert_refused(calibrator, &bad, OPMS_ERR_ARG, "no points");
    bad = good;
    bad.footprints = NULL;
    assert_refused(calibrator, &bad, OPMS_ERR_ARG, "no footprints");
    bad = good;
    bad.sigma_px = -1.0;
    assert_refused(calibrator, &bad, OPMS_ERR_ARG, "sigma_px");
    bad = good;
    bad.target_camera.R[0] += 0.1;
    assert_refused(calibrator, &bad, OPMS_ERR_ARG, "no pose");
    target_m[3][1] = NAN;
    assert_refused(calibrator, &good, OPMS_ERR_ARG, "point 3");
    opms_calibrator_destroy(calibrator);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_picture_that_is_taken_does_what_was_foreseen);
    RUN_TEST(the_picture_that_is_advised_is_the_best_of_all);
    RUN_TEST(with_a_cockle_to_be_estimated_a_picture_is_foreseen_too);
    RUN_TEST(a_view_without_the_target_changes_nothing);
    RUN_TEST(foreseeing_leaves_the_solution_as_it_is);
    RUN_TEST(bad_calls_say_what_is_wrong);
    return UNITY_END();
}
