/* SPDX-License-Identifier: Apache-2.0 */
/* Blur of known shape, put into rendered pictures by a filter whose moments are exact. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <unity.h>

#include <opms/blur.h>

#include "../bar_scene.h"

#define WIDTH BAR_SCENE_WIDTH
#define HEIGHT BAR_SCENE_HEIGHT
#define REACH 14
#define SIDE (2 * REACH + 1)
#define SCENE_BLUR 0.4
#define PIXEL_VARIANCE (1.0 / 12.0)
#define PI 3.14159265358979324

typedef struct kernel {
    double weight[SIDE][SIDE]; /* [v][u] */
} kernel_t;

static uint16_t sharp[BAR_SCENE_PIXELS], blurred[BAR_SCENE_PIXELS];
static opms_square_t squares[BAR_SCENE_SQUARES];
static uint32_t square_count;
static bar_scene_t scene;

/* The bar as it stands in the default scene, its squares where the scene has them. */
static void prepare(double noise)
{
    scene.blur_px = SCENE_BLUR;
    scene.noise = noise;
    scene.top = 65535;
    scene.black *= 200;
    scene.white *= 200;
    scene.ground *= 200;
    bar_render16(&scene, sharp);
    square_count = 0;
    for (int k = 0; k < BAR_SCENE_SQUARES; ++k) {
        if (bar_scene_sees(&scene, k, 12)) {
            opms_square_t *square = &squares[square_count++];
            square->index = k;
            square->edges = 0;
            for (int c = 0; c < 4; ++c) {
                bar_scene_corner(&scene, k, c, square->corners_px[c]);
            }
        }
    }
    TEST_ASSERT_GREATER_THAN(8, square_count);
}

void setUp(void)
{
    scene = bar_scene();
    prepare(0);
}

void tearDown(void)
{
}

static void normalise(kernel_t *kernel)
{
    double *const weights = &kernel->weight[0][0], sum = 0;
    for (size_t i = 0; i < sizeof kernel->weight / sizeof *weights; ++i) {
        sum += weights[i];
    }
    for (size_t i = 0; i < sizeof kernel->weight / sizeof *weights; ++i) {
        weights[i] /= sum;
    }
}

static kernel_t round_kernel(double sigma)
{
    kernel_t kernel;
    for (int v = -REACH; v <= REACH; ++v) {
        for (int u = -REACH; u <= REACH; ++u) {
            kernel.weight[v + REACH][u + REACH] =
                sigma > 0 ? exp(-0.5 * (u * u + v * v) / (sigma * sigma)) : u == 0 && v == 0;
        }
    }
    normalise(&kernel);
    return kernel;
}

/* A way of `length` px in a direction, spread over the nearest pixels. */
static kernel_t line_kernel(double length, double angle_rad)
{
    kernel_t kernel;
    memset(&kernel, 0, sizeof kernel);
    for (int i = 0; i < 1000; ++i) {
        const double along = length * ((i + 0.5) / 1000 - 0.5);
        const double u = REACH + along * cos(angle_rad), v = REACH + along * sin(angle_rad);
        const int u0 = (int)floor(u), v0 = (int)floor(v);
        for (int c = 0; c < 4; ++c) {
            const int uc = u0 + c % 2, vc = v0 + c / 2;
            kernel.weight[vc][uc] += (1 - fabs(u - uc)) * (1 - fabs(v - vc));
        }
    }
    normalise(&kernel);
    return kernel;
}

/* Second moments of a kernel: uu, uv, vv. */
static void moments(const kernel_t *kernel, double cov[3])
{
    memset(cov, 0, 3 * sizeof *cov);
    for (int v = -REACH; v <= REACH; ++v) {
        for (int u = -REACH; u <= REACH; ++u) {
            const double weight = kernel->weight[v + REACH][u + REACH];
            cov[0] += weight * u * u;
            cov[1] += weight * u * v;
            cov[2] += weight * v * v;
        }
    }
}

/* Columns that the bar is in; the others are not looked at. */
static void columns(int *first, int *last)
{
    *first = WIDTH;
    *last = 0;
    for (uint32_t i = 0; i < 4 * square_count; ++i) {
        const int u = (int)squares[i / 4].corners_px[i % 4][0];
        *first = u - 12 < *first ? u - 12 : *first;
        *last = u + 12 > *last ? u + 12 : *last;
    }
    TEST_ASSERT_TRUE(*first >= REACH && *last < WIDTH - REACH);
}

static void filter_row(const kernel_t *kernel, int row)
{
    int first = 0, last = 0;
    columns(&first, &last);
    double sums[WIDTH] = {0};
    for (int j = 0; j < SIDE; ++j) {
        const int v = row + j - REACH;
        const uint16_t *const line = sharp + (v < 0 ? 0 : v >= HEIGHT ? HEIGHT - 1 : v) * WIDTH;
        for (int i = 0; i < SIDE; ++i) {
            const double weight = kernel->weight[j][i];
            for (int u = first; weight > 1e-7 && u <= last; ++u) {
                sums[u] += weight * line[u + i - REACH];
            }
        }
    }
    for (int u = first; u <= last; ++u) {
        blurred[row * WIDTH + u] = (uint16_t)(sums[u] + 0.5);
    }
}

