/* SPDX-License-Identifier: Apache-2.0 */
/* What a fit of a line is summed up from: the line's profile against the error function, the sums
 * of rows against plain ones, and grey levels between pixels. */
#include <math.h>
#include <string.h>

#include <unity.h>

#include "../truth_project.h"
#include "grid/grey_inside.h"
#include "grid/line_sums.h"

#define SIDE 40
#define ROWS 6 /* a whole batch and half of one */
#define ROW_SIZE 11

static profile_store_t profiles;
static const line_profile_t *profile;
static uint8_t grey[SIDE * SIDE];
static uint16_t wide[SIDE * SIDE];
static view_t views[2];
static double width, blur; /* of the profile; whole steps of 3 %, so that nothing is rounded */

void setUp(void)
{
    uint64_t seed = 8;
    width = exp(22.0 / 32.0);
    blur = exp(-7.0 / 32.0);
    profile = profile_of(&profiles, (float)width, (float)blur);
    for (int i = 0; i < SIDE * SIDE; ++i) {
        grey[i] = (uint8_t)truth_uniform(&seed, 0.0, 256.0);
        wide[i] = (uint16_t)(257 * grey[i]);
    }
    const view_t narrow = {grey, SIDE, SIDE, SIDE, 0, 255};
    const view_t broad = {(const uint8_t *)wide, 2 * SIDE, SIDE, SIDE, 1, 65535};
    views[0] = narrow;
    views[1] = broad;
}

void tearDown(void)
{
}

/* A blurred step from 0 to 1, and its integral. */
static double step_at(double x)
{
    return 0.5 * erfc(-x / (blur * sqrt(2.0)));
}

static double ramp_at(double x)
{
    return x * step_at(x) + blur * exp(-0.5 * x * x / (blur * blur)) / sqrt(6.283185307179586);
}

static double area_at(double x)
{
    return ramp_at(x + 0.5 * width) - ramp_at(x - 0.5 * width);
}

static double level_at(double x)
{
    return step_at(x + 0.5 * width) - step_at(x - 0.5 * width);
}

static void a_profile_is_a_blurred_box(void)
{
    for (int i = -200; i <= 200; ++i) {
        const double x = i / 200.0 * (double)profile->reach;
        const border_lanes_t border = border_lanes_at(profile, lanes_of((float)x));
        TEST_ASSERT_DOUBLE_WITHIN(5e-4, area_at(x), border.area[0]);
        TEST_ASSERT_DOUBLE_WITHIN(5e-4, level_at(x), border.level[3]);
    }
}

/* Where row k is read: along the line, across it at the first pixel, and that pixel. */
static double s_of(int k)
{
    return 1.5 * k - 4.0;
}

static double x_of(int k)
{
    return -4.6 + 0.13 * k;
}

static int first_of(int k, int columns)
{
    const int row = 3 + 4 * k, place = 5 + k;
    return columns ? place * SIDE + row : row * SIDE + place;
}

static void sum_up(const view_t *view, int columns, float slope, float origin, line_sums_t *sums)
{
    const raster_t raster = {view, profile, columns, SIDE, SIDE, slope, ROW_SIZE, origin};
    row_batch_t batch = {.count = 0};
    memset(sums, 0, sizeof *sums);
    for (int k = 0; k < ROWS; ++k) {
        batch.first[batch.count] = view->base + first_of(k, columns) * (view->wide ? 2 : 1);
        batch.x[batch.count] = (float)x_of(k);
        batch.s[batch.count] = (float)s_of(k);
        if (++batch.count == LANES) {
            add_rows(&raster, &batch, sums);
        }
    }
    add_rows(&raster, &batch, sums);
}

/* The two factors of each product: 1, across, depth, shift, grey. */
static const int FACTORS[PRODUCTS][2] = {{0, 3}, {3, 3}, {0, 0}, {1, 3}, {2, 3},
                                         {0, 1}, {0, 2}, {0, 4}, {3, 4}, {1, 1},
                                         {1, 2}, {1, 4}, {2, 2}, {2, 4}, {4, 4}};

