/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <unity.h>

#include <opms/apriltag.h>
#include <opms/pose.h>

#include "apriltag_scene.h"
#include "truth_project.h"

#define WIDTH 1024
#define HEIGHT 768

static uint8_t picture[WIDTH * HEIGHT];
static apriltag_scene_t scene;
static opms_image_t image;
static opms_apriltag_detector_t *detector;
static opms_bar_summary_t summary;

void setUp(void)
{
    scene = apriltag_scene();
    image = (opms_image_t){picture, WIDTH, HEIGHT, WIDTH, OPMS_PIXEL_GREY8, 0};
    memset(&summary, 0, sizeof summary);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_apriltag_detector_create(&scene.lens, NULL, &detector, NULL));
}

void tearDown(void)
{
    opms_apriltag_detector_destroy(detector);
    detector = NULL;
}

static void render_and_detect(void)
{
    opms_error_t err;
    apriltag_render(&scene, picture);
    TEST_ASSERT_EQUAL_MESSAGE(
        OPMS_OK, opms_apriltag_detect(detector, &image, &summary, &err), err.message);
}

/** Turn the camera about its optical axis. */
static void roll(double angle_rad)
{
    const double w[3] = {0.0, 0.0, angle_rad};
    double turn[9], R[9];
    truth_rotation(w, turn);
    truth_multiply(scene.bar_camera.R, turn, R);
    memcpy(scene.bar_camera.R, R, sizeof R);
}

static opms_pose_result_t solve(void)
{
    uint32_t count;
    const opms_edge_t *edges = opms_apriltag_edges(detector, &count);
    opms_pose_result_t result;
    TEST_ASSERT_EQUAL_UINT32(summary.edge_count, count);
    TEST_ASSERT_EQUAL(OPMS_OK,
                      opms_pose_solve(&scene.lens, edges, count, NULL, &result, NULL));
    TEST_ASSERT_EQUAL(OPMS_POSE_FOUND, result.state);
    return result;
}

static double position_error_m(const opms_pose_result_t *result)
{
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
        sum += pow(result->bar_camera.transform.t_m[i] - scene.bar_camera.t_m[i], 2.0);
    }
    return sqrt(sum);
}

static double position_sigma_m(const opms_pose_result_t *result)
{
    const double *c = result->bar_camera.covariance;
    return sqrt(c[3 * 7] + c[4 * 7] + c[5 * 7]);
}

static void assert_squares_are_the_true_ones(void)
{
    uint32_t count;
    const opms_square_t *squares = opms_apriltag_squares(detector, &count);
    TEST_ASSERT_EQUAL_UINT32(summary.square_count, count);
    for (uint32_t i = 0; i < count; ++i) {
        TEST_ASSERT_TRUE(i == 0 || squares[i].index > squares[i - 1].index);
        for (int c = 0; c < 4; ++c) {
            const double bar_m[3] = {c == 0 || c == 3 ? -0.010 : 0.010,
                                     (squares[i].index - 16) * 0.030 + (c < 2 ? -0.010 : 0.010),
                                     0.0};
            double px[2];
            truth_project(&scene.lens, &scene.bar_camera, bar_m, px);
            TEST_ASSERT_DOUBLE_WITHIN(0.15, px[0], squares[i].corners_px[c][0]);
            TEST_ASSERT_DOUBLE_WITHIN(0.15, px[1], squares[i].corners_px[c][1]);
        }
    }
}

static void the_pose_of_a_rendered_bar_is_the_true_one(void)
{
    double squares_of_errors = 0.0, squares_of_sigmas = 0.0;
    for (int i = 0; i < 6; ++i) {
        scene = apriltag_scene();
        scene.seed = (uint64_t)(7 + i);
        scene.bar_camera.t_m[1] = -0.25 + 0.09 * i;
        roll(1.1 * i);

        render_and_detect();

        TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, summary.state);
        TEST_ASSERT_GREATER_OR_EQUAL_UINT32(6, summary.square_count);
        assert_squares_are_the_true_ones();
        const opms_pose_result_t result = solve();
        squares_of_errors += pow(position_error_m(&result), 2.0);
        squares_of_sigmas += pow(position_sigma_m(&result), 2.0);
        TEST_ASSERT_TRUE(position_error_m(&result) < 0.0005);
    }
    /* Three degrees of freedom, six pictures: a ratio above 2 would be one in a thousand. */
    TEST_ASSERT_TRUE(sqrt(squares_of_errors) < 2.0 * sqrt(squares_of_sigmas));
}

