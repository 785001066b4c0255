/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The box's clock on the host: figures under polls and stalls, and what is refused. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <unity.h>

#include <opms/clock.h>

#include "../counting_allocator.h"

#define MS 1000000LL
#define PINGS 20000
#define EVERY_NS (200 * MS)

static opms_clock_t *box_clock;

void setUp(void)
{
    TEST_ASSERT_EQUAL(OPMS_OK, opms_clock_create(NULL, &box_clock, NULL));
}

void tearDown(void)
{
    opms_clock_destroy(box_clock);
    box_clock = NULL;
}

static double unit(void)
{
    static uint64_t state = 20260101;
    state += 0x9e3779b97f4a7c15U;
    uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/** True box time of a host time: 100 s ahead, 40 ppm fast. */
static int64_t truth(int64_t host_ns)
{
    return host_ns + 100000 * MS + llround((double)host_ns * 40e-6);
}

/** Either way waits for a poll, up to 1 ms; one ping in `stalls` is held up by 20 to 400 ms. */
static opms_round_trip_t ping(int64_t sent_ns, double stalls)
{
    const int64_t received_ns = sent_ns + llround(unit() * 1e6) +
                                (unit() < stalls / 2 ? llround((20 + 380 * unit()) * 1e6) : 0);
    const int64_t arrived_ns = received_ns + 20000 + llround(unit() * 1e6) +
                               (unit() < stalls / 2 ? llround((20 + 380 * unit()) * 1e6) : 0);
    const opms_round_trip_t trip = {sent_ns, truth(received_ns), truth(received_ns + 15000),
                                    arrived_ns};
    return trip;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/** Errors of conversions right before the next ping, sorted. */
static void run(double stalls, double *errors_ms)
{
    for (int i = 0; i < PINGS; ++i) {
        const int64_t sent_ns = 1000 * MS + i * EVERY_NS;
        const opms_round_trip_t trip = ping(sent_ns, stalls);
        TEST_ASSERT_EQUAL(OPMS_OK, opms_clock_push(box_clock, &trip, NULL));
        int64_t box_ns = 0;
        const int64_t at_ns = sent_ns + EVERY_NS;
        TEST_ASSERT_EQUAL(OPMS_OK, opms_clock_box_from_host(box_clock, at_ns, &box_ns, NULL));
        errors_ms[i] = fabs((double)(box_ns - truth(at_ns))) / 1e6;
    }
    qsort(errors_ms + 31, PINGS - 31, sizeof errors_ms[0], by_size); /* from a full window on */
}

static void conversions_stay_within_the_promise_under_polls_and_stalls(void)
{
    static double errors_ms[PINGS];
    const double shares[] = {0, 0.02, 0.2};
    for (int i = 0; i < 3; ++i) {
        opms_clock_reset(box_clock);
        run(shares[i], errors_ms);
        char line[96];
        snprintf(line, sizeof line, "stalls %2.0f %%: 99 %% below %.3f ms, worst %.3f ms",
                 100 * shares[i], errors_ms[PINGS - PINGS / 100], errors_ms[PINGS - 1]);
        TEST_MESSAGE(line);
        TEST_ASSERT_TRUE(errors_ms[PINGS - PINGS / 100] < 0.36);
        TEST_ASSERT_TRUE(errors_ms[PINGS - 1] < 0.71);
    }
}

static void drift_is_found_to_its_own_sigma(void)
{
    double worst = 0;
    for (int i = 0; i < 2000; ++i) {
        const opms_round_trip_t trip = ping(i * 1000 * MS, 0.02);
        TEST_ASSERT_EQUAL(OPMS_OK, opms_clock_push(box_clock, &trip, NULL));
        opms_clock_fit_t fit;
        opms_clock_get(box_clock, &fit);
        if (i > 31) {
            TEST_ASSERT_EQUAL(OPMS_CLOCK_FITTED, fit.state);
            worst = fmax(worst, fabs(fit.drift_ppm - 40) / fmax(fit.drift_sigma_ppm, 2));
        }
    }
    TEST_ASSERT_TRUE(worst < 8);
    TEST_ASSERT_TRUE(worst > 1); /* a sigma that is never reached is none */
}

static void a_stall_of_all_pings_leaves_the_line_as_it_was(void)
{
    for (int i = 0; i < 60; ++i) {
        const opms_round_trip_t trip = ping(i * EVERY_NS, 0);
        TEST_ASSERT_EQUAL(OPMS_OK, opms_clock_push(box_clock, &trip, NULL));
    }
    for (int i = 60; i < 110; ++i) {
        opms_round_trip_t trip = ping(i * EVERY_NS, 0);
        trip.arrived_host_ns += 150 * MS;
        TEST_ASSERT_EQUAL(OPMS_OK, opms_clock_push(box_clock, &trip, NULL));
        int64_t box_ns = 0;
        TEST_ASSERT_EQUAL(OPMS_OK,
                          opms_clock_box_from_host(box_clock, trip.arrived_host_ns, &box_ns, NULL));
        TEST_ASSERT_INT64_WITHIN(2 * MS, truth(trip.arrived_host_ns), box_ns);
    }
}

static void conversions_are_inverses_of_each_other(void)
{
    for (int i = 0; i < 40; ++i) {
        const opms_round_trip_t trip = ping(i * EVERY_NS, 0.02);
        TEST_ASSERT_EQUAL(OPMS_OK, opms_clock_push(box_clock, &trip, NULL));
    }
    for (int64_t host_ns = 0; host_ns < 1000000 * MS; host_ns += 77777 * MS + 1) {
        int64_t box_ns = 0, back_ns = 0;
        TEST_ASSERT_EQUAL(OPMS_OK, opms_clock_box_from_host(box_clock, host_ns, &box_ns, NULL));
        TEST_ASSERT_EQUAL(OPMS_OK, opms_clock_host_from_box(box_clock, box_ns, &back_ns, NULL));
        TEST_ASSERT_INT64_WITHIN(1, host_ns, back_ns);
    }
}

static void nothing_is_converted_before_the_first_ping_or_after_a_reset(void)
{
    opms_error_t err = {OPMS_OK, 0, "", ""};
    int64_t ns = 0;
    TEST_ASSERT_EQUAL(OPMS_ERR_DOMAIN, opms_clock_box_from_host(box_clock, 5, &ns, &err));
    TEST_ASSERT_EQUAL_STRING("clock", err.stage);
    const opms_round_trip_t trip = ping(MS, 0);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_clock_push(box_clock, &trip, NULL));
    TEST_ASSERT_EQUAL(OPMS_OK, opms_clock_box_from_host(box_clock, 5, &ns, NULL));
    opms_clock_reset(box_clock);
    TEST_ASSERT_EQUAL(OPMS_ERR_DOMAIN, opms_clock_host_from_box(box_clock, 5, &ns, NULL));
}

static void impossible_round_trips_are_refused_and_counted(void)
{
    const opms_round_trip_t wrong[] = {
        {10 * MS, 5 * MS, 5 * MS, 9 * MS},                 /* back before it went */
        {10 * MS, 5 * MS, 4 * MS, 11 * MS},                /* sent before it was received */
        {10 * MS, 5 * MS, 8 * MS, 11 * MS},                /* longer in the box than in the host */
        {INT64_MIN, INT64_MAX, INT64_MAX, INT64_MAX},
        {0, 0, 0, 2 * 3600 * 1000 * MS},                   /* two hours */
    };
    const uint64_t count = sizeof wrong / sizeof wrong[0];
    for (uint64_t i = 0; i < count; ++i) {
        TEST_ASSERT_EQUAL(OPMS_OK, opms_clock_push(box_clock, &wrong[i], NULL));
    }
    opms_clock_fit_t fit;
    opms_clock_get(box_clock, &fit);
    TEST_ASSERT_EQUAL_UINT64(count, fit.refused);
    TEST_ASSERT_EQUAL(OPMS_CLOCK_UNKNOWN, fit.state);
}

static void a_box_clock_that_jumps_is_followed_after_some_refusals(void)
{
    opms_clock_fit_t fit;
    for (int i = 0; i < 40; ++i) {
        const opms_round_trip_t trip = ping(i * EVERY_NS, 0);
        TEST_ASSERT_EQUAL(OPMS_OK, opms_clock_push(box_clock, &trip, NULL));
    }
    for (int i = 40; i < 80; ++i) {
        opms_round_trip_t trip = ping(i * EVERY_NS, 0);
        trip.received_box_ns += 5000 * MS;
        trip.sent_box_ns += 5000 * MS;
        TEST_ASSERT_EQUAL(OPMS_OK, opms_clock_push(box_clock, &trip, NULL));
    }
    opms_clock_get(box_clock, &fit);
    TEST_ASSERT_EQUAL_UINT64(15, fit.refused);
    int64_t box_ns = 0;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_clock_box_from_host(box_clock, 80 * EVERY_NS, &box_ns, NULL));
    TEST_ASSERT_INT64_WITHIN(MS, truth(80 * EVERY_NS) + 5000 * MS, box_ns);
}

