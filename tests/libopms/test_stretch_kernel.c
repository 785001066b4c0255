/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The sums over a stretch's pixels: what they are, and that every vector unit gives the same. */
#include <math.h>
#include <string.h>

#include <unity.h>

#include "algebra/wide_lanes.h"
#include "bar/detector_state.h"
#include "bar/stretch_fit.h"
#include "bar_scene.h"

#define SIZE 64

static uint16_t grey[SIZE * SIZE];
static uint8_t picture[BAR_SCENE_PIXELS];
static uint64_t state;

void setUp(void)
{
    state = 20011;
}

void tearDown(void)
{
}

/** Evenly spread from `low` to `high`. */
static double between(double low, double high)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(state >> 11) * 0x1p-53;
}

static void fill_grey(int wide, double white)
{
    for (int i = 0; i < SIZE * SIZE; ++i) {
        const double v = between(0, white);
        if (wide) {
            grey[i] = (uint16_t)v;
        } else {
            ((uint8_t *)grey)[i] = (uint8_t)v;
        }
    }
}

/** Lines in rows or columns, each with its own length and place along the side. */
static fit_lines_t some_lines(int wide, int in_rows, int count)
{
    const ptrdiff_t pixel = wide ? 2 : 1, stride = SIZE * pixel;
    fit_lines_t lines = {.count = count, .wide = wide, .pixel_bytes = in_rows ? pixel : stride};
    for (int i = 0; i < count; ++i) {
        fit_line_t *line = &lines.line[i];
        const int first = (int)between(1, 9), main = 4 + i;
        line->first = (const uint8_t *)grey +
                      (in_rows ? main * stride + first * pixel : first * stride + main * pixel);
        line->count = (int)between(1, 30);
        line->in_row = in_rows && !wide;
        line->s_step = 0.85f;
        line->s_first = (float)between(-9, -2);
        line->along_step = (float)between(-0.5, 0.5);
        line->along_first = (float)between(-11, 9);
    }
    return lines;
}

/** A plain edge far from all else. */
static side_model_t plain_edge(double sigma, float white_level)
{
    side_model_t model;
    memset(&model, 0, sizeof model);
    model.blur = edge_blur_of(sigma, sigma);
    model.sigma = (float)sigma;
    model.per_sigma = (float)(1 / sigma);
    model.end_at = 1e4f;
    model.along_scale = 1.f;
    model.clip = 1.f;
    model.white_level = white_level;
    model.cut_level = 0.9f * white_level;
    return model;
}

static side_model_t some_model(int shaped, int moved)
{
    const double sigma = between(0.4, 1.4);
    side_model_t model = plain_edge(sigma, 250.f);
    model.blur = edge_blur_of(sigma, moved ? 0.6 * sigma : sigma);
    model.end_at = (float)between(9, 11);
    model.along_scale = (float)between(0.5, 3);
    model.lean = (float)between(-0.5, 0.5);
    model.cells = (unsigned)between(0, 64);
    model.cell_near = (float)between(1, 6);
    model.cell_far = model.cell_near + (float)between(2, 8);
    model.ground = between(0, 1) < 0.5 ? (float)between(1, 9) : 0.f;
    if (shaped) {
        model.clip = between(0, 1) < 0.5 ? (float)between(0.3, 0.99) : (float)UNCUT;
        model.way_px = moved ? (float)between(-4, 4) : 0.f;
        model.way_mm = moved ? (float)between(-5, 5) : 0.f;
        model.way_by = (float)between(-2, 2);
        model.rise_across = (float)between(-1, 1);
        model.rise_along = (float)between(-1, 1);
        model.blur = edge_blur_boxed(sigma, fabs((double)model.way_px));
        model.panels = moved ? (int)between(1, 5) : 0;
        model.per_cut_noise = (float)between(10, 200);
        model.ground_drop = (float)between(0, 1);
        model.family = between(0, 1) < 0.5;
        for (int level = 0; level < 2; ++level) {
            model.levels.grey[level] = (float)between(0, 255);
            model.levels.weight[level] = (float)between(0, 20);
        }
    }
    return model;
}

static void sum_two(int kernel, const side_model_t *model, const fit_lines_t lines[2],
                    stretch_t out[2], fit_sums_t sums[2])
{
    stretch_t *const to[2] = {&out[0], &out[1]};
    fit_sums_t *const to_sums[2] = {&sums[0], &sums[1]};
    memset(out, 0, 2 * sizeof out[0]);
    memset(sums, 0, 2 * sizeof sums[0]);
    stretch_kernel(kernel)->sum(model, lines, to, to_sums);
}

