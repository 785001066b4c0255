/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the shape of profiles is known by, and what of it the pose is told. */
#include <math.h>
#include <string.h>

#include <unity.h>

#include "bar/plane_map.h"
#include "bar/shaped_fit.h"

#define STRETCHES 40
#define SIGMA_PX 0.05
#define DOUBT 10 /* of shaped_fit.c */

static bar_fit_t fit;

void setUp(void)
{
    memset(&fit, 0, sizeof fit);
    fit.count = STRETCHES;
    for (int i = 0; i < STRETCHES; ++i) {
        fit.good[i] = 1;
        fit.sigma[i] = (float)SIGMA_PX;
        fit.stretch[i].sigma_unit = (float)SIGMA_PX; /* noise of one grey level */
        fit.stretch[i].side = (int16_t)(i % 4);
    }
}

void tearDown(void)
{
}

static edge_scene_t cut_scene(double clip)
{
    edge_scene_t scene = {0};
    scene.shaped = 1;
    scene.clip = clip;
    scene.shift_px = 0.02;
    scene.blur_px[0] = scene.blur_px[1] = scene.still_px = 0.7;
    scene.blur_scale[0] = scene.blur_scale[1] = 1;
    return scene;
}

/** Let the sides along Y, and those along X, answer to the lens's blur, of which the profiles tell
 * to a standard deviation. */
static void let_blur_matter(double by_y, double by_x, double sigma)
{
    for (int i = 0; i < STRETCHES; ++i) {
        fit.shape[i].by[SHAPE_STILL] = (float)(i & 1 ? by_x : by_y);
        fit.shape[i].weight[SHAPE_STILL][SHAPE_STILL] =
            (float)(DOUBT / (sigma * sigma) / STRETCHES);
    }
}

static void the_pose_knows_the_shift_along_y_as_far_as_the_shape_is_known(void)
{
    const edge_scene_t scene = cut_scene(0.6);
    const double own = SIGMA_PX / sqrt(STRETCHES / 2.0), sigma = 0.04;
    let_blur_matter(1, 0, sigma);
    shaped_gains(&scene, &fit);
    TEST_ASSERT_FLOAT_WITHIN(1e-3, 1, fit.shift_gain[0]);
    TEST_ASSERT_FLOAT_WITHIN(1e-3, own / sigma, fit.shift_gain[1]);
    /* What the sides along X no longer take part in has been taken off them. */
    TEST_ASSERT_FLOAT_WITHIN(1e-4, 0, fit.stretch[0].offset_px);
    TEST_ASSERT_FLOAT_WITHIN(1e-4, -0.02 * (1 - own / sigma), fit.stretch[1].offset_px);
}

static void what_all_sides_share_stays_shared(void)
{
    const edge_scene_t scene = cut_scene(0.6);
    let_blur_matter(1, 1, 0.04);
    shaped_gains(&scene, &fit);
    TEST_ASSERT_EQUAL_FLOAT(1, fit.shift_gain[0]);
    TEST_ASSERT_EQUAL_FLOAT(1, fit.shift_gain[1]);
    TEST_ASSERT_EQUAL_FLOAT(0, fit.stretch[1].offset_px);
}

static void the_less_is_left_of_white_the_less_is_known(void)
{
    const edge_scene_t half = cut_scene(0.5), quarter = cut_scene(0.25);
    let_blur_matter(1, 0, 0.04);
    shaped_gains(&half, &fit);
    const float known = fit.shift_gain[1];
    shaped_gains(&quarter, &fit);
    TEST_ASSERT_FLOAT_WITHIN(1e-4, known / 4, fit.shift_gain[1]);
}

static void a_map_tells_how_far_the_camera_is(void)
{
    /* Tilted by 40 degrees about X, 450 mm away, square 3 of the bar under the axis. */
    const double turn = 0.7, far_mm = 450, y0 = 90, scale = 200;
    plane_map_t map = {.y0_mm = y0, .scale_mm = scale};
    const double at[3] = {12, -20, far_mm};
    const double columns[3][3] = {{1, 0, 0}, {0, cos(turn), sin(turn)}, {at[0], at[1], at[2]}};
    for (int i = 0; i < 3; ++i) {
        map.h[3 * i] = columns[0][i] * 10 / far_mm;
        map.h[3 * i + 1] = columns[1][i] * scale / far_mm;
        map.h[3 * i + 2] = columns[2][i] / far_mm;
    }
    /* Of the point that the bar's normal, (0, -sin, cos), meets. */
    const double height = -(-sin(turn) * at[1] + cos(turn) * at[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, height, plane_map_height(&map));
}

static void motion_fanned_out_is_as_strong_in_the_mean(void)
{
    edge_scene_t scene = cut_scene(UNCUT);
    scene.map = (plane_map_t){.h = {10 / 500.0, 0, 0, 0, 1, 0, 0, 0, 1}, .scale_mm = 500};
    scene.way_mm[1] = 4;
    shaped_fan(&scene, 150);
    TEST_ASSERT_EQUAL_DOUBLE(0, scene.way_mm[1]);
    double squares = 0;
    for (int y = -150; y <= 150; ++y) {
        const double way = scene.way_mm[2] * y / plane_map_height(&scene.map);
        squares += way * way / 301;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 4, sqrt(squares));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_pose_knows_the_shift_along_y_as_far_as_the_shape_is_known);
    RUN_TEST(what_all_sides_share_stays_shared);
    RUN_TEST(the_less_is_left_of_white_the_less_is_known);
    RUN_TEST(a_map_tells_how_far_the_camera_is);
    RUN_TEST(motion_fanned_out_is_as_strong_in_the_mean);
    return UNITY_END();
}
