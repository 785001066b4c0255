/* SPDX-License-Identifier: Apache-2.0 */
/* The detector's pose through a camera that was calibrated, mounting and all: is its stated
 * covariance true? Usage: test_calib_detector [RUNS]; 200 in ctest, more for a sharper answer. */
#include <opms/bar.h>
#include <opms/pose.h>

#include "../truth_scene.h"
#include "calib_scene.h"

#define RUNS_MOST 5000
#define CHI2_6_95 12.592
#define EDGES_LEAST 60

static scene_t scene;
static opms_edge_t edges[OPMS_BAR_EDGES_MAX];
static double together[RUNS_MOST], apart[RUNS_MOST];
static int runs = 200, lost;

void setUp(void)
{
}

void tearDown(void)
{
}

/* The head stood on the grid's footprint, level, and the camera is where it is. */
static opms_transform_t mounting_of(const opms_transform_t *target_camera,
                                    const opms_footprint_t *footprint)
{
    opms_transform_t mounting = *target_camera;
    mounting.t_m[0] -= footprint->x_m;
    mounting.t_m[1] -= footprint->y_m;
    return mounting;
}

/* b_a of a_b */
static opms_transform_t inverse_of(const opms_transform_t *a_b)
{
    const double origin[3] = {0.0, 0.0, 0.0};
    opms_transform_t b_a;
    for (int i = 0; i < 9; ++i)
        b_a.R[i] = a_b->R[3 * (i % 3) + i / 3];
    truth_apply_inverse(a_b, origin, b_a.t_m);
    return b_a;
}

static opms_transform_t product_of(const opms_transform_t *a_b, const opms_transform_t *b_c)
{
    opms_transform_t a_c;
    truth_multiply(a_b->R, b_c->R, a_c.R);
    truth_apply(a_b, b_c->t_m, a_c.t_m);
    return a_c;
}

/* The camera calibrated from the scene, its head placed with an error. */
static opms_camera_t calibrate(opms_transform_t *mounting, uint64_t *random)
{
    opms_footprint_t footprint = {0, 0.1, 0.05, 0.0, 0.0002, 0.0005};
    opms_calib_result_t result;
    opms_camera_t camera;
    opms_calibrator_t *calibrator = scene_calibrator(&scene, 0.0);
    memset(&camera, 0, sizeof camera);
    *mounting = mounting_of(&scene.target_camera[0], &footprint);
    footprint.x_m += footprint.sigma_m * truth_gauss(random);
    footprint.y_m += footprint.sigma_m * truth_gauss(random);
    footprint.yaw_rad += footprint.sigma_rad * truth_gauss(random);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_solve(calibrator, &result, NULL));
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_camera(calibrator, &footprint, 1, &camera, NULL));
    opms_calibrator_destroy(calibrator);
    return camera;
}

/* Beyond the picture a strong distortion folds back into it; no camera sees that. */
static uint32_t keep_seen(const opms_transform_t *bar_camera, uint32_t count)
{
    const opms_lens_t *lens = &scene.lens;
    const double reach = 0.6 * hypot(lens->width_px, lens->height_px) / lens->fx_px;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const double at[3] = {edges[i].bar_m[0], edges[i].bar_m[1], 0.0};
        double p[3];
        truth_apply_inverse(bar_camera, at, p);
        if (hypot(p[0], p[1]) < reach * p[2])
            edges[kept++] = edges[i];
    }
    return kept;
}

/* A view of the bar with enough of it in sight, and its edges with noise. */
static uint32_t look_at_bar(uint64_t *random, opms_transform_t *bar_camera)
{
    uint32_t count;
    do {
        *bar_camera = scene_pose(random, 0.5);
        count = truth_edges(&scene.lens, bar_camera, 0, 32, 3, edges);
        count = keep_seen(bar_camera, count);
    } while (count < EDGES_LEAST);
    for (uint32_t i = 0; i < count; ++i) {
        edges[i].sigma_px = 0.02;
        truth_move_edge(&edges[i], 0.02 * truth_gauss(random));
    }
    return count;
}

static double chi2_of(const opms_pose_t *found, const opms_transform_t *truth)
{
    double x[6];
    truth_small_rotation(found->transform.R, truth->R, x);
    for (int i = 0; i < 3; ++i)
        x[3 + i] = truth->t_m[i] - found->transform.t_m[i];
    return truth_chi2(found->covariance, 6, x, 6);
}

static void run(int i, uint64_t *random)
{
    scene_plan_t plan = scene_usual_plan();
    opms_transform_t mounting, bar_camera;
    opms_pose_result_t view;
    opms_pose_t detector;
    plan.step = 3;
    scene_take(&scene, &plan, random);
    opms_camera_t camera = calibrate(&mounting, random);
    do {
        const uint32_t count = look_at_bar(random, &bar_camera);
        TEST_ASSERT_EQUAL(OPMS_OK, opms_pose_solve(&camera.lens, edges, count, NULL, &view, NULL));
        lost += view.state != OPMS_POSE_FOUND; /* nothing is stated, so nothing can be false */
    } while (view.state != OPMS_POSE_FOUND);
    const opms_transform_t camera_detector = inverse_of(&mounting);
    const opms_transform_t truth = product_of(&bar_camera, &camera_detector);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pose_detector(&view, &camera, 0.0, &detector, NULL, NULL));
    together[i] = chi2_of(&detector, &truth);
    camera.has_covariance_detector_camera_intrinsics = 0;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pose_detector(&view, &camera, 0.0, &detector, NULL, NULL));
    apart[i] = chi2_of(&detector, &truth);
}

static double held(const double *chi2)
{
    int count = 0;
    for (int i = 0; i < runs; ++i)
        count += chi2[i] < CHI2_6_95;
    return (double)count / runs;
}

static double mean(const double *chi2)
{
    double sum = 0.0;
    for (int i = 0; i < runs; ++i)
        sum += chi2[i] / 6.0;
    return sum / runs;
}

/* Chance alone stays within 3 sigma of 95 %: 4.6 % of 200 runs. */
static void the_detectors_region_holds_as_often_as_it_says(void)
{
    uint64_t random = 77;
    for (int i = 0; i < runs; ++i)
        run(i, &random);
    printf("held %.3f (chi2 of 6 / 6: %.3f); as if lens and mounting shared nothing %.3f (%.3f)\n",
           held(together), mean(together), held(apart), mean(apart));
    TEST_ASSERT_TRUE(100 * lost <= runs);
    TEST_ASSERT_DOUBLE_WITHIN(3.0 * sqrt(0.95 * 0.05 / runs), 0.95, held(together));
    TEST_ASSERT_DOUBLE_WITHIN(3.5 * sqrt(2.0 / 6.0 / runs), 1.0, mean(together));
    TEST_ASSERT_TRUE(mean(apart) < 0.9 * mean(together));
}

int main(int argc, char **argv)
{
    if (argc > 1)
        runs = atoi(argv[1]) < 20 || atoi(argv[1]) > RUNS_MOST ? runs : atoi(argv[1]);
    UNITY_BEGIN();
    RUN_TEST(the_detectors_region_holds_as_often_as_it_says);
    return UNITY_END();
}
