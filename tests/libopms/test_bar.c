/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <unity.h>

#include <opms/bar.h>
#include <opms/pose.h>

#include "bar_scene.h"
#include "truth_project.h"

#define DEGREE 0.017453292519943295

static uint8_t picture[BAR_SCENE_PIXELS];
static bar_scene_t scene;
static opms_image_t image;
static opms_bar_detector_t *detector;
static opms_bar_summary_t summary;

void setUp(void)
{
    scene = bar_scene();
    image = (opms_image_t){picture,         BAR_SCENE_WIDTH,  BAR_SCENE_HEIGHT,
                           BAR_SCENE_WIDTH, OPMS_PIXEL_GREY8, 0};
    TEST_ASSERT_EQUAL(OPMS_OK, opms_bar_detector_create(&scene.lens, NULL, &detector, NULL));
}

void tearDown(void)
{
    opms_bar_detector_destroy(detector);
    detector = NULL;
}

static void detect_in(const opms_roi_t *roi, const opms_transform_t *hint)
{
    opms_error_t err = {OPMS_OK, 0, "", ""};
    const opms_status_t status = opms_bar_detect(detector, &image, roi, hint, &summary, &err);
    TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK, status, err.message);
}

static void render_and_detect(void)
{
    bar_render8(&scene, picture);
    detect_in(NULL, NULL);
}

/** The squares that were found are where they are, under their own index. */
static void assert_squares_are_true(double tolerance_px)
{
    uint32_t count;
    const opms_square_t *squares = opms_bar_squares(detector, &count);
    TEST_ASSERT_EQUAL_UINT32(summary.square_count, count);
    for (uint32_t i = 0; i < count; ++i) {
        TEST_ASSERT_TRUE(i == 0 || squares[i].index > squares[i - 1].index);
        TEST_ASSERT_TRUE(squares[i].edges > 0);
        for (int c = 0; c < 4; ++c) {
            double px[2];
            bar_scene_corner(&scene, squares[i].index, c, px);
            TEST_ASSERT_DOUBLE_WITHIN(tolerance_px, px[0], squares[i].corners_px[c][0]);
            TEST_ASSERT_DOUBLE_WITHIN(tolerance_px, px[1], squares[i].corners_px[c][1]);
        }
    }
}

static int was_found(int index)
{
    uint32_t count;
    const opms_square_t *squares = opms_bar_squares(detector, &count);
    for (uint32_t i = 0; i < count; ++i) {
        if (squares[i].index == index) {
            return 1;
        }
    }
    return 0;
}

/** Located, every whole square between first and last among the squares, all where they are. */
static void assert_located(int first, int last)
{
    TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, summary.state);
    assert_squares_are_true(0.3);
    for (int k = first; k <= last; ++k) {
        if (bar_scene_sees(&scene, k, 6.0)) {
            TEST_ASSERT_TRUE_MESSAGE(was_found(k), "a square that is seen was not found");
        }
    }
}

static opms_pose_result_t solve(void)
{
    uint32_t count;
    const opms_edge_t *edges = opms_bar_edges(detector, &count);
    opms_pose_result_t result;
    TEST_ASSERT_EQUAL_UINT32(summary.edge_count, count);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pose_solve(&scene.lens, edges, count, NULL, &result, NULL));
    TEST_ASSERT_EQUAL(OPMS_POSE_FOUND, result.state);
    return result;
}

static double distance_m(const double a[3], const double b[3])
{
    return sqrt(pow(a[0] - b[0], 2.0) + pow(a[1] - b[1], 2.0) + pow(a[2] - b[2], 2.0));
}

static void all_squares_in_the_picture_are_found_and_labelled(void)
{
    for (int i = 0; i < 5; ++i) {
        scene = bar_scene();
        scene.seed = (uint64_t)(3 + i);
        scene.bar_camera.t_m[1] = -0.4 + 0.2 * i; /* both ends of the bar come by */

        render_and_detect();

        assert_located(0, 32);
        TEST_ASSERT_GREATER_OR_EQUAL_UINT32(8, summary.square_count);
        TEST_ASSERT_TRUE(summary.label_margin > 20.0);
        TEST_ASSERT_EQUAL_UINT32(0, summary.followed);
    }
}

static void the_bar_is_read_in_every_direction(void)
{
    for (int i = 0; i < 12; ++i) {
        scene = bar_scene();
        scene.seed = (uint64_t)(20 + i);
        bar_scene_roll(&scene, (180.0 + 30.0 * i) * DEGREE);

        render_and_detect();

        assert_located(0, 32);
    }
}