static double plain_sum(int product, int power, int columns, double slope, double origin)
{
    double sum = 0.0;
    for (int k = 0; k < ROWS; ++k) {
        for (int i = 0; i < ROW_SIZE; ++i) {
            const double x = x_of(k) + i * slope, low = x - 0.5 * slope, high = x + 0.5 * slope;
            const double factor[5] = {
                1.0, x, (area_at(high) - area_at(low)) / slope,
                (level_at(high) - level_at(low)) / slope,
                grey[first_of(k, columns) + i * (columns ? SIDE : 1)] - origin};
            sum += pow(s_of(k), power) * factor[FACTORS[product][0]] *
                   factor[FACTORS[product][1]];
        }
    }
    return sum;
}

static void check_sums(int columns)
{
    const double slope = 0.85, origin = 100.0;
    static const int counts[4] = {PRODUCTS, PRODUCTS_ONCE, PRODUCTS_TWICE, PRODUCTS_THRICE};
    line_sums_t sums;
    sum_up(&views[0], columns, (float)slope, (float)origin, &sums);
    const lanes_t *const by_power[4] = {sums.plain, sums.once, sums.twice, sums.thrice};
    TEST_ASSERT_EQUAL(ROWS, sums.rows);
    for (int power = 0; power < 4; ++power) {
        for (int i = 0; i < counts[power]; ++i) {
            const double truth = plain_sum(i, power, columns, slope, origin);
            TEST_ASSERT_DOUBLE_WITHIN(0.05 * pow(4.0, power) + 1e-3 * fabs(truth), truth,
                                      lanes_sum(by_power[power][i]));
        }
    }
}

static void sums_over_rows_are_those_of_each_pixel(void)
{
    check_sums(0);
}

static void sums_over_columns_are_those_of_each_pixel(void)
{
    check_sums(1);
}

static void sixteen_bits_give_the_same_sums(void)
{
    line_sums_t narrow, broad;
    for (int columns = 0; columns < 2; ++columns) {
        sum_up(&views[0], columns, 0.9f, 0.f, &narrow);
        sum_up(&views[1], columns, 0.9f, 0.f, &broad);
        const float one = lanes_sum(narrow.plain[DEPTH_GREY]);
        TEST_ASSERT_FLOAT_WITHIN(1e-3f * fabsf(one), one,
                                 lanes_sum(broad.plain[DEPTH_GREY]) / 257.f);
    }
}

static void grey_levels_inside_are_bilinear(void)
{
    uint64_t seed = 3;
    for (int i = 0; i < 500; ++i) {
        const vec2_t at = {(float)truth_uniform(&seed, 1.0, SIDE - 2.0),
                           (float)truth_uniform(&seed, 1.0, SIDE - 2.0)};
        const int x = (int)at.x, y = (int)at.y;
        const double fx = (double)at.x - x, fy = (double)at.y - y;
        const uint8_t *p = grey + y * SIDE + x;
        const double truth = (1.0 - fy) * ((1.0 - fx) * p[0] + fx * p[1]) +
                             fy * ((1.0 - fx) * p[SIDE] + fx * p[SIDE + 1]);
        TEST_ASSERT_TRUE(is_inside(&views[0], at));
        TEST_ASSERT_DOUBLE_WITHIN(4.1, truth, grey_inside(&views[0], at)); /* 2/128 of 255 */
        TEST_ASSERT_DOUBLE_WITHIN(4.1, truth, grey_inside(&views[1], at) / 257.f);
    }
    const vec2_t border = {SIDE - 1.5f, 5.f};
    TEST_ASSERT_FALSE(is_inside(&views[0], border));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_profile_is_a_blurred_box);
    RUN_TEST(sums_over_rows_are_those_of_each_pixel);
    RUN_TEST(sums_over_columns_are_those_of_each_pixel);
    RUN_TEST(sixteen_bits_give_the_same_sums);
    RUN_TEST(grey_levels_inside_are_bilinear);
    return UNITY_END();
}
