/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Where a side is on average while the camera goes its way, judged by the camera model itself. */
#include <math.h>

#include <unity.h>

#include "bar/side_way.h"
#include "bar_scene.h"
#include "truth_project.h"

#define RAY_LIMIT 3.0
#define INSTANTS 1000

void setUp(void)
{
}

void tearDown(void)
{
}

/** The map of the whole bar, in its own coordinates. */
static plane_map_t true_map(const bar_scene_t *picture)
{
    plane_map_t map;
    plane_pair_t pairs[20];
    for (int i = 0; i < 20; ++i) {
        const double x_mm = i % 2 ? 10.0 : -10.0, y_mm = 15.0 * (i / 2) - 10.0;
        const double bar_m[3] = {1e-3 * x_mm, 1e-3 * y_mm, 0.0};
        double camera_m[3];
        truth_apply_inverse(&picture->bar_camera, bar_m, camera_m);
        pairs[i] =
            (plane_pair_t){x_mm, y_mm, {camera_m[0] / camera_m[2], camera_m[1] / camera_m[2]}};
    }
    TEST_ASSERT_TRUE(plane_map_fit(&map, pairs, 20));
    return map;
}

/** What the detector knows of a picture whose camera has gone way_m. */
static edge_scene_t moved_scene(const bar_scene_t *picture, const double way_m[3])
{
    edge_scene_t scene = {.lens = &picture->lens, .ray_limit = RAY_LIMIT, .shaped = 1};
    const double *camera_m = picture->bar_camera.t_m;
    const double growth = -way_m[2] / camera_m[2];
    scene.map = true_map(picture);
    scene.way_at = 40;
    scene.way_mm[0] = -1e3 * way_m[0] - 1e3 * camera_m[0] * growth;
    scene.way_mm[1] = -1e3 * way_m[1] + (scene.way_at - 1e3 * camera_m[1]) * growth;
    scene.way_mm[2] = -1e3 * way_m[2];
    return scene;
}

/** Where a point of the bar is seen, px, when the camera has gone `part` of its way. */
static void seen_underway(const bar_scene_t *picture, const double way_m[3], double part,
                          const double at_mm[2], double px[2])
{
    opms_transform_t camera = picture->bar_camera;
    for (int axis = 0; axis < 3; ++axis) {
        camera.t_m[axis] += part * way_m[axis];
    }
    const double bar_m[3] = {1e-3 * at_mm[0], 1e-3 * at_mm[1], 0};
    truth_project(&picture->lens, &camera, bar_m, px);
}

static void a_side_is_on_average_beyond_its_middle_position_by_its_sag(void)
{
    static const double ways_m[3][3] = {
        {3e-3, -5e-3, 2e-3}, {7e-3, 0, 0}, {0, 7e-3, -1e-3}};
    const bar_scene_t picture = bar_scene();
    double most = 0;
    for (int w = 0; w < 3; ++w) {
        const edge_scene_t scene = moved_scene(&picture, ways_m[w]);
        for (int side = 0; side < 4; ++side) {
            const side_way_t way = side_way_of(&scene, 17, side);
            double mean[2] = {0, 0}, middle[2];
            seen_underway(&picture, ways_m[w], 0, way.at_mm, middle);
            for (int i = 0; i < INSTANTS; ++i) {
                double px[2];
                seen_underway(&picture, ways_m[w], (i + 0.5) / INSTANTS - 0.5, way.at_mm, px);
                mean[0] += px[0] / INSTANTS;
                mean[1] += px[1] / INSTANTS;
            }
            for (int axis = 0; axis < 2; ++axis) {
                const double normal[2] = {axis == 0, axis == 1};
                const double sag = side_way_sag(&scene, &way, normal);
                TEST_ASSERT_DOUBLE_WITHIN(3e-5, mean[axis] - middle[axis], sag);
                most = fmax(most, fabs(sag));
            }
        }
    }
    TEST_ASSERT_TRUE(most > 2e-3);
}

static void a_way_is_that_of_the_picture_over_the_bar(void)
{
    const double way_m[3] = {3e-3, -5e-3, 2e-3};
    const bar_scene_t picture = bar_scene();
    const edge_scene_t scene = moved_scene(&picture, way_m);
    for (int side = 0; side < 4; ++side) {
        const side_way_t way = side_way_of(&scene, 17, side);
        const double there[2] = {way.at_mm[0] + 1e-3 * way.mm[0], way.at_mm[1] + 1e-3 * way.mm[1]};
        double seen[2], expected[2];
        seen_underway(&picture, way_m, 1e-3, way.at_mm, seen);
        seen_underway(&picture, way_m, 0, there, expected);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, seen[0], expected[0]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, seen[1], expected[1]);
    }
}

static void what_stands_still_has_no_way_and_no_sag(void)
{
    const double way_m[3] = {0, 0, 0}, normal[2] = {1, 0};
    const bar_scene_t picture = bar_scene();
    const edge_scene_t scene = moved_scene(&picture, way_m);
    const side_way_t way = side_way_of(&scene, 17, 2);
    TEST_ASSERT_EQUAL_DOUBLE(0, way.mm[0]);
    TEST_ASSERT_EQUAL_DOUBLE(0, way.mm[1]);
    TEST_ASSERT_EQUAL_DOUBLE(0, side_way_sag(&scene, &way, normal));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_way_is_that_of_the_picture_over_the_bar);
    RUN_TEST(a_side_is_on_average_beyond_its_middle_position_by_its_sag);
    RUN_TEST(what_stands_still_has_no_way_and_no_sag);
    return UNITY_END();
}
