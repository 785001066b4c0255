/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The small parts of the pair stage. */
#include <stdlib.h>
#include <string.h>

#include <unity.h>

#include <opms/pair.h>

#include "pair/arrival_floor.h"
#include "pair/camera_clock.h"
#include "pair/trigger_ring.h"
#include "pair/unwrap.h"

#define MS 1000000LL
#define SLOTS 64

static pair_trigger_t slots[SLOTS];
static pair_ring_t ring;

void setUp(void)
{
    memset(slots, 0, sizeof slots);
    ring = (pair_ring_t){.slots = slots, .mask = SLOTS - 1};
    pair_ring_start(&ring, 1);
}

void tearDown(void) {}

static void counters_of_any_width_count_on_through_their_wrap(void)
{
    const uint32_t widths[] = {8, 16, 24, 32, 48, 61};
    for (int i = 0; i < 6; ++i) {
        const uint64_t period = (uint64_t)1 << widths[i];
        pair_unwrap_t counter = {.bits = widths[i]};
        const int64_t start = (int64_t)(period - 5);
        for (int64_t k = 0; k < 20; ++k) {
            const uint64_t raw = ((uint64_t)start + (uint64_t)k) % period;
            TEST_ASSERT_EQUAL_INT64(start + k, pair_unwrap(&counter, raw));
        }
    }
}

static void a_width_that_is_wrong_is_seen_at_the_wrap(void)
{
    pair_unwrap_t counter = {.bits = 32}; /* of a counter that has 16 */
    TEST_ASSERT_EQUAL_INT64(65535, pair_unwrap(&counter, 65535));
    TEST_ASSERT_NOT_EQUAL_INT64(65536, pair_unwrap(&counter, 0));
}

static void a_counter_without_0_has_no_hole(void)
{
    pair_unwrap_t counter = {.bits = 16, .skips_0 = 1};
    const int64_t first = pair_unwrap(&counter, 65534);
    TEST_ASSERT_EQUAL_INT64(first + 1, pair_unwrap(&counter, 65535));
    TEST_ASSERT_EQUAL_INT64(first + 2, pair_unwrap(&counter, 1));
    TEST_ASSERT_EQUAL_INT64(first + 1, pair_unwrap(&counter, 65535)); /* a late one */
}

static void numbers_go_back_below_the_first_one(void)
{
    pair_unwrap_t counter = {.bits = 8};
    TEST_ASSERT_EQUAL_INT64(3, pair_unwrap(&counter, 3));
    TEST_ASSERT_EQUAL_INT64(-3, pair_unwrap(&counter, 253));
    TEST_ASSERT_EQUAL_INT64(4, pair_unwrap(&counter, 4));
}

static void the_nearest_trigger_is_that_of_a_plain_search(void)
{
    srand(7);
    for (int n = 1; n <= 200; ++n) {
        pair_ring_add(&ring, 0);
        ring.open = ring.next; /* all decided */
        if (n % 5 != 0) {
            pair_ring_set_time(&ring, n, n * 100 * MS + n % 7 * MS, PAIR_SOURCE_REPORT);
        }
        for (int k = 0; k < 20; ++k) {
            const int64_t at = ((int64_t)(rand() % 220) - 5) * 100 * MS + rand() % 1000 * 100000;
            int64_t best = -1, found = 0;
            for (int64_t i = n - SLOTS + 1 > 1 ? n - SLOTS + 1 : 1; i <= n; ++i) {
                const pair_trigger_t *trigger = pair_ring_timed(&ring, i);
                const int64_t off = trigger ? llabs(trigger->box_ns - at) : INT64_MAX;
                if (trigger && (best < 0 || off < best)) {
                    best = off;
                }
            }
            const pair_trigger_t *nearest = pair_ring_nearest(&ring, at, &found);
            TEST_ASSERT_EQUAL_PTR(best < 0 ? NULL : pair_ring_timed(&ring, found), nearest);
            TEST_ASSERT_EQUAL_INT64(best, nearest ? llabs(nearest->box_ns - at) : -1);
        }
    }
}