static void a_step_of_the_wall_clock_moves_no_conversion(void)
{
    int64_t wall_ns = 0;
    uint32_t steps = 9;
    TEST_ASSERT_EQUAL(OPMS_ERR_DOMAIN, opms_clock_wall_from_host(box_clock, 5, &wall_ns, NULL));
    TEST_ASSERT_EQUAL(OPMS_OK, opms_clock_push_wall(box_clock, 1000 * MS, 5000000 * MS, NULL));
    TEST_ASSERT_EQUAL(OPMS_OK, opms_clock_push_wall(box_clock, 2000 * MS, 5001000 * MS, NULL));
    TEST_ASSERT_EQUAL_INT64(0, opms_clock_wall_steps_ns(box_clock, &steps));
    TEST_ASSERT_EQUAL_UINT32(0, steps);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_clock_push_wall(box_clock, 3000 * MS, 5302000 * MS, NULL));
    TEST_ASSERT_EQUAL(OPMS_OK, opms_clock_wall_from_host(box_clock, 4000 * MS, &wall_ns, NULL));
    TEST_ASSERT_EQUAL_INT64(5003000 * MS, wall_ns);
    TEST_ASSERT_EQUAL_INT64(300000 * MS, opms_clock_wall_steps_ns(box_clock, &steps));
    TEST_ASSERT_EQUAL_UINT32(1, steps);
}