static void edges_lie_as_near_the_truth_as_they_say(void)
{
    double squares_of_z = 0.0;
    uint32_t total = 0;
    for (int i = 0; i < 6; ++i) {
        scene = bar_scene();
        scene.seed = (uint64_t)(40 + i);
        scene.bar_camera.t_m[0] += 0.011 * (i - 3);
        bar_scene_roll(&scene, 0.21 * i);
        render_and_detect();
        TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, summary.state);
        uint32_t count;
        const opms_edge_t *edges = opms_bar_edges(detector, &count);
        for (uint32_t k = 0; k < count; ++k) {
            const double bar_m[3] = {edges[k].bar_m[0], edges[k].bar_m[1], 0.0};
            double px[2];
            truth_project(&scene.lens, &scene.bar_camera, bar_m, px);
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, hypot(edges[k].normal[0], edges[k].normal[1]));
            TEST_ASSERT_TRUE(edges[k].sigma_px > 0.002 && edges[k].sigma_px < 0.3);
            const double off_px = (edges[k].px[0] - px[0]) * edges[k].normal[0] +
                                  (edges[k].px[1] - px[1]) * edges[k].normal[1];
            squares_of_z += pow(off_px / edges[k].sigma_px, 2.0);
        }
        total += count;
    }
    TEST_ASSERT_GREATER_THAN_UINT32(600, total);
    TEST_ASSERT_DOUBLE_WITHIN(0.35, 1.05, squares_of_z / total);
}

static void normals_point_out_of_the_square(void)
{
    render_and_detect();
    uint32_t count;
    const opms_edge_t *edges = opms_bar_edges(detector, &count);
    TEST_ASSERT_GREATER_THAN_UINT32(0, count);
    for (uint32_t k = 0; k < count; ++k) {
        double middle[2] = {0.0, 0.0};
        for (int c = 0; c < 4; ++c) {
            double px[2];
            bar_scene_corner(&scene, edges[k].square, c, px);
            middle[0] += 0.25 * px[0];
            middle[1] += 0.25 * px[1];
        }
        TEST_ASSERT_TRUE((edges[k].px[0] - middle[0]) * edges[k].normal[0] +
                             (edges[k].px[1] - middle[1]) * edges[k].normal[1] >
                         0.0);
    }
}

static void the_summary_tells_blur_contrast_and_noise(void)
{
    render_and_detect();

    TEST_ASSERT_DOUBLE_WITHIN(5.0, scene.white - scene.black, summary.contrast);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, hypot(scene.blur_px, sqrt(1.0 / 12.0)), summary.blur_px[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, hypot(scene.blur_px, sqrt(1.0 / 12.0)), summary.blur_px[1]);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, scene.noise, summary.noise);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, summary.white_fraction_saturated);
}

static void three_squares_are_enough_and_two_are_not(void)
{
    bar_scene_show(&scene, 15, 17);
    render_and_detect();
    assert_located(15, 17);
    TEST_ASSERT_EQUAL_UINT32(3, summary.square_count);

    bar_scene_show(&scene, 15, 16);
    render_and_detect();
    TEST_ASSERT_NOT_EQUAL(OPMS_BAR_LOCATED, summary.state);
    TEST_ASSERT_EQUAL_UINT32(0, summary.square_count);
    TEST_ASSERT_EQUAL_UINT32(0, summary.edge_count);
}

static void a_covered_square_does_not_stop_the_row(void)
{
    scene.hidden_m[0] = -0.0125; /* square 16 and the cells next to it */
    scene.hidden_m[1] = 0.0175;

    render_and_detect();

    assert_located(0, 15);
    assert_located(17, 32);
    TEST_ASSERT_FALSE(was_found(16));
}

/** Move what lies around a square's sides along X down by `px`, as a blade of grass on each of them
 * may seem to. */
static void displace_ends(int square, double px)
{
    double low[2], high[2];
    bar_scene_corner(&scene, square, 1, low); /* +X is to the left */
    bar_scene_corner(&scene, square, 3, high);
    for (int v = (int)high[1] + 5; v > (int)low[1] - 5; --v) {
        for (int u = (int)low[0] - 2; u < (int)high[0] + 3; ++u) {
            uint8_t *const at = &picture[v * BAR_SCENE_WIDTH + u];
            *at = (uint8_t)((1 - px) * at[0] + px * at[-BAR_SCENE_WIDTH] + 0.5);
        }
    }
}

static void a_square_is_found_though_two_sides_are_no_good_to_measure_by(void)
{
    bar_render8(&scene, picture);
    displace_ends(16, 0.35);

    detect_in(NULL, NULL);

    uint32_t count;
    const opms_edge_t *const edges = opms_bar_edges(detector, &count);
    unsigned sides = 0;
    for (uint32_t i = 0; i < count; ++i) {
        sides |= edges[i].square == 16 ? 1u << edges[i].side : 0;
    }
    TEST_ASSERT_EQUAL_HEX(0x5, sides);
    assert_located(0, 32);
    TEST_ASSERT_TRUE(was_found(16));
}

