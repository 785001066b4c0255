/* SPDX-License-Identifier: Apache-2.0 */
/* The light on the bar, on pictures drawn with known levels. */
#include <math.h>
#include <string.h>

#include <unity.h>

#include <opms/exposure.h>

#include "../bar_scene.h"

static bar_scene_t scene;
static uint8_t pixels[BAR_SCENE_PIXELS];
static uint16_t wide[BAR_SCENE_PIXELS];
static opms_square_t squares[OPMS_BAR_SQUARES];
static uint32_t count;
static opms_exposure_light_t light;
static opms_error_t err;

void setUp(void)
{
    scene = bar_scene();
    TEST_ASSERT_EQUAL(OPMS_OK, opms_exposure_expect(&scene.lens, &scene.bar_camera, squares,
                                                    &count, &err));
}

void tearDown(void)
{
}

static opms_image_t image8(void)
{
    bar_render8(&scene, pixels);
    const opms_image_t image = {pixels, BAR_SCENE_WIDTH, BAR_SCENE_HEIGHT, BAR_SCENE_WIDTH,
                                OPMS_PIXEL_GREY8, 0};
    return image;
}

static void measure(const opms_image_t *image)
{
    TEST_ASSERT_EQUAL(OPMS_OK, opms_exposure_measure(image, squares, count, &light, &err));
}

static void squares_are_expected_where_they_are_seen(void)
{
    uint32_t seen = 0;
    for (int k = 0; k < BAR_SCENE_SQUARES; ++k) {
        seen += (uint32_t)bar_scene_sees(&scene, k, 0.0);
    }
    TEST_ASSERT_TRUE(seen > 10);
    TEST_ASSERT_EQUAL_UINT32(seen, count);
    for (uint32_t i = 0; i < count; ++i) {
        for (int c = 0; c < 4; ++c) {
            double px[2];
            bar_scene_corner(&scene, squares[i].index, c, px);
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, px[0], squares[i].corners_px[c][0]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, px[1], squares[i].corners_px[c][1]);
        }
    }
}

static void the_levels_of_the_bar_are_measured(void)
{
    const opms_image_t image = image8();
    measure(&image);
    TEST_ASSERT_EQUAL_UINT32(count, light.squares);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 190.0 / 255.0, light.white);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 40.0 / 255.0, light.black);
    TEST_ASSERT_TRUE(light.white_high >= light.white && light.white_high < 0.79);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, light.saturated);
}

static void bright_ground_around_the_bar_does_not_count(void)
{
    scene.ground = 255.0;
    const opms_image_t image = image8();
    measure(&image);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 190.0 / 255.0, light.white);
    TEST_ASSERT_TRUE(light.saturated < 0.02);
}

static void saturated_white_is_counted(void)
{
    scene.white = 400.0;
    scene.black = 90.0;
    const opms_image_t image = image8();
    measure(&image);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, light.white);
    TEST_ASSERT_TRUE(light.saturated > 0.9);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 90.0 / 255.0, light.black);
}

static void twelve_bit_pictures_count_by_their_white_level(void)
{
    scene.black = 600.0;
    scene.white = 3000.0;
    scene.ground = 1500.0;
    scene.top = 4095.0;
    bar_render16(&scene, wide);
    const opms_image_t image = {wide, BAR_SCENE_WIDTH, BAR_SCENE_HEIGHT, 2 * BAR_SCENE_WIDTH,
                                OPMS_PIXEL_GREY16, 4095};
    measure(&image);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 3000.0 / 4095.0, light.white);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 600.0 / 4095.0, light.black);
}

static void without_a_bar_the_picture_is_measured(void)
{
    memset(pixels, 51, sizeof pixels);
    opms_image_t image = {pixels, BAR_SCENE_WIDTH, BAR_SCENE_HEIGHT, BAR_SCENE_WIDTH,
                          OPMS_PIXEL_GREY8, 0};
    count = 0;
    measure(&image);
    TEST_ASSERT_EQUAL_UINT32(0, light.squares);
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 0.2, light.picture_white);
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 0.2, light.picture_black);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, light.white);
    memset(pixels, 255, sizeof pixels);
    measure(&image);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, light.picture_black);
}

static void squares_outside_of_the_picture_are_left_out(void)
{
    const opms_image_t image = image8();
    opms_square_t far = squares[0];
    for (int c = 0; c < 4; ++c) {
        far.corners_px[c][0] += 1e6;
    }
    squares[0].corners_px[0][0] = NAN;
    squares[1] = far;
    measure(&image);
    TEST_ASSERT_EQUAL_UINT32(count - 2, light.squares);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_exposure_measure(&image, &far, 1, &light, &err));
    TEST_ASSERT_EQUAL_UINT32(0, light.squares);
}

static void a_bar_behind_the_camera_is_not_expected(void)
{
    scene.bar_camera.t_m[2] = -scene.bar_camera.t_m[2];
    TEST_ASSERT_EQUAL(OPMS_OK, opms_exposure_expect(&scene.lens, &scene.bar_camera, squares,
                                                    &count, &err));
    TEST_ASSERT_EQUAL_UINT32(0, count);
}

static void bad_calls_say_what_is_wrong(void)
{
    opms_image_t image = image8();
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_exposure_measure(NULL, squares, 1, &light, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_exposure_measure(&image, NULL, 1, &light, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_exposure_measure(&image, squares, 1, NULL, &err));
    image.stride_bytes = 3;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_exposure_measure(&image, squares, 1, &light, &err));
    image.width_px = 0;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_exposure_measure(&image, squares, 1, &light, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG,
                      opms_exposure_expect(&scene.lens, NULL, squares, &count, &err));
    scene.lens.fx_px = NAN;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_exposure_expect(&scene.lens, &scene.bar_camera, squares,
                                                         &count, &err));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(squares_are_expected_where_they_are_seen);
    RUN_TEST(the_levels_of_the_bar_are_measured);
    RUN_TEST(bright_ground_around_the_bar_does_not_count);
    RUN_TEST(saturated_white_is_counted);
    RUN_TEST(twelve_bit_pictures_count_by_their_white_level);
    RUN_TEST(without_a_bar_the_picture_is_measured);
    RUN_TEST(squares_outside_of_the_picture_are_left_out);
    RUN_TEST(a_bar_behind_the_camera_is_not_expected);
    RUN_TEST(bad_calls_say_what_is_wrong);
    return UNITY_END();
}