static void the_summary_tells_blur_contrast_and_noise(void)
{
    render_and_detect();

    TEST_ASSERT_DOUBLE_WITHIN(5.0, scene.white - scene.black, summary.contrast);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, hypot(scene.blur_px, sqrt(1.0 / 12.0)), summary.blur_px[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, hypot(scene.blur_px, sqrt(1.0 / 12.0)), summary.blur_px[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1.5, scene.noise, summary.noise);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, summary.white_fraction_saturated);
    TEST_ASSERT_TRUE(summary.label_margin > 20.0);
}

static void sixteen_bits_and_a_stride_change_nothing(void)
{
    render_and_detect();
    const opms_pose_result_t first = solve();
    const size_t stride_px = WIDTH + 13;
    uint16_t *deep = calloc(stride_px * HEIGHT, sizeof *deep);
    for (size_t i = 0; i < WIDTH * HEIGHT; ++i) {
        deep[i / WIDTH * stride_px + i % WIDTH] = (uint16_t)(16 * picture[i]);
    }
    image = (opms_image_t){deep,  WIDTH, HEIGHT, (ptrdiff_t)(2 * stride_px), OPMS_PIXEL_GREY16,
                           4080};

    TEST_ASSERT_EQUAL(OPMS_OK, opms_apriltag_detect(detector, &image, &summary, NULL));

    TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, summary.state);
    const opms_pose_result_t second = solve();
    for (int i = 0; i < 3; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(2e-6, first.bar_camera.transform.t_m[i],
                                  second.bar_camera.transform.t_m[i]);
    }
    free(deep);
}

static void a_decimated_search_measures_in_all_pixels(void)
{
    opms_apriltag_options_t options;
    opms_apriltag_options_init(&options);
    options.decimate = 2;
    tearDown();
    TEST_ASSERT_EQUAL(OPMS_OK,
                      opms_apriltag_detector_create(&scene.lens, &options, &detector, NULL));
    scene.bar_camera.t_m[2] = 0.3; /* near, so that a cell has 3 px in every second pixel, too */
    scene.bar_camera.t_m[0] = 0.09;

    render_and_detect();

    TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, summary.state);
    const opms_pose_result_t result = solve();
    TEST_ASSERT_TRUE(position_error_m(&result) < 0.0004);
}

static void a_tag_with_a_wrong_id_is_left_out(void)
{
    scene.wrong_at = 16;
    scene.wrong_id = 14; /* twice in the picture, then */

    render_and_detect();

    TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, summary.state);
    assert_squares_are_the_true_ones();
    uint32_t count;
    const opms_square_t *squares = opms_apriltag_squares(detector, &count);
    for (uint32_t i = 0; i < count; ++i) {
        TEST_ASSERT_NOT_EQUAL(16, squares[i].index);
    }
}

static void a_tag_that_no_bar_has_is_left_out(void)
{
    scene.wrong_at = 16;
    scene.wrong_id = 100;

    render_and_detect();

    TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, summary.state);
    assert_squares_are_the_true_ones();
}

static void two_tags_are_enough_and_one_is_ambiguous(void)
{
    scene.first = 16;
    scene.last = 17;
    render_and_detect();
    TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, summary.state);
    TEST_ASSERT_EQUAL_UINT32(2, summary.square_count);
    const opms_pose_result_t result = solve();
    TEST_ASSERT_TRUE(position_error_m(&result) < 0.03);

    scene.last = 16;
    render_and_detect();
    TEST_ASSERT_EQUAL(OPMS_BAR_AMBIGUOUS, summary.state);
    TEST_ASSERT_EQUAL_UINT32(0, summary.square_count);
    TEST_ASSERT_EQUAL_UINT32(0, summary.edge_count);
}

static void two_tags_that_contradict_each_other_are_ambiguous(void)
{
    scene.first = 16;
    scene.last = 17;
    scene.wrong_at = 17;
    scene.wrong_id = 25;
    render_and_detect();
    TEST_ASSERT_EQUAL(OPMS_BAR_AMBIGUOUS, summary.state);
}