static void a_bar_that_the_border_cuts_is_located(void)
{
    bar_scene_roll(&scene, 0.6);
    scene.bar_camera.t_m[0] += 0.14; /* it leaves the picture through the left side, obliquely */

    render_and_detect();

    assert_located(0, 32);
    int cut = 0;
    for (int k = 0; k < 33; ++k) {
        cut += bar_scene_sees(&scene, k, -20.0) && !bar_scene_sees(&scene, k, 0.0);
    }
    TEST_ASSERT_GREATER_THAN_INT(0, cut);
}

static void twelve_bits_and_a_stride_give_the_same(void)
{
    render_and_detect();
    const opms_pose_result_t first = solve();
    const size_t stride_px = BAR_SCENE_WIDTH + 13;
    uint16_t *deep = calloc(stride_px * BAR_SCENE_HEIGHT, sizeof *deep);
    TEST_ASSERT_NOT_NULL(deep);
    for (size_t i = 0; i < BAR_SCENE_PIXELS; ++i) {
        deep[i / BAR_SCENE_WIDTH * stride_px + i % BAR_SCENE_WIDTH] = (uint16_t)(16 * picture[i]);
    }
    image = (opms_image_t){
        deep, BAR_SCENE_WIDTH, BAR_SCENE_HEIGHT, (ptrdiff_t)(2 * stride_px), OPMS_PIXEL_GREY16,
        4095};

    detect_in(NULL, NULL);

    free(deep);
    assert_located(0, 32);
    const opms_pose_result_t second = solve();
    TEST_ASSERT_DOUBLE_WITHIN(
        5e-6, 0.0, distance_m(first.bar_camera.transform.t_m, second.bar_camera.transform.t_m));
}

static void a_picture_of_twelve_bits_is_located(void)
{
    static uint16_t deep[BAR_SCENE_PIXELS];
    scene.black = 600.0;
    scene.white = 3000.0;
    scene.ground = 1700.0;
    scene.noise = 25.0;
    scene.top = 4095.0;
    bar_render16(&scene, deep);
    image = (opms_image_t){
        deep, BAR_SCENE_WIDTH, BAR_SCENE_HEIGHT, 2 * BAR_SCENE_WIDTH, OPMS_PIXEL_GREY16, 4095};

    detect_in(NULL, NULL);

    assert_located(0, 32);
    TEST_ASSERT_DOUBLE_WITHIN(80.0, 2400.0, summary.contrast);
    TEST_ASSERT_DOUBLE_WITHIN(4.0, 25.0, summary.noise);
}

static void a_region_is_searched_and_nothing_else(void)
{
    double from[2], to[2];
    bar_scene_corner(&scene, 13, 1, from); /* image right is ahead, -X */
    bar_scene_corner(&scene, 19, 3, to);
    opms_roi_t roi = {(int32_t)from[0] - 40, (int32_t)from[1] - 20, (int32_t)(to[0] - from[0]) + 80,
                      (int32_t)(to[1] - from[1]) + 40};
    bar_render8(&scene, picture);

    detect_in(&roi, NULL);

    assert_located(13, 19);
    TEST_ASSERT_FALSE(was_found(11));

    roi = (opms_roi_t){0, 0, (int32_t)from[0] - 60, BAR_SCENE_HEIGHT};
    TEST_ASSERT_GREATER_THAN_INT32(60, roi.width_px);
    detect_in(&roi, NULL);
    TEST_ASSERT_EQUAL(OPMS_BAR_ABSENT, summary.state);

    roi = (opms_roi_t){7, 9, 0, 0};
    detect_in(&roi, NULL);
    assert_located(0, 32);
}

static void saturated_white_keeps_labels_and_places(void)
{
    for (int i = 0; i < 3; ++i) {
        scene.white = 300.0 + 150.0 * i;
        scene.seed = (uint64_t)(60 + i);

        render_and_detect();

        TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, summary.state);
        assert_squares_are_true(0.12);
        TEST_ASSERT_TRUE(summary.white_fraction_saturated > 0.3);
    }
}

/** The scene in the middle of an exposure in which the camera moves by (x, y), along X and Y of the
 * bar; levels add up before they are cut. */