static void wrong_arguments_and_options_are_refused_by_name(void)
{
    opms_error_t err = {OPMS_OK, 0, "", ""};
    opms_clock_t *none = NULL;
    opms_clock_options_t options;
    opms_clock_options_init(&options);
    options.window = 2;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_clock_create(&options, &none, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "window"));
    opms_clock_options_init(&options);
    options.best = 32;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_clock_create(&options, &none, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "best"));
    opms_clock_options_init(&options);
    options.drift_max_ppm = 0;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_clock_create(&options, &none, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "drift_max_ppm"));
    opms_clock_options_init(&options);
    options.struct_size = 4;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_clock_create(&options, &none, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_clock_create(NULL, NULL, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_clock_push(box_clock, NULL, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_clock_push(NULL, NULL, NULL));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_clock_box_from_host(box_clock, 1, NULL, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_clock_push_wall(NULL, 1, 1, &err));
    opms_clock_destroy(NULL);
    opms_clock_reset(NULL);
}

static void memory_comes_from_the_given_allocator_only_on_create(void)
{
    count_t count = {0, 0, 1};
    opms_clock_options_t options;
    opms_clock_options_init(&options);
    options.allocator = (opms_allocator_t){counting_alloc, counting_free, &count};
    opms_clock_t *mine = NULL;
    TEST_ASSERT_EQUAL(OPMS_ERR_MEMORY, opms_clock_create(&options, &mine, NULL));
    count.fail_at = 0;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_clock_create(&options, &mine, NULL));
    const opms_round_trip_t trip = ping(MS, 0);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_clock_push(mine, &trip, NULL));
    TEST_ASSERT_EQUAL(1, count.live);
    opms_clock_destroy(mine);
    TEST_ASSERT_EQUAL(0, count.live);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(conversions_stay_within_the_promise_under_polls_and_stalls);
    RUN_TEST(drift_is_found_to_its_own_sigma);
    RUN_TEST(a_stall_of_all_pings_leaves_the_line_as_it_was);
    RUN_TEST(conversions_are_inverses_of_each_other);
    RUN_TEST(nothing_is_converted_before_the_first_ping_or_after_a_reset);
    RUN_TEST(impossible_round_trips_are_refused_and_counted);
    RUN_TEST(a_box_clock_that_jumps_is_followed_after_some_refusals);
    RUN_TEST(a_step_of_the_wall_clock_moves_no_conversion);
    RUN_TEST(wrong_arguments_and_options_are_refused_by_name);
    RUN_TEST(memory_comes_from_the_given_allocator_only_on_create);
    return UNITY_END();
}
