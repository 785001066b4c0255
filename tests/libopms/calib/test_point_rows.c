/* SPDX-License-Identifier: Apache-2.0 */
/* Rows of the calibration's least-squares problem against differences of the tests' own camera
 * model, and their products against plain sums. */
#include <math.h>
#include <string.h>

#include <unity.h>

#include "../truth_project.h"
#include "calib/cockle_powers.h"
#include "calib/point_rows.h"

#define POINTS 14
#define STRIDE 2
#define TAKEN 7
#define LENS 8
#define COCKLE OPMS_CALIB_COCKLE_TERMS
#define COLUMNS (LENS_COLUMNS + COCKLE + 7)
#define SIGMA_PX 0.05
#define WINDOW2 36.0
#define SCALE_M 0.4

/* Everything that the unknowns move. */
typedef struct scene {
    opms_lens_t lens;
    double cockle[COCKLE];
    opms_transform_t target_camera;
} scene_t;

static scene_t scene;
static opms_calib_point_t points[POINTS];
static double columns[2][COLUMNS][GRAM_ROWS];
static int in_front;

static void see(const scene_t *of, const double target_m[2], double px[2])
{
    double at[3] = {target_m[0], target_m[1], 0.0};
    for (int k = 0; k < COCKLE; ++k) {
        at[2] += of->cockle[k] * pow(at[0] / SCALE_M, COCKLE_POWERS[k][0]) *
                 pow(at[1] / SCALE_M, COCKLE_POWERS[k][1]);
    }
    truth_project(&of->lens, &of->target_camera, at, px);
}

void setUp(void)
{
    static const double facing[9] = {1, 0, 0, 0, -1, 0, 0, 0, -1}, lean[3] = {0.3, -0.2, 0.5};
    const opms_lens_t lens = {1024, 768, 590.0, 580.0, 517.0, 380.0, -0.12, 0.03, 0.001, -0.002};
    uint64_t seed = 4;
    double turn[9], px[2];
    memset(&scene, 0, sizeof scene);
    scene.lens = lens;
    truth_rotation(lean, turn);
    truth_multiply(facing, turn, scene.target_camera.R);
    for (int i = 0; i < 3; ++i) {
        scene.target_camera.t_m[i] = -0.5 * scene.target_camera.R[3 * i + 2];
    }
    for (int k = 0; k < COCKLE; ++k) {
        scene.cockle[k] = truth_uniform(&seed, -0.01, 0.01);
    }
    for (int i = 0; i < POINTS; ++i) {
        points[i].target_m[0] = truth_uniform(&seed, -0.2, 0.2);
        points[i].target_m[1] = truth_uniform(&seed, -0.2, 0.2);
        points[i].sigma_px = SIGMA_PX;
        see(&scene, points[i].target_m, px);
        points[i].px[0] = px[0] + 1.5 * SIGMA_PX * truth_gauss(&seed);
        points[i].px[1] = px[1] + 1.5 * SIGMA_PX * truth_gauss(&seed);
    }
    memset(columns, 0x55, sizeof columns);
    in_front = 1;
}

void tearDown(void)
{
}

static point_view_t usual_view(void)
{
    point_view_t view = {.lens = scene.lens,
                         .cockle = scene.cockle,
                         .cockle_scale_m = SCALE_M,
                         .cockle_columns = COCKLE,
                         .window2 = WINDOW2,
                         .inlier_rest = 0.5};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            view.R[3 * i + j] = scene.target_camera.R[3 * j + i];
            view.origin[i] -= scene.target_camera.R[3 * j + i] * scene.target_camera.t_m[j];
        }
    }
    return view;
}

static double make_rows(const point_view_t *view)
{
    return point_rows(view, points, STRIDE, TAKEN, columns[0][0], COLUMNS * GRAM_ROWS, &in_front);
}

/* The scene with the unknown of a column of `axis` moved. */
static scene_t moved(int axis, int column, double by)
{
    scene_t other = scene;
    if (column < LENS_COLUMNS) {
        *truth_intrinsic(&other.lens, column < 2 ? 2 * column + axis : column + 2) += by;
    } else if (column < LENS_COLUMNS + COCKLE) {
        other.cockle[column - LENS_COLUMNS] += by;
    } else if (column < LENS_COLUMNS + COCKLE + 3) {
        double w[3] = {0.0, 0.0, 0.0}, turn[9];
        w[column - LENS_COLUMNS - COCKLE] = by;
        truth_rotation(w, turn);
        truth_multiply(scene.target_camera.R, turn, other.target_camera.R);
    } else {
        other.target_camera.t_m[column - LENS_COLUMNS - COCKLE - 3] += by;
    }
    return other;
}

/* Root of Tukey's weight, by the truth's own residual. */
static double rest_of(const opms_calib_point_t *point, double off[2])
{
    double px[2];
    see(&scene, point->target_m, px);
    off[0] = point->px[0] - px[0];
    off[1] = point->px[1] - px[1];
    const double z2 = (off[0] * off[0] + off[1] * off[1]) / (SIGMA_PX * SIGMA_PX);
    return z2 < WINDOW2 ? 1.0 - z2 / WINDOW2 : 0.0;
}

