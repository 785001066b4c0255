/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <unity.h>

#include "algebra/median.h"

#define MOST 1500

static float values[MOST], sorted[MOST];

void setUp(void)
{
}

void tearDown(void)
{
}

static int by_size(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/** `kinds` different values at most, by a generator of its own. */
static void fill(int count, unsigned kinds, uint32_t seed)
{
    for (int i = 0; i < count; ++i) {
        seed = seed * 1664525u + 1013904223u;
        values[i] = (float)((seed >> 8) % kinds) * 0.25f - 3.f;
    }
}

static void assert_is_the_middle_of_the_sorted(int count)
{
    memcpy(sorted, values, (size_t)count * sizeof *values);
    qsort(sorted, (size_t)count, sizeof *sorted, by_size);
    TEST_ASSERT_EQUAL_FLOAT(sorted[count / 2], median_of(values, count));
    qsort(values, (size_t)count, sizeof *values, by_size);
    TEST_ASSERT_EQUAL_MEMORY(sorted, values, (size_t)count * sizeof *values);
}

static void the_median_is_the_middle_of_the_sorted_values(void)
{
    static const unsigned kinds[] = {1, 2, 3, 17, 1000000};
    for (int count = 1; count <= MOST; count += 1 + count / 6) {
        for (unsigned k = 0; k < sizeof kinds / sizeof kinds[0]; ++k) {
            fill(count, kinds[k], (uint32_t)(count * 7919) + k);
            assert_is_the_middle_of_the_sorted(count);
        }
    }
}

static void rows_that_rise_or_fall_are_no_worse(void)
{
    for (int fall = 0; fall < 2; ++fall) {
        for (int i = 0; i < MOST; ++i) {
            values[i] = (float)(fall ? MOST - i : i);
        }
        assert_is_the_middle_of_the_sorted(MOST);
    }
}

static void values_that_are_no_numbers_do_not_hang_it(void)
{
    fill(100, 1000, 5);
    for (int i = 0; i < 100; i += 3) {
        values[i] = NAN;
    }
    median_of(values, 100);
    for (int i = 0; i < 100; ++i) {
        values[i] = NAN;
    }
    TEST_ASSERT_TRUE(isnan(median_of(values, 100)));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_median_is_the_middle_of_the_sorted_values);
    RUN_TEST(rows_that_rise_or_fall_are_no_worse);
    RUN_TEST(values_that_are_no_numbers_do_not_hang_it);
    return UNITY_END();
}