static void noise_grey_and_a_white_bar_are_absent(void)
{
    uint64_t random = 5;
    for (size_t i = 0; i < sizeof picture; ++i) {
        picture[i] = (uint8_t)truth_uniform(&random, 0.0, 256.0);
    }
    TEST_ASSERT_EQUAL(OPMS_OK, opms_apriltag_detect(detector, &image, &summary, NULL));
    TEST_ASSERT_EQUAL(OPMS_BAR_ABSENT, summary.state);

    memset(picture, 128, sizeof picture);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_apriltag_detect(detector, &image, &summary, NULL));
    TEST_ASSERT_EQUAL(OPMS_BAR_ABSENT, summary.state);

    scene.first = 1;
    scene.last = 0;
    render_and_detect();
    TEST_ASSERT_EQUAL(OPMS_BAR_ABSENT, summary.state);
    uint32_t count = 1;
    opms_apriltag_edges(detector, &count);
    TEST_ASSERT_EQUAL_UINT32(0, count);
}

static void the_smallest_pictures_are_absent(void)
{
    for (int side = 1; side <= 40; side += 3) {
        opms_lens_t lens = {side, side, side, side, 0.5 * side, 0.5 * side, 0, 0, 0, 0};
        opms_apriltag_detector_t *small = NULL;
        TEST_ASSERT_EQUAL(OPMS_OK, opms_apriltag_detector_create(&lens, NULL, &small, NULL));
        image = (opms_image_t){picture, side, side, side, OPMS_PIXEL_GREY8, 0};
        TEST_ASSERT_EQUAL(OPMS_OK, opms_apriltag_detect(small, &image, &summary, NULL));
        TEST_ASSERT_EQUAL(OPMS_BAR_ABSENT, summary.state);
        opms_apriltag_detector_destroy(small);
    }
}

static void assert_refused(const opms_image_t *bad, const char *named)
{
    opms_error_t err = {OPMS_OK, 0, "", ""};
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_apriltag_detect(detector, bad, &summary, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, err.code);
    TEST_ASSERT_EQUAL_STRING("apriltag", err.stage);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(err.message, named), err.message);
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_apriltag_detect(detector, bad, &summary, NULL));
}

static void bad_pictures_are_refused_by_name(void)
{
    assert_refused(NULL, "image");
    opms_image_t bad = image;
    bad.pixels = NULL;
    assert_refused(&bad, "pixels");
    bad = image;
    bad.width_px = WIDTH - 1;
    assert_refused(&bad, "1023 x 768");
    bad = image;
    bad.stride_bytes = WIDTH - 1;
    assert_refused(&bad, "stride");
    bad = image;
    bad.stride_bytes = -WIDTH;
    assert_refused(&bad, "stride");
    bad = image;
    bad.format = (opms_pixel_format_t)7;
    assert_refused(&bad, "format");
    bad = image;
    bad.format = OPMS_PIXEL_GREY16;
    bad.stride_bytes = 2 * WIDTH + 1;
    assert_refused(&bad, "aligned");
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_apriltag_detect(NULL, &image, &summary, NULL));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_apriltag_detect(detector, &image, NULL, NULL));
}

static void bad_options_and_lenses_are_refused(void)
{
    opms_apriltag_detector_t *none = NULL;
    opms_apriltag_options_t options;
    opms_apriltag_options_init(&options);
    options.decimate = 0;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG,
                      opms_apriltag_detector_create(&scene.lens, &options, &none, NULL));
    opms_apriltag_options_init(&options);
    options.struct_size = 0;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG,
                      opms_apriltag_detector_create(&scene.lens, &options, &none, NULL));
    opms_lens_t lens = scene.lens;
    lens.k1 = NAN;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_apriltag_detector_create(&lens, NULL, &none, NULL));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_apriltag_detector_create(NULL, NULL, &none, NULL));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG,
                      opms_apriltag_detector_create(&scene.lens, NULL, NULL, NULL));
    TEST_ASSERT_NULL(none);
    opms_apriltag_detector_destroy(NULL);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_pose_of_a_rendered_bar_is_the_true_one);
    RUN_TEST(the_summary_tells_blur_contrast_and_noise);
    RUN_TEST(sixteen_bits_and_a_stride_change_nothing);
    RUN_TEST(a_decimated_search_measures_in_all_pixels);
    RUN_TEST(a_tag_with_a_wrong_id_is_left_out);
    RUN_TEST(a_tag_that_no_bar_has_is_left_out);
    RUN_TEST(two_tags_are_enough_and_one_is_ambiguous);
    RUN_TEST(two_tags_that_contradict_each_other_are_ambiguous);
    RUN_TEST(noise_grey_and_a_white_bar_are_absent);
    RUN_TEST(the_smallest_pictures_are_absent);
    RUN_TEST(bad_pictures_are_refused_by_name);
    RUN_TEST(bad_options_and_lenses_are_refused);
    return UNITY_END();
}
