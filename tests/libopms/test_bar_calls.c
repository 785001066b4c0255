/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the calls of the bar stage refuse, and how they use memory. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <unity.h>

#include <opms/bar.h>

#include "bar_scene.h"
#include "counting_allocator.h"

#define WIDTH BAR_SCENE_WIDTH
#define HEIGHT BAR_SCENE_HEIGHT

static uint16_t picture[BAR_SCENE_PIXELS + 1];
static bar_scene_t scene;
static opms_image_t image;
static opms_bar_detector_t *detector;
static opms_bar_summary_t summary;

void setUp(void)
{
    scene = bar_scene();
    image = (opms_image_t){picture, WIDTH, HEIGHT, WIDTH, OPMS_PIXEL_GREY8, 0};
    TEST_ASSERT_EQUAL(OPMS_OK, opms_bar_detector_create(&scene.lens, NULL, &detector, NULL));
}

void tearDown(void)
{
    opms_bar_detector_destroy(detector);
    detector = NULL;
}

static void assert_refused(const opms_image_t *bad, const opms_roi_t *roi,
                           const opms_transform_t *hint, const char *named)
{
    opms_error_t err = {OPMS_OK, 0, "", ""};
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_bar_detect(detector, bad, roi, hint, &summary, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, err.code);
    TEST_ASSERT_EQUAL_INT32(-1, err.index);
    TEST_ASSERT_EQUAL_STRING("bar", err.stage);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(err.message, named), err.message);
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_bar_detect(detector, bad, roi, hint, &summary, NULL));
}

static void wrong_pictures_are_refused_by_name(void)
{
    assert_refused(NULL, NULL, NULL, "image");
    opms_image_t bad = image;
    bad.pixels = NULL;
    assert_refused(&bad, NULL, NULL, "pixels");
    bad = image;
    bad.width_px = WIDTH - 1;
    assert_refused(&bad, NULL, NULL, "639 x 480");
    bad = image;
    bad.height_px = HEIGHT + 1;
    assert_refused(&bad, NULL, NULL, "640 x 481");
    bad = image;
    bad.stride_bytes = WIDTH - 1;
    assert_refused(&bad, NULL, NULL, "stride");
    bad = image;
    bad.stride_bytes = -WIDTH;
    assert_refused(&bad, NULL, NULL, "stride");
    bad = image;
    bad.format = (opms_pixel_format_t)7;
    assert_refused(&bad, NULL, NULL, "format");
    bad = image;
    bad.white_level = 256;
    assert_refused(&bad, NULL, NULL, "white_level");
}

static void wrong_pictures_of_sixteen_bits_are_refused_by_name(void)
{
    opms_image_t bad = image;
    bad.format = OPMS_PIXEL_GREY16;
    bad.stride_bytes = 2 * WIDTH - 2;
    assert_refused(&bad, NULL, NULL, "stride");
    bad.stride_bytes = 2 * WIDTH + 1;
    assert_refused(&bad, NULL, NULL, "stride");
    bad.stride_bytes = 2 * WIDTH;
    bad.pixels = (const char *)picture + 1;
    assert_refused(&bad, NULL, NULL, "aligned");
}

static void wrong_regions_are_refused_by_name(void)
{
    const opms_roi_t bad[] = {{-1, 0, 10, 10},      {0, -1, 10, 10},        {0, 0, -5, 10},
                              {0, 0, 10, -5},       {WIDTH, 0, 1, 1},       {0, HEIGHT, 1, 1},
                              {0, 0, WIDTH + 1, 1}, {600, 0, INT32_MAX, 5}, {INT32_MAX, 0, 2, 2}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        assert_refused(&image, &bad[i], NULL, "roi");
    }
}

static void hints_that_are_not_finite_are_refused(void)
{
    for (int i = 0; i < 12; ++i) {
        opms_transform_t hint = scene.bar_camera;
        *(i < 9 ? &hint.R[i] : &hint.t_m[i - 9]) = i % 2 ? NAN : INFINITY;
        assert_refused(&image, NULL, &hint, "hint");
    }
}

static void null_handles_are_refused_or_have_nothing(void)
{
    opms_error_t err;
    uint32_t count = 1;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_bar_detect(NULL, &image, NULL, NULL, &summary, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "detector"));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_bar_detect(detector, &image, NULL, NULL, NULL, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "summary"));
    TEST_ASSERT_NULL(opms_bar_squares(NULL, &count));
    TEST_ASSERT_EQUAL_UINT32(0, count);
    count = 1;
    TEST_ASSERT_NULL(opms_bar_edges(NULL, &count));
    TEST_ASSERT_EQUAL_UINT32(0, count);
    TEST_ASSERT_NOT_NULL(opms_bar_squares(detector, NULL));
    TEST_ASSERT_NOT_NULL(opms_bar_edges(detector, NULL));
    opms_bar_detector_destroy(NULL);
    opms_bar_options_init(NULL);
}