static void a_time_out_of_order_is_not_believed(void)
{
    for (int n = 1; n <= 5; ++n) {
        pair_ring_add(&ring, 0);
    }
    TEST_ASSERT_TRUE(pair_ring_set_time(&ring, 1, 100 * MS, PAIR_SOURCE_REPORT));
    TEST_ASSERT_TRUE(pair_ring_set_time(&ring, 4, 400 * MS, PAIR_SOURCE_REPORT));
    TEST_ASSERT_FALSE(pair_ring_set_time(&ring, 2, 90 * MS, PAIR_SOURCE_HISTORY));
    TEST_ASSERT_FALSE(pair_ring_set_time(&ring, 3, 410 * MS, PAIR_SOURCE_HISTORY));
    TEST_ASSERT_TRUE(pair_ring_set_time(&ring, 3, 300 * MS, PAIR_SOURCE_GAP));
    TEST_ASSERT_FALSE(pair_ring_set_time(&ring, 3, 301 * MS, PAIR_SOURCE_REPORT));
    TEST_ASSERT_TRUE(pair_ring_set_time(&ring, 3, 300 * MS + 900, PAIR_SOURCE_REPORT));
    TEST_ASSERT_EQUAL_INT64(300 * MS + 900, pair_ring_timed(&ring, 3)->box_ns);
    TEST_ASSERT_TRUE(pair_ring_set_time(&ring, 3, 300 * MS, PAIR_SOURCE_GAP)); /* worse */
    TEST_ASSERT_EQUAL_INT64(300 * MS + 900, pair_ring_timed(&ring, 3)->box_ns);
}

static void a_camera_clock_is_learnt_with_its_drift_and_keeps_it_over_a_pause(void)
{
    pair_camera_clock_t clock = {0};
    const double drift = 80e-6;
    int64_t at = 0;
    for (int i = 0; i < 600; ++i) {
        at = i * 100 * MS;
        const int64_t stamp = 5000 * MS + at + (int64_t)((double)at * drift) + i * 7919 % 40000;
        if (i == 0) {
            pair_camera_clock_start(&clock, stamp, at);
        } else {
            TEST_ASSERT_INT64_WITHIN(
                pair_camera_clock_tolerance(&clock, stamp, 100 * MS), at,
                pair_camera_clock_box(&clock, stamp));
            pair_camera_clock_learn(&clock, stamp, at);
        }
    }
    at += 30000 * MS;
    const int64_t stamp = 5000 * MS + at + (int64_t)((double)at * drift);
    TEST_ASSERT_INT64_WITHIN(300000, at, pair_camera_clock_box(&clock, stamp));
}

static void the_floor_of_delays_does_not_rise_with_a_queue_that_drains(void)
{
    pair_floor_t floor = {0};
    for (int i = 0; i < 200; ++i) {
        pair_floor_learn(&floor, 30 * MS + i % 10 * 100000, 100 * MS);
    }
    for (int i = 0; i < 300; ++i) { /* 9 s late, then less and less */
        pair_floor_learn(&floor, 30 * MS + (9000 - i % 90 * 100) * MS, 100 * MS);
    }
    TEST_ASSERT_EQUAL_INT64(30 * MS, pair_floor_ns(&floor));
    TEST_ASSERT_EQUAL(PAIR_ON_TIME, pair_floor_judge(&floor, 31 * MS, 100 * MS));
    TEST_ASSERT_EQUAL(PAIR_LATE, pair_floor_judge(&floor, 45 * MS, 100 * MS));
    TEST_ASSERT_EQUAL(PAIR_EARLY, pair_floor_judge(&floor, 27 * MS, 100 * MS));
}

static void the_floor_of_delays_follows_a_delay_that_has_changed(void)
{
    pair_floor_t floor = {0};
    for (int i = 0; i < 200; ++i) {
        pair_floor_learn(&floor, 30 * MS + i % 10 * 100000, 100 * MS);
    }
    for (int i = 0; i < 70; ++i) { /* a longer exposure */
        pair_floor_learn(&floor, 55 * MS + i % 10 * 100000, 100 * MS);
    }
    TEST_ASSERT_EQUAL_INT64(55 * MS, pair_floor_ns(&floor));
    pair_floor_learn(&floor, 20 * MS, 100 * MS);
    TEST_ASSERT_EQUAL_INT64(20 * MS, pair_floor_ns(&floor));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(counters_of_any_width_count_on_through_their_wrap);
    RUN_TEST(a_width_that_is_wrong_is_seen_at_the_wrap);
    RUN_TEST(a_counter_without_0_has_no_hole);
    RUN_TEST(numbers_go_back_below_the_first_one);
    RUN_TEST(the_nearest_trigger_is_that_of_a_plain_search);
    RUN_TEST(a_time_out_of_order_is_not_believed);
    RUN_TEST(a_camera_clock_is_learnt_with_its_drift_and_keeps_it_over_a_pause);
    RUN_TEST(the_floor_of_delays_does_not_rise_with_a_queue_that_drains);
    RUN_TEST(the_floor_of_delays_follows_a_delay_that_has_changed);
    return UNITY_END();
}