static void the_sums_of_a_plain_edge_are_those_of_a_normal_profile(void)
{
    const double sigma = 0.8;
    fill_grey(0, 255);
    const fit_lines_t two[2] = {some_lines(0, 1, 3), some_lines(0, 1, 9)};
    const fit_lines_t lines = two[1];
    const side_model_t model = plain_edge(sigma, 200.f);
    double w_sum = 0, wi = 0, gw = 0, hg = 0, hi = 0;
    int count = 0, light = 0;
    for (int i = 0; i < lines.count; ++i) {
        const fit_line_t *line = &lines.line[i];
        for (int k = 0; k < line->count; ++k) {
            const double s = (double)(line->s_first + (float)k * line->s_step), v = line->first[k];
            const double w = 0.5 * erfc(-s / sigma / sqrt(2));
            const double g =
                exp(-0.5 * s * s / (sigma * sigma)) / (sigma * sqrt(2 * 3.14159265358979323846));
            w_sum += w;
            wi += w * v;
            gw += g * w;
            hg += -s / sigma * g * g;
            hi += -s / sigma * g * v;
            ++count;
            light += v >= 200;
        }
    }
    stretch_t out[2];
    fit_sums_t sum[2];
    sum_two(0, &model, two, out, sum);
    const fit_sums_t sums = sum[1];
    TEST_ASSERT_EQUAL_INT(count, (int)sums.n);
    TEST_ASSERT_EQUAL_INT(light, out[1].saturated);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * count, w_sum, sums.of[SUM_W]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * wi, wi, sums.of[SUM_WI]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * gw, gw, sums.of[SUM_GW]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * gw, hg, sums.of[SUM_HG]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * wi, hi, sums.of[SUM_HI]);
}

static void every_vector_unit_sums_a_stretch_to_the_same_bytes(void)
{
    if (!wide_has_avx2()) {
        TEST_IGNORE_MESSAGE("this machine has one vector unit only");
    }
    TEST_ASSERT_NOT_EQUAL(stretch_kernel(0), stretch_kernel(1));
    for (int i = 0; i < 4000; ++i) {
        const int wide = i & 1, shaped = i >> 3 & 1;
        fill_grey(wide, 255);
        const int in_rows = i >> 1 & 1;
        const fit_lines_t lines[2] = {some_lines(wide, in_rows, 1 + i % 7),
                                      some_lines(wide, in_rows, i % 11)};
        const side_model_t model = some_model(shaped, i >> 2 & 1);
        stretch_t out[2][2];
        fit_sums_t sums[2][2];
        shape_info_t shape[2];
        int fitted[2] = {0, 0};
        memset(shape, 0, sizeof shape);
        for (int k = 0; k < 2; ++k) {
            sum_two(k, &model, lines, out[k], sums[k]);
            if (shaped) {
                fitted[k] = stretch_kernel(k)->fit_shaped(&model, lines, out[k], &shape[k]);
            }
        }
        TEST_ASSERT_EQUAL_INT(fitted[0], fitted[1]);
        TEST_ASSERT_EQUAL_MEMORY(out[0], out[1], sizeof out[0]);
        TEST_ASSERT_EQUAL_MEMORY(sums[0], sums[1], sizeof sums[0]);
        TEST_ASSERT_EQUAL_MEMORY(&shape[0], &shape[1], sizeof shape[0]);
    }
}

static void every_vector_unit_measures_a_bar_to_the_same_bytes(void)
{
    static opms_edge_t edges[2][OPMS_BAR_EDGES_MAX];
    for (int saturated = 0; saturated < 2; ++saturated) {
        bar_scene_t scene = bar_scene();
        if (saturated) {
            scene.white = 330;
        }
        bar_scene_roll(&scene, 0.4);
        bar_render8(&scene, picture);
        const opms_image_t image = {picture,         BAR_SCENE_WIDTH,  BAR_SCENE_HEIGHT,
                                    BAR_SCENE_WIDTH, OPMS_PIXEL_GREY8, 0};
        opms_bar_summary_t summary[2];
        for (int k = 0; k < 2; ++k) {
            opms_bar_detector_t *detector;
            TEST_ASSERT_EQUAL(OPMS_OK,
                              opms_bar_detector_create(&scene.lens, NULL, &detector, NULL));
            detector->kernel = stretch_kernel(k);
            TEST_ASSERT_EQUAL(
                OPMS_OK, opms_bar_detect(detector, &image, NULL, NULL, &summary[k], NULL));
            TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, summary[k].state);
            uint32_t count;
            const opms_edge_t *found = opms_bar_edges(detector, &count);
            memcpy(edges[k], found, count * sizeof *found);
            opms_bar_detector_destroy(detector);
        }
        TEST_ASSERT_EQUAL_MEMORY(&summary[0], &summary[1], sizeof summary[0]);
        TEST_ASSERT_EQUAL_MEMORY(edges[0], edges[1],
                                 summary[0].edge_count * sizeof edges[0][0]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_sums_of_a_plain_edge_are_those_of_a_normal_profile);
    RUN_TEST(every_vector_unit_sums_a_stretch_to_the_same_bytes);
    RUN_TEST(every_vector_unit_measures_a_bar_to_the_same_bytes);
    return UNITY_END();
}