static void rows_are_the_model_s_slopes_and_the_residuals(void)
{
    const double step = 1e-5;
    const point_view_t view = usual_view();
    double cost = 0.0;
    const double got_cost = make_rows(&view);
    for (int i = 0; i < TAKEN; ++i) {
        const opms_calib_point_t *point = &points[i * STRIDE];
        double off[2];
        const double rest = rest_of(point, off), root = rest / SIGMA_PX;
        cost += WINDOW2 / 3.0 * (1.0 - rest * rest * rest);
        for (int axis = 0; axis < 2; ++axis) {
            for (int column = 0; column < COLUMNS - 1; ++column) {
                const scene_t more = moved(axis, column, step), less = moved(axis, column, -step);
                double after[2], before[2];
                see(&more, point->target_m, after);
                see(&less, point->target_m, before);
                const double slope = root * (after[axis] - before[axis]) / (2.0 * step);
                TEST_ASSERT_DOUBLE_WITHIN(1e-5 * fabs(slope) + 1e-3, slope,
                                          columns[axis][column][i]);
            }
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, root * off[axis], columns[axis][COLUMNS - 1][i]);
        }
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9 * cost, cost, got_cost);
    TEST_ASSERT_EQUAL(1, in_front);
}

static void rows_without_a_point_are_zero(void)
{
    const point_view_t view = usual_view();
    make_rows(&view);
    for (int column = 0; column < COLUMNS; ++column) {
        for (int i = TAKEN; i < GRAM_ROWS; ++i) {
            TEST_ASSERT_TRUE(columns[0][column][i] == 0.0 && columns[1][column][i] == 0.0);
        }
    }
}

static void a_point_far_off_costs_the_window_and_pulls_nothing(void)
{
    const point_view_t view = usual_view();
    const double before = make_rows(&view);
    double off[2];
    const double rest = rest_of(&points[STRIDE], off);
    points[STRIDE].px[0] += 100.0;
    const double after = make_rows(&view);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, WINDOW2 / 3.0 * rest * rest * rest, after - before);
    for (int column = 0; column < COLUMNS; ++column) {
        TEST_ASSERT_TRUE(columns[0][column][1] == 0.0 && columns[1][column][1] == 0.0);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, after, point_costs(&view, points, STRIDE, TAKEN, &in_front));
}

static void an_inlier_counts_wholly_where_that_is_asked_for(void)
{
    point_view_t view = usual_view();
    view.inliers_only = 1;
    points[0].px[0] += 9.0 * SIGMA_PX; /* a weight below a quarter begins at 4.24 */
    make_rows(&view);
    TEST_ASSERT_TRUE(columns[0][1][0] == 0.0 && columns[0][1][1] > 0.0);
    for (int i = 0; i < TAKEN; ++i) {
        double off[2];
        const int is_inlier = rest_of(&points[i * STRIDE], off) >= 0.5;
        /* The principal point's column is the root of the weight. */
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, is_inlier ? 1.0 / SIGMA_PX : 0.0, columns[0][1][i]);
    }
}

static void a_point_behind_the_camera_is_told_and_spoils_no_sum(void)
{
    point_view_t view = usual_view();
    view.origin[2] = -1e-3;
    make_rows(&view);
    TEST_ASSERT_EQUAL(0, in_front);
    for (int axis = 0; axis < 2; ++axis) {
        for (int column = 0; column < COLUMNS; ++column) {
            for (int i = 0; i < GRAM_ROWS; ++i) {
                TEST_ASSERT_TRUE(isfinite(columns[axis][column][i]));
            }
        }
    }
}

static void products_of_columns_are_summed_up(void)
{
    enum { COUNT = 6 };
    double own[COUNT][GRAM_ROWS], gram[COUNT * COUNT];
    uint64_t seed = 9;
    for (int i = 0; i < COUNT * GRAM_ROWS; ++i) {
        own[i / GRAM_ROWS][i % GRAM_ROWS] = truth_gauss(&seed);
    }
    for (int i = 0; i < COUNT * COUNT; ++i) {
        gram[i] = i;
    }
    gram_add(own[0], COUNT, gram);
    for (int a = 0; a < COUNT; ++a) {
        for (int b = a; b < COUNT; ++b) {
            double sum = a * COUNT + b;
            for (int i = 0; i < GRAM_ROWS; ++i) {
                sum += own[a][i] * own[b][i];
            }
            TEST_ASSERT_DOUBLE_WITHIN(1e-12 * GRAM_ROWS, sum, gram[a * COUNT + b]);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(rows_are_the_model_s_slopes_and_the_residuals);
    RUN_TEST(rows_without_a_point_are_zero);
    RUN_TEST(a_point_far_off_costs_the_window_and_pulls_nothing);
    RUN_TEST(an_inlier_counts_wholly_where_that_is_asked_for);
    RUN_TEST(a_point_behind_the_camera_is_told_and_spoils_no_sum);
    RUN_TEST(products_of_columns_are_summed_up);
    return UNITY_END();
}
