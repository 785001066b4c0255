/* SPDX-License-Identifier: Apache-2.0 */
/* Does a check tell a camera that was left alone from one that was touched? Calibrations and new
 * pictures come from the test's own projection. */
#include "calib_scene.h"

#define RUNS 120

static scene_t scene, later;
static opms_error_t err;

void setUp(void)
{
    memset(&err, 0, sizeof err);
}

void tearDown(void)
{
}

/* HOPE's camera or one like it: what the figures of the touched lens are about. */
static opms_lens_t hope_lens(uint64_t *random)
{
    const double f = truth_uniform(random, 560.0, 610.0);
    const opms_lens_t lens = {1024, 768, f, f * truth_uniform(random, 0.995, 1.005),
                              truth_uniform(random, 500.0, 524.0),
                              truth_uniform(random, 370.0, 398.0),
                              -0.118, 0.031, 0.0011, -0.0007};
    return lens;
}

/* Pictures of the lens as it is now; the poses lean by 0.25 rad or more, as a careful hand does. */
static void take(scene_t *to, const opms_lens_t *lens, uint32_t pictures, double noise_px,
                 double stated_px, uint64_t *random)
{
    scene_plan_t plan = scene_usual_plan();
    plan.step = 3;
    plan.sigma_px = noise_px;
    to->lens = *lens;
    to->picture_count = pictures;
    for (uint32_t k = 0; k < pictures; ++k) {
        do {
            do {
                to->target_camera[k] = scene_pose(random, 0.6);
            } while (fabs(to->target_camera[k].R[8]) > 0.97);
            scene_look(to, k, &plan, random);
        } while (to->point_count[k] < 60);
        for (uint32_t i = 0; i < to->point_count[k]; ++i)
            to->points[k][i].sigma_px = stated_px;
    }
}

static const opms_footprint_t EXACT = {0, 0.35, 0.0, 0.0, 0.0003, 0.001};

/* Where the camera sits, if it saw the grid from here with the head on the footprint. */
static opms_transform_t mounting_of(const opms_transform_t *target_camera)
{
    opms_transform_t mounting = *target_camera;
    mounting.t_m[0] -= EXACT.x_m;
    return mounting;
}

/* A camera calibrated from a dozen pictures, the head placed with an error. */
static opms_camera_t calibrated(uint64_t *random)
{
    const opms_lens_t lens = hope_lens(random);
    opms_calib_result_t result;
    opms_camera_t camera;
    opms_footprint_t placed = EXACT;
    memset(&camera, 0, sizeof camera);
    take(&scene, &lens, 12, 0.02, 0.02, random);
    placed.x_m += placed.sigma_m * truth_gauss(random);
    placed.y_m += placed.sigma_m * truth_gauss(random);
    placed.yaw_rad += placed.sigma_rad * truth_gauss(random);
    opms_calibrator_t *calibrator = scene_calibrator(&scene, 0.0);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_solve(calibrator, &result, &err));
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_camera(calibrator, &placed, 1, &camera, &err));
    opms_calibrator_destroy(calibrator);
    return camera;
}

/* Check the camera by the pictures of `later`, the first on a footprint or none. */
static opms_calib_lens_check_t check(const opms_camera_t *camera, const opms_footprint_t *placed,
                                     opms_calib_mounting_check_t *mounting)
{
    opms_calib_lens_check_t lens;
    opms_calibrator_t *calibrator = scene_calibrator(&later, 0.0);
    TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK,
                              opms_calibrator_check(calibrator, camera, placed, placed ? 1 : 0,
                                                    &lens, mounting, &err),
                              err.message);
    opms_calibrator_destroy(calibrator);
    return lens;
}

/* How often a lens is called touched, of `runs`; what `change` does to it is the test's. */
static double alarms(int runs, uint32_t pictures, double noise_px, void (*change)(opms_lens_t *),
                     double *quarter)
{
    uint64_t random = 31 + pictures;
    int found = 0, low = 0;
    for (int i = 0; i < runs; ++i) {
        const opms_camera_t camera = calibrated(&random);
        opms_lens_t now = scene.lens;
        if (change)
            change(&now);
        take(&later, &now, pictures, noise_px, 0.02, &random);
        const opms_calib_lens_check_t lens = check(&camera, NULL, NULL);
        found += lens.chi2 > OPMS_CALIB_CHI2_LENS;
        low += lens.chi2 > 10.219; /* a quarter of chi2 of 8 */
        TEST_ASSERT_EQUAL_UINT32(pictures, lens.pictures_used);
    }
    if (quarter)
        *quarter = (double)low / runs;
    return (double)found / runs;
}