static void a_refused_picture_leaves_the_outputs_alone(void)
{
    bar_render16(&scene, picture);
    image.format = OPMS_PIXEL_GREY16;
    image.stride_bytes = 2 * WIDTH;
    image.white_level = 255;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_bar_detect(detector, &image, NULL, NULL, &summary, NULL));
    TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, summary.state);
    const opms_bar_summary_t before = summary;

    assert_refused(NULL, NULL, NULL, "image");

    TEST_ASSERT_EQUAL_MEMORY(&before, &summary, sizeof before);
    uint32_t count;
    opms_bar_edges(detector, &count);
    TEST_ASSERT_EQUAL_UINT32(before.edge_count, count);
}

static void assert_not_created(const opms_lens_t *lens, const opms_bar_options_t *options,
                               const char *named)
{
    opms_error_t err = {OPMS_OK, 0, "", ""};
    opms_bar_detector_t *none = NULL;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_bar_detector_create(lens, options, &none, &err));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(err.message, named), err.message);
    TEST_ASSERT_NULL(none);
}

static void wrong_options_and_lenses_are_refused_by_name(void)
{
    opms_bar_options_t options;
    const int32_t sizes_px[] = {-1, 5, 65};
    for (int i = 0; i < 3; ++i) {
        opms_bar_options_init(&options);
        options.min_square_px = sizes_px[i];
        assert_not_created(&scene.lens, &options, "min_square_px");
    }
    const uint32_t sizes[] = {0, sizeof options + 8};
    for (int i = 0; i < 2; ++i) {
        opms_bar_options_init(&options);
        options.struct_size = sizes[i];
        assert_not_created(&scene.lens, &options, "struct_size");
    }
    opms_bar_options_init(&options);
    options.allocator.alloc = counting_alloc; /* and no free */
    assert_not_created(&scene.lens, &options, "allocator");
    opms_lens_t lens = scene.lens;
    lens.k1 = NAN;
    assert_not_created(&lens, NULL, "k1");
    assert_not_created(NULL, NULL, "lens");
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_bar_detector_create(&scene.lens, NULL, NULL, NULL));
}

static void a_lens_that_folds_inside_the_picture_is_refused(void)
{
    opms_bar_detector_t *none = NULL;
    opms_lens_t lens = scene.lens;
    lens.k1 = -2.0;
    lens.k2 = 0.0;
    TEST_ASSERT_EQUAL(OPMS_ERR_DOMAIN, opms_bar_detector_create(&lens, NULL, &none, NULL));
    TEST_ASSERT_NULL(none);
}

static void all_memory_is_taken_at_creation(void)
{
    count_t count = {0, 0, 0};
    opms_bar_options_t options;
    opms_bar_options_init(&options);
    options.allocator = (opms_allocator_t){counting_alloc, counting_free, &count};
    tearDown();
    TEST_ASSERT_EQUAL(OPMS_OK, opms_bar_detector_create(&scene.lens, &options, &detector, NULL));
    const int calls = count.calls;
    TEST_ASSERT_GREATER_THAN_INT(0, calls);
    bar_render16(&scene, picture);
    image = (opms_image_t){picture, WIDTH, HEIGHT, 2 * WIDTH, OPMS_PIXEL_GREY16, 255};

    TEST_ASSERT_EQUAL(OPMS_OK, opms_bar_detect(detector, &image, NULL, NULL, &summary, NULL));

    TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, summary.state);
    TEST_ASSERT_EQUAL_INT(calls, count.calls);
    tearDown();
    TEST_ASSERT_EQUAL_INT(0, count.live);
}

static void creation_without_memory_fails_and_leaves_nothing(void)
{
    opms_bar_options_t options;
    opms_bar_options_init(&options);
    count_t count = {0, 0, 1};
    options.allocator = (opms_allocator_t){counting_alloc, counting_free, &count};
    opms_bar_detector_t *none = NULL;
    opms_error_t err = {OPMS_OK, 0, "", ""};
    TEST_ASSERT_EQUAL(OPMS_ERR_MEMORY,
                      opms_bar_detector_create(&scene.lens, &options, &none, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_MEMORY, err.code);
    TEST_ASSERT_NOT_NULL(strstr(err.message, "memory"));
    TEST_ASSERT_NULL(none);
    TEST_ASSERT_EQUAL_INT(0, count.live);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(wrong_pictures_are_refused_by_name);
    RUN_TEST(wrong_pictures_of_sixteen_bits_are_refused_by_name);
    RUN_TEST(wrong_regions_are_refused_by_name);
    RUN_TEST(hints_that_are_not_finite_are_refused);
    RUN_TEST(null_handles_are_refused_or_have_nothing);
    RUN_TEST(a_refused_picture_leaves_the_outputs_alone);
    RUN_TEST(wrong_options_and_lenses_are_refused_by_name);
    RUN_TEST(a_lens_that_folds_inside_the_picture_is_refused);
    RUN_TEST(all_memory_is_taken_at_creation);
    RUN_TEST(creation_without_memory_fails_and_leaves_nothing);
    return UNITY_END();
}