static void filter(const kernel_t *kernel)
{
    for (int v = 0; v < HEIGHT; ++v) {
        filter_row(kernel, v);
    }
}

static opms_blur_t measure(const uint16_t *pixels)
{
    const opms_image_t image = {pixels, WIDTH, HEIGHT, 2 * WIDTH, OPMS_PIXEL_GREY16, 0};
    opms_blur_t blur;
    opms_error_t err;
    TEST_ASSERT_EQUAL_MESSAGE(
        OPMS_OK, opms_blur_measure(&image, squares, square_count, NULL, &blur, &err), err.message);
    return blur;
}

static void expect_verdict(opms_blur_verdict_t verdict, const opms_blur_t *blur)
{
    TEST_ASSERT_EQUAL_STRING(opms_blur_verdict_name(verdict),
                             opms_blur_verdict_name(blur->verdict));
}

/* Standard deviation of scene, pixel and a variance more. */
static double total(double variance)
{
    return sqrt(SCENE_BLUR * SCENE_BLUR + PIXEL_VARIANCE + variance);
}

static void a_sharp_picture_is_sharp_and_its_blur_is_the_scene_s(void)
{
    const opms_blur_t blur = measure(sharp);
    expect_verdict(OPMS_BLUR_SHARP, &blur);
    TEST_ASSERT_GREATER_THAN(square_count / 2, blur.squares);
    TEST_ASSERT_DOUBLE_WITHIN(0.08, total(0), blur.blur_px[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.08, total(0), blur.blur_px[1]);
}

static void a_round_blur_is_a_matter_of_focus(void)
{
    for (int i = 0; i < 4; ++i) {
        const double sigma = (const double[]){1.0, 1.3, 1.8, 2.4}[i];
        const kernel_t kernel = round_kernel(sigma);
        filter(&kernel);
        const opms_blur_t blur = measure(blurred);
        double cov[3];
        moments(&kernel, cov);
        const double truth = total(cov[0]);
        expect_verdict(OPMS_BLUR_FOCUS, &blur);
        TEST_ASSERT_DOUBLE_WITHIN(0.1 * truth, truth, blur.blur_px[0]);
        TEST_ASSERT_DOUBLE_WITHIN(0.1 * truth, truth, blur.blur_px[1]);
        TEST_ASSERT_DOUBLE_WITHIN(0.1 * truth, truth, blur.still_px);
    }
}

static void motion_has_its_direction_and_its_length(void)
{
    for (int i = 0; i < 6; ++i) {
        const double angle = i * PI / 6, length = 6.0;
        const kernel_t kernel = line_kernel(length, angle);
        filter(&kernel);
        const opms_blur_t blur = measure(blurred);
        expect_verdict(OPMS_BLUR_MOTION, &blur);
        const double along = blur.motion_direction[0] * cos(angle) +
                             blur.motion_direction[1] * sin(angle);
        TEST_ASSERT_DOUBLE_WITHIN(0.18 * length, length, blur.motion_px);
        TEST_ASSERT_TRUE(fabs(along) > cos(15 * PI / 180));
        TEST_ASSERT_DOUBLE_WITHIN(
            1e-12, 1, hypot(blur.motion_direction[0], blur.motion_direction[1]));
    }
}

static void a_slanted_motion_is_not_taken_for_a_matter_of_focus(void)
{
    /* As much across the one sides as across the others: only the corners tell. */
    const kernel_t kernel = line_kernel(7, PI / 4);
    double cov[3];
    moments(&kernel, cov);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, cov[0], cov[2]);
    filter(&kernel);
    const opms_blur_t blur = measure(blurred);
    expect_verdict(OPMS_BLUR_MOTION, &blur);
    TEST_ASSERT_DOUBLE_WITHIN(0.2, blur.blur_px[0], blur.blur_px[1]);
}

static void a_blur_that_grows_along_the_bar_is_a_matter_of_aperture(void)
{
    for (int end = 0; end < 2; ++end) {
        for (int v = 0; v < HEIGHT; ++v) {
            const double way = (double)(end ? v : HEIGHT - 1 - v) / (HEIGHT - 1);
            const kernel_t kernel = round_kernel(2.2 * way);
            filter_row(&kernel, v);
        }
        const opms_blur_t blur = measure(blurred);
        expect_verdict(OPMS_BLUR_APERTURE, &blur);
        TEST_ASSERT_TRUE(end ? blur.softest_square > blur.sharpest_square
                             : blur.softest_square < blur.sharpest_square);
        TEST_ASSERT_TRUE(blur.sharpest_px < 1.0 && blur.softest_px > 1.4);
    }
}