static void a_lens_that_was_left_alone_is_not_called_touched(void)
{
    for (uint32_t pictures = 1; pictures <= 4; pictures += 3) {
        double quarter;
        const double false_alarms = alarms(RUNS, pictures, 0.02, NULL, &quarter);
        printf("%u pictures: %.3f false alarms, %.3f above the upper quarter\n", pictures,
               false_alarms, quarter);
        TEST_ASSERT_TRUE(false_alarms <= 0.02); /* 0.001 are stated */
        TEST_ASSERT_TRUE(quarter < 0.40); /* 3.5 sigma; open directions only lower it */
        TEST_ASSERT_TRUE(quarter > 0.05); /* nor is the statement a hollow one */
    }
}

static void nodes_worse_than_stated_do_not_make_a_lens_touched(void)
{
    TEST_ASSERT_TRUE(alarms(RUNS / 2, 3, 1.5 * 0.02, NULL, NULL) <= 0.03);
}

static void longer(opms_lens_t *lens)
{
    lens->fx_px *= 1.005;
    lens->fy_px *= 1.005;
}

static void aside(opms_lens_t *lens)
{
    lens->cx_px += 5.0;
}

static void below(opms_lens_t *lens)
{
    lens->cy_px -= 5.0;
}

static void a_lens_turned_by_a_little_is_found(void)
{
    TEST_ASSERT_TRUE(alarms(RUNS / 4, 3, 0.02, longer, NULL) >= 0.96);
    TEST_ASSERT_TRUE(alarms(RUNS / 4, 3, 0.02, aside, NULL) >= 0.96);
    TEST_ASSERT_TRUE(alarms(RUNS / 4, 3, 0.02, below, NULL) >= 0.96);
}

static void what_a_check_says_it_would_show_it_shows(void)
{
    uint64_t random = 5;
    int found = 0;
    for (int i = 0; i < RUNS / 2; ++i) {
        const opms_camera_t camera = calibrated(&random);
        uint64_t again = random;
        take(&later, &scene.lens, 1, 0.02, 0.02, &again);
        const opms_calib_lens_check_t before = check(&camera, NULL, NULL);
        opms_lens_t now = scene.lens;
        now.fx_px *= 1.0 + before.shows_focal;
        now.fy_px *= 1.0 + before.shows_focal;
        take(&later, &now, 1, 0.02, 0.02, &random);
        found += check(&camera, NULL, NULL).chi2 > OPMS_CALIB_CHI2_LENS;
    }
    printf("a change of the size that shows: found in %d of %d\n", found, RUNS / 2);
    TEST_ASSERT_TRUE(found >= 50); /* of 60 */
}

/* A new picture with the head on the footprint, the camera turned on the detector by w. */
static double moved_chi2(const opms_camera_t *camera, const double w[3], uint64_t *random)
{
    opms_transform_t mounting = mounting_of(&scene.target_camera[0]);
    opms_calib_mounting_check_t answer;
    opms_footprint_t placed = EXACT;
    double turn[9], R[9];
    const double x_m = placed.x_m + placed.sigma_m * truth_gauss(random);
    const double y_m = placed.y_m + placed.sigma_m * truth_gauss(random);
    const double yaw[3] = {0.0, 0.0, placed.yaw_rad + placed.sigma_rad * truth_gauss(random)};
    const scene_plan_t plan = scene_usual_plan();
    truth_rotation(w, turn);
    truth_multiply(mounting.R, turn, R);
    memcpy(mounting.R, R, sizeof R);
    later.lens = scene.lens;
    later.picture_count = 1;
    truth_rotation(yaw, turn); /* the head stands a little off its marks */
    truth_multiply(turn, mounting.R, later.target_camera[0].R);
    const opms_transform_t head = {{turn[0], turn[1], turn[2], turn[3], turn[4], turn[5], turn[6],
                                    turn[7], turn[8]}, {x_m, y_m, 0.0}};
    truth_apply(&head, mounting.t_m, later.target_camera[0].t_m);
    scene_look(&later, 0, &plan, random);
    check(camera, &placed, &answer);
    return answer.chi2;
}