static void render_moving(double x_m, double y_m)
{
    enum { STEPS = 10 };
    static uint16_t levels[BAR_SCENE_PIXELS];
    static uint32_t sums[BAR_SCENE_PIXELS];
    memset(sums, 0, sizeof sums);
    for (int step = 0; step < STEPS; ++step) {
        bar_scene_t now = scene;
        const double part = (step + 0.5) / STEPS - 0.5;
        now.bar_camera.t_m[0] += part * x_m;
        now.bar_camera.t_m[1] += part * y_m;
        now.seed = scene.seed + (uint64_t)step;
        now.noise = scene.noise * sqrt(STEPS);
        now.top = 65535;
        bar_render16(&now, levels);
        for (int i = 0; i < BAR_SCENE_PIXELS; ++i) {
            sums[i] += levels[i];
        }
    }
    for (int i = 0; i < BAR_SCENE_PIXELS; ++i) {
        const uint32_t level = (sums[i] + STEPS / 2) / STEPS;
        picture[i] = (uint8_t)(level > 255 ? 255 : level);
    }
}

static void motion_under_saturated_white_keeps_labels_and_places(void)
{
    static const double white[3] = {190, 330, 480};
    for (int i = 0; i < 3; ++i) {
        scene.white = white[i];
        scene.seed = (uint64_t)(70 + 100 * i);

        render_moving(0.0006, 0.0048);
        detect_in(NULL, NULL);

        TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, summary.state);
        TEST_ASSERT_TRUE(summary.blur_px[1] > 1.3 * summary.blur_px[0]);
        assert_squares_are_true(0.15);
    }
}

/** So little is left of the profiles that their shape is a guess: no answer then, rather than one
 * that is some pixels wrong. */
static void white_far_above_saturation_is_unsure(void)
{
    static const double moves_m[2] = {0, 0.0048};
    int unsure = 0;
    for (int i = 0; i < 8; ++i) {
        scene.white = 1200.0 * (1 + i / 2);
        scene.seed = (uint64_t)(170 + 100 * i);

        render_moving(0, moves_m[i % 2]);
        detect_in(NULL, NULL);

        if (summary.state == OPMS_BAR_LOCATED) {
            assert_squares_are_true(0.3);
        }
        unsure += summary.state == OPMS_BAR_AMBIGUOUS;
    }
    TEST_ASSERT_GREATER_THAN_INT(4, unsure);
}

static void a_bar_in_the_shade_is_located(void)
{
    scene.black = 12.0;
    scene.white = 42.0;
    scene.ground = 160.0;
    scene.noise = 1.5;

    render_and_detect();

    assert_located(0, 32);
}

static void the_same_call_twice_gives_the_same_bits(void)
{
    static opms_edge_t edges[OPMS_BAR_EDGES_MAX];
    static opms_square_t squares[OPMS_BAR_SQUARES];
    static uint8_t grey[BAR_SCENE_PIXELS];
    render_and_detect();
    const opms_bar_summary_t before = summary;
    memcpy(edges, opms_bar_edges(detector, NULL), summary.edge_count * sizeof *edges);
    memcpy(squares, opms_bar_squares(detector, NULL), summary.square_count * sizeof *squares);
    TEST_ASSERT_GREATER_THAN_UINT32(0, summary.edge_count);

    image.pixels = grey;
    detect_in(NULL, NULL);
    TEST_ASSERT_EQUAL(OPMS_BAR_ABSENT, summary.state);
    TEST_ASSERT_EQUAL_UINT32(0, summary.edge_count);
    image.pixels = picture;
    detect_in(NULL, NULL);

    TEST_ASSERT_EQUAL_MEMORY(&before, &summary, sizeof before);
    TEST_ASSERT_EQUAL_MEMORY(edges, opms_bar_edges(detector, NULL),
                             summary.edge_count * sizeof *edges);
    TEST_ASSERT_EQUAL_MEMORY(squares, opms_bar_squares(detector, NULL),
                             summary.square_count * sizeof *squares);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(all_squares_in_the_picture_are_found_and_labelled);
    RUN_TEST(the_bar_is_read_in_every_direction);
    RUN_TEST(edges_lie_as_near_the_truth_as_they_say);
    RUN_TEST(normals_point_out_of_the_square);
    RUN_TEST(the_summary_tells_blur_contrast_and_noise);
    RUN_TEST(three_squares_are_enough_and_two_are_not);
    RUN_TEST(a_covered_square_does_not_stop_the_row);
    RUN_TEST(a_square_is_found_though_two_sides_are_no_good_to_measure_by);
    RUN_TEST(a_bar_that_the_border_cuts_is_located);
    RUN_TEST(twelve_bits_and_a_stride_give_the_same);
    RUN_TEST(a_picture_of_twelve_bits_is_located);
    RUN_TEST(a_region_is_searched_and_nothing_else);
    RUN_TEST(saturated_white_keeps_labels_and_places);
    RUN_TEST(motion_under_saturated_white_keeps_labels_and_places);
    RUN_TEST(white_far_above_saturation_is_unsure);
    RUN_TEST(a_bar_in_the_shade_is_located);
    RUN_TEST(the_same_call_twice_gives_the_same_bits);
    return UNITY_END();
}
