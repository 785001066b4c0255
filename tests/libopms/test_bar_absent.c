/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Pictures of what is no bar, or not enough of one: never located. */
#include <math.h>
#include <string.h>

#include <unity.h>

#include <opms/bar.h>

#include "bar_scene.h"
#include "truth_project.h"

#define WIDTH BAR_SCENE_WIDTH
#define HEIGHT BAR_SCENE_HEIGHT

static uint8_t picture[BAR_SCENE_PIXELS];
static bar_scene_t scene;
static opms_bar_detector_t *detector;
static opms_bar_summary_t summary;

void setUp(void)
{
    scene = bar_scene();
    TEST_ASSERT_EQUAL(OPMS_OK, opms_bar_detector_create(&scene.lens, NULL, &detector, NULL));
}

void tearDown(void)
{
    opms_bar_detector_destroy(detector);
    detector = NULL;
}

static void detect(void)
{
    const opms_image_t image = {picture, WIDTH, HEIGHT, WIDTH, OPMS_PIXEL_GREY8, 0};
    TEST_ASSERT_EQUAL(OPMS_OK, opms_bar_detect(detector, &image, NULL, NULL, &summary, NULL));
}

static void assert_not_located(void)
{
    uint32_t squares = 1, edges = 1;
    detect();
    TEST_ASSERT_NOT_EQUAL(OPMS_BAR_LOCATED, summary.state);
    opms_bar_squares(detector, &squares);
    opms_bar_edges(detector, &edges);
    TEST_ASSERT_EQUAL_UINT32(0, squares);
    TEST_ASSERT_EQUAL_UINT32(0, edges);
    TEST_ASSERT_EQUAL_UINT32(0, summary.square_count);
    TEST_ASSERT_EQUAL_UINT32(0, summary.edge_count);
}

static void assert_absent(void)
{
    assert_not_located();
    TEST_ASSERT_EQUAL(OPMS_BAR_ABSENT, summary.state);
}

static uint8_t grey(double level)
{
    return (uint8_t)(level < 0.0 ? 0.0 : level > 255.0 ? 255.0 : level);
}

static void plain_pictures_are_absent(void)
{
    const int levels[] = {0, 128, 255};
    for (int i = 0; i < 3; ++i) {
        memset(picture, levels[i], sizeof picture);
        assert_absent();
    }
}

static void noise_is_absent(void)
{
    uint64_t random = 5;
    for (int i = 0; i < BAR_SCENE_PIXELS; ++i) {
        picture[i] = (uint8_t)truth_uniform(&random, 0.0, 256.0);
    }
    assert_absent();
    for (int i = 0; i < BAR_SCENE_PIXELS; ++i) {
        picture[i] = grey(128.0 + 25.0 * truth_gauss(&random));
    }
    assert_absent();
}

static void gradients_are_absent(void)
{
    for (int i = 0; i < BAR_SCENE_PIXELS; ++i) {
        picture[i] = grey(255.0 * (i % WIDTH) / WIDTH);
    }
    assert_absent();
    for (int i = 0; i < BAR_SCENE_PIXELS; ++i) {
        picture[i] = grey(127.0 + 120.0 * sin(0.02 * (i % WIDTH)) * cos(0.03 * (i / WIDTH)));
    }
    assert_absent();
}

/** A pattern of period `period_px`, turned by an angle. */
static void draw_chessboard(double period_px, double angle_rad, int stripes)
{
    const double c = cos(angle_rad), s = sin(angle_rad);
    uint64_t random = 9;
    for (int i = 0; i < BAR_SCENE_PIXELS; ++i) {
        const double x = (c * (i % WIDTH) + s * (i / WIDTH)) / period_px;
        const double y = (c * (i / WIDTH) - s * (i % WIDTH)) / period_px;
        const int dark = ((int)floor(x) + (stripes ? 0 : (int)floor(y))) & 1;
        picture[i] = grey((dark ? 40.0 : 190.0) + 2.0 * truth_gauss(&random));
    }
}

static void chessboards_are_absent(void)
{
    for (int i = 0; i < 6; ++i) {
        draw_chessboard(10.0 + 7.0 * i, 0.3 * i, 0);
        assert_absent();
    }
}

static void stripes_are_absent(void)
{
    for (int i = 0; i < 6; ++i) {
        draw_chessboard(8.0 + 6.0 * i, 0.52 * i, 1);
        assert_absent();
    }
}

/** Dark squares in rows and columns, as windows of a house are. */
static void a_lattice_of_squares_is_not_located(void)
{
    for (int size = 12; size <= 24; size += 6) {
        uint64_t random = 11;
        for (int i = 0; i < BAR_SCENE_PIXELS; ++i) {
            const int dark = i % WIDTH % (size * 3 / 2) < size && i / WIDTH % (size * 3 / 2) < size;
            picture[i] = grey((dark ? 40.0 : 190.0) + 2.0 * truth_gauss(&random));
        }
        assert_not_located();
    }
}