static void a_camera_turned_on_the_detector_is_found_and_no_other(void)
{
    uint64_t random = 9;
    int moved = 0, wrong = 0, high = 0;
    for (int i = 0; i < RUNS; ++i) {
        const opms_camera_t camera = calibrated(&random);
        const double none[3] = {0.0, 0.0, 0.0};
        double w[3], size = 0.0;
        for (int k = 0; k < 3; ++k) {
            w[k] = truth_gauss(&random);
            size += w[k] * w[k];
        }
        for (int k = 0; k < 3; ++k)
            w[k] *= 0.5 * 0.017453292519943295 / sqrt(size);
        const double still = moved_chi2(&camera, none, &random);
        wrong += still > OPMS_CALIB_CHI2_MOUNTING;
        high += still > 7.841; /* a quarter of chi2 of 6 */
        moved += moved_chi2(&camera, w, &random) > OPMS_CALIB_CHI2_MOUNTING;
    }
    printf("mounting: %d of %d turned ones found, %d false alarms, %d above the upper quarter\n",
           moved, RUNS, wrong, high);
    TEST_ASSERT_TRUE(wrong <= 2);
    TEST_ASSERT_INT_WITHIN(17, 30, high); /* 3.6 sigma: the statement is true, not just safe */
    TEST_ASSERT_TRUE(moved >= 115);
}

static void bad_calls_of_a_check_say_what_is_wrong(void)
{
    uint64_t random = 3;
    opms_camera_t camera = calibrated(&random);
    opms_calib_lens_check_t lens;
    opms_calib_mounting_check_t mounting;
    opms_footprint_t placed = EXACT;
    take(&later, &scene.lens, 1, 0.02, 0.02, &random);
    opms_calibrator_t *calibrator = scene_calibrator(&later, 0.0);
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG,
                      opms_calibrator_check(calibrator, NULL, NULL, 0, &lens, NULL, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG,
                      opms_calibrator_check(calibrator, &camera, &placed, 1, &lens, NULL, &err));
    placed.picture = 7;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_calibrator_check(calibrator, &camera, &placed, 1, &lens,
                                                          &mounting, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "no picture 7"));
    placed.picture = 0;
    camera.has_detector_camera = 0;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_calibrator_check(calibrator, &camera, &placed, 1, &lens,
                                                          &mounting, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "where it sits"));
    camera.lens.width_px = 1000;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG,
                      opms_calibrator_check(calibrator, &camera, NULL, 0, &lens, NULL, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "1000 x 768"));
    opms_calibrator_destroy(calibrator);
}

static void a_calibrator_can_solve_after_a_check_and_before(void)
{
    uint64_t random = 4;
    opms_calib_result_t first, second;
    opms_calib_lens_check_t lens;
    const opms_camera_t camera = calibrated(&random);
    opms_calibrator_t *calibrator = scene_calibrator(&scene, 0.0);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_solve(calibrator, &first, &err));
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_check(calibrator, &camera, NULL, 0, &lens, NULL,
                                                     &err));
    TEST_ASSERT_TRUE(lens.chi2 < 1.0); /* they are the pictures that it comes from */
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_solve(calibrator, &second, &err));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, first.lens.fx_px, second.lens.fx_px);
    opms_calibrator_destroy(calibrator);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_lens_that_was_left_alone_is_not_called_touched);
    RUN_TEST(nodes_worse_than_stated_do_not_make_a_lens_touched);
    RUN_TEST(a_lens_turned_by_a_little_is_found);
    RUN_TEST(what_a_check_says_it_would_show_it_shows);
    RUN_TEST(a_camera_turned_on_the_detector_is_found_and_no_other);
    RUN_TEST(bad_calls_of_a_check_say_what_is_wrong);
    RUN_TEST(a_calibrator_can_solve_after_a_check_and_before);
    return UNITY_END();
}