static void shade_on_half_of_the_bar_changes_nothing(void)
{
    const kernel_t kernel = round_kernel(1.3);
    filter(&kernel);
    const opms_blur_t in_the_sun = measure(blurred);
    for (int i = 0; i < HEIGHT / 2 * WIDTH; ++i) {
        blurred[i] = (uint16_t)(blurred[i] / 5);
    }
    const opms_blur_t blur = measure(blurred);
    expect_verdict(OPMS_BLUR_FOCUS, &blur);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, in_the_sun.blur_px[0], blur.blur_px[0]);
}

static void noise_widens_nothing(void)
{
    scene = bar_scene();
    prepare(600); /* 2 % of the contrast */
    const opms_blur_t blur = measure(sharp);
    expect_verdict(OPMS_BLUR_SHARP, &blur);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, total(0), blur.blur_px[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, total(0), blur.blur_px[1]);
}

static void a_saturated_white_hides_the_blur(void)
{
    for (int i = 0; i < BAR_SCENE_PIXELS; ++i) {
        blurred[i] = (uint16_t)(sharp[i] > 32767 / 2 ? 65535 : 4 * sharp[i]);
    }
    const opms_blur_t blur = measure(blurred);
    expect_verdict(OPMS_BLUR_UNKNOWN, &blur);
    TEST_ASSERT_EQUAL_UINT32(0, blur.squares);
}

static void a_flat_picture_and_no_squares_have_no_blur(void)
{
    memset(blurred, 0x40, sizeof blurred);
    opms_blur_t blur = measure(blurred);
    expect_verdict(OPMS_BLUR_UNKNOWN, &blur);
    TEST_ASSERT_EQUAL_INT32(-1, blur.sharpest_square);
    square_count = 0;
    blur = measure(sharp);
    expect_verdict(OPMS_BLUR_UNKNOWN, &blur);
}

static void squares_beyond_the_border_or_without_a_place_are_left_out(void)
{
    squares[0].corners_px[1][0] = NAN;
    squares[1].corners_px[2][1] = 1e30;
    squares[2].corners_px[0][0] = -500;
    const opms_blur_t blur = measure(sharp);
    expect_verdict(OPMS_BLUR_SHARP, &blur);
    TEST_ASSERT_LESS_OR_EQUAL(square_count - 3, blur.squares);
}

static void wrong_arguments_are_refused(void)
{
    const opms_image_t image = {sharp, WIDTH, HEIGHT, 2 * WIDTH, OPMS_PIXEL_GREY16, 0};
    opms_blur_options_t options;
    opms_blur_t blur;
    opms_error_t err;
    opms_blur_options_init(&options);
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG,
                      opms_blur_measure(NULL, squares, square_count, NULL, &blur, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_blur_measure(&image, NULL, 1, NULL, &blur, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_blur_measure(&image, squares, 34, NULL, &blur, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_blur_measure(&image, squares, 1, NULL, NULL, NULL));
    options.sharp_most_px = NAN;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_blur_measure(&image, squares, 1, &options, &blur, &err));
    options.struct_size = 4;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_blur_measure(&image, squares, 1, &options, &blur, &err));
}

static void the_limit_is_the_caller_s(void)
{
    const kernel_t kernel = round_kernel(1.0);
    const opms_image_t image = {blurred, WIDTH, HEIGHT, 2 * WIDTH, OPMS_PIXEL_GREY16, 0};
    opms_blur_options_t options;
    opms_blur_t blur;
    filter(&kernel);
    opms_blur_options_init(&options);
    options.sharp_most_px = 1.6;
    TEST_ASSERT_EQUAL(OPMS_OK,
                      opms_blur_measure(&image, squares, square_count, &options, &blur, NULL));
    expect_verdict(OPMS_BLUR_SHARP, &blur);
    TEST_ASSERT_EQUAL_STRING("?", opms_blur_verdict_name((opms_blur_verdict_t)5));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_sharp_picture_is_sharp_and_its_blur_is_the_scene_s);
    RUN_TEST(a_round_blur_is_a_matter_of_focus);
    RUN_TEST(motion_has_its_direction_and_its_length);
    RUN_TEST(a_slanted_motion_is_not_taken_for_a_matter_of_focus);
    RUN_TEST(a_blur_that_grows_along_the_bar_is_a_matter_of_aperture);
    RUN_TEST(shade_on_half_of_the_bar_changes_nothing);
    RUN_TEST(noise_widens_nothing);
    RUN_TEST(a_saturated_white_hides_the_blur);
    RUN_TEST(a_flat_picture_and_no_squares_have_no_blur);
    RUN_TEST(squares_beyond_the_border_or_without_a_place_are_left_out);
    RUN_TEST(wrong_arguments_are_refused);
    RUN_TEST(the_limit_is_the_caller_s);
    return UNITY_END();
}