/** Rows of dark rectangles of all sizes, as a printed page has them. */
static void draw_page(uint64_t seed)
{
    uint64_t random = seed;
    memset(picture, 200, sizeof picture);
    const int line = (int)truth_uniform(&random, 14.0, 40.0);
    for (int top = 4; top + line < HEIGHT; top += line) {
        int left = 4;
        for (;;) {
            const int high = (int)(line * truth_uniform(&random, 0.3, 0.85));
            const int wide = (int)(line * truth_uniform(&random, 0.2, 1.0));
            if (left + wide + 4 > WIDTH) {
                break;
            }
            const int level = (int)truth_uniform(&random, 10.0, 90.0);
            for (int y = top; y < top + high; ++y) {
                memset(picture + y * WIDTH + left, level, (size_t)wide);
            }
            left += wide + (int)(line * truth_uniform(&random, 0.1, 0.5));
        }
    }
}

static void printed_pages_are_not_located(void)
{
    for (uint64_t seed = 1; seed <= 10; ++seed) {
        draw_page(seed);
        assert_not_located();
    }
}

static void a_film_strip_is_not_located(void)
{
    for (int i = 0; i < 4; ++i) {
        scene = bar_scene();
        memset(scene.codes, 0, sizeof scene.codes);
        bar_scene_roll(&scene, 0.5 * i);
        bar_render8(&scene, picture);
        assert_not_located();
    }
}

static void a_bar_with_every_cell_black_is_not_located(void)
{
    for (int k = 0; k < BAR_SCENE_SQUARES; ++k) {
        scene.codes[k] = 63;
    }
    bar_render8(&scene, picture);
    assert_not_located();
}

static void a_bar_with_other_codes_is_not_located(void)
{
    uint64_t random = 77;
    for (int i = 0; i < 6; ++i) {
        for (int k = 0; k < BAR_SCENE_SQUARES; ++k) {
            scene.codes[k] = (int)truth_uniform(&random, 0.0, 64.0);
        }
        bar_render8(&scene, picture);
        assert_not_located();
    }
}

static void a_mirrored_bar_is_not_located(void)
{
    bar_render8(&scene, picture);
    for (int i = 0; i < HEIGHT; ++i) {
        uint8_t *row = picture + i * WIDTH;
        for (int k = 0; k < WIDTH / 2; ++k) {
            const uint8_t left = row[k];
            row[k] = row[WIDTH - 1 - k];
            row[WIDTH - 1 - k] = left;
        }
    }
    assert_not_located();
}

static void a_negative_of_the_bar_is_not_located(void)
{
    bar_render8(&scene, picture);
    for (int i = 0; i < BAR_SCENE_PIXELS; ++i) {
        picture[i] = (uint8_t)(255 - picture[i]);
    }
    assert_not_located();
}

static void a_bar_without_contrast_is_not_located(void)
{
    scene.black = 100.0;
    scene.white = 103.0;
    bar_render8(&scene, picture);
    assert_not_located();
}

static void the_smallest_pictures_are_absent(void)
{
    for (int side = 1; side <= 40; side += 3) {
        const opms_lens_t lens = {side, side, side, side, 0.5 * side, 0.5 * side, 0, 0, 0, 0};
        const opms_image_t image = {picture, side, side, side, OPMS_PIXEL_GREY8, 0};
        opms_bar_detector_t *small = NULL;
        draw_chessboard(5.0, 0.1, 0);
        TEST_ASSERT_EQUAL(OPMS_OK, opms_bar_detector_create(&lens, NULL, &small, NULL));
        TEST_ASSERT_EQUAL(OPMS_OK, opms_bar_detect(small, &image, NULL, NULL, &summary, NULL));
        TEST_ASSERT_EQUAL(OPMS_BAR_ABSENT, summary.state);
        opms_bar_detector_destroy(small);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(plain_pictures_are_absent);
    RUN_TEST(noise_is_absent);
    RUN_TEST(gradients_are_absent);
    RUN_TEST(chessboards_are_absent);
    RUN_TEST(stripes_are_absent);
    RUN_TEST(a_lattice_of_squares_is_not_located);
    RUN_TEST(printed_pages_are_not_located);
    RUN_TEST(a_film_strip_is_not_located);
    RUN_TEST(a_bar_with_every_cell_black_is_not_located);
    RUN_TEST(a_bar_with_other_codes_is_not_located);
    RUN_TEST(a_mirrored_bar_is_not_located);
    RUN_TEST(a_negative_of_the_bar_is_not_located);
    RUN_TEST(a_bar_without_contrast_is_not_located);
    RUN_TEST(the_smallest_pictures_are_absent);
    return UNITY_END();
}
