/* SPDX-License-Identifier: Apache-2.0 */
/* HISTORY: what is held, by which selection, and the log behind it. */
#include <unity.h>

#include "firmware_bench.h"

void setUp(void)
{
    opms_settings_t settings;
    opms_wire_default_settings(&settings);
    for (unsigned i = 0; i < OPMS_BOX_PREAMBLE_MAX; i++) {
        settings.preamble_gap_ms[i] = 0;
    }
    settings.period_us = 10000;
    bench_power_on(&settings);
    bench_drain();
}

void tearDown(void)
{
}

static box_cycles_t first_pulse;

/* A run of so many pulses; pulse n at first_pulse + (n - 1) * 10 ms. The host takes all reports. */
static void run(uint32_t count)
{
    bench_run();
    first_pulse = now;
    for (uint32_t i = 1; i < count; i++) {
        bench_next_pulse();
        bench_take_report();
    }
    bench_drain();
}

static void check_held(const opms_history_entry_t *entry, uint32_t number)
{
    const box_cycles_t time = first_pulse + (box_cycles_t)(number - 1) * MS(10);
    TEST_ASSERT_EQUAL(number, entry->number);
    TEST_ASSERT_EQUAL_HEX16(OPMS_TRIGGER_RUN, entry->flags);
    TEST_ASSERT_EQUAL_UINT64(time / 125, entry->time.us);
    TEST_ASSERT_EQUAL_UINT8(time % 125, entry->time.cycles);
}

static void check_not_held(const opms_history_entry_t *entry, uint32_t number)
{
    TEST_ASSERT_EQUAL(number, entry->number);
    TEST_ASSERT_EQUAL_HEX16(OPMS_TRIGGER_NOT_HELD, entry->flags);
}

static void test_before_any_selection_there_is_none(void)
{
    const opms_history_report_t got = bench_get_history();
    TEST_ASSERT_EQUAL(0, got.token);
    TEST_ASSERT_EQUAL(0, got.session_id);
    TEST_ASSERT_EQUAL(0, got.count);
    TEST_ASSERT_EQUAL_HEX32(BOOT, got.boot_id);
}

static void test_a_selection_is_returned_two_by_two_and_then_ends(void)
{
    run(20);
    bench_select(0x1234, SESSION, 3, 5);

    const uint32_t counts[] = {2, 2, 1, 0, 0}, remaining[] = {3, 1, 0, 0, 0};
    uint32_t number = 3;
    for (unsigned get = 0; get < 5; get++) {
        const opms_history_report_t got = bench_get_history();
        TEST_ASSERT_EQUAL_HEX16(0x1234, got.token);
        TEST_ASSERT_EQUAL_HEX32(SESSION, got.session_id);
        TEST_ASSERT_EQUAL(counts[get], got.count);
        TEST_ASSERT_EQUAL(remaining[get], got.remaining);
        for (uint32_t i = 0; i < got.count; i++) {
            check_held(&got.entries[i], number++);
        }
    }
    TEST_ASSERT_EQUAL(8, number);
}

static void test_another_selection_replaces_the_first_and_shows_in_the_token(void)
{
    run(20);
    bench_select(1, SESSION, 1, 10);
    bench_get_history();
    bench_select(2, SESSION, 15, 1);

    const opms_history_report_t got = bench_get_history();

    TEST_ASSERT_EQUAL(2, got.token);
    TEST_ASSERT_EQUAL(1, got.count);
    check_held(&got.entries[0], 15);
    TEST_ASSERT_EQUAL(0, bench_get_history().count);
}

static void test_pulses_that_did_not_leave_yet_are_not_held(void)
{
    run(5);
    bench_select(1, SESSION, 5, 3);
    opms_history_report_t got = bench_get_history();
    check_held(&got.entries[0], 5);
    check_not_held(&got.entries[1], 6);
    bench_next_pulse();
    bench_next_pulse();
    got = bench_get_history();
    check_held(&got.entries[0], 7);
}

static void test_the_last_8192_pulses_are_held_and_older_ones_are_not(void)
{
    run(OPMS_BOX_HISTORY_ENTRIES + 7);
    bench_select(1, SESSION, 6, 4);
    opms_history_report_t got = bench_get_history();
    check_not_held(&got.entries[0], 6);
    check_not_held(&got.entries[1], 7);
    got = bench_get_history();
    check_held(&got.entries[0], 8);
    check_held(&got.entries[1], 9);

    bench_select(2, SESSION, 8, OPMS_BOX_HISTORY_ENTRIES);
    for (uint32_t number = 8; number < 8 + OPMS_BOX_HISTORY_ENTRIES; number += 2) {
        got = bench_get_history();
        TEST_ASSERT_EQUAL(2, got.count);
        check_held(&got.entries[0], number);
        check_held(&got.entries[1], number + 1);
    }
    TEST_ASSERT_EQUAL(0, got.remaining);
}

static void test_a_session_that_is_not_held_is_told_by_zero(void)
{
    run(5);
    bench_select(7, SESSION + 1, 1, 3);
    const opms_history_report_t got = bench_get_history();
    TEST_ASSERT_EQUAL(7, got.token);
    TEST_ASSERT_EQUAL(0, got.session_id);
    TEST_ASSERT_EQUAL(0, got.count);
    TEST_ASSERT_EQUAL(0, got.remaining);
}

static void test_a_session_is_held_after_its_stop_and_until_the_next_arming(void)
{
    run(5);
    bench_stop();
    bench_pass(100 * BOX_CYCLES_PER_S);
    bench_select(7, SESSION, 4, 4);
    const opms_history_report_t got = bench_get_history();
    check_held(&got.entries[0], 4);
    check_held(&got.entries[1], 5);

    bench_command(OPMS_COMMAND_ARM, SESSION + 1);

    TEST_ASSERT_EQUAL(0, bench_get_history().session_id);
}

static void test_a_refused_selection_leaves_the_old_one(void)
{
    run(5);
    bench_select(7, SESSION, 1, 4);
    bench_select(8, SESSION, 1, 0);
    bench_select(0, SESSION, 1, 4);
    bench_select(8, SESSION, 1, OPMS_BOX_HISTORY_ENTRIES + 1);
    TEST_ASSERT_EQUAL(3, box.commands_refused);
    TEST_ASSERT_EQUAL(7, bench_get_history().token);
}

static void test_a_selection_past_the_largest_number_goes_on_at_zero(void)
{
    run(5);
    bench_select(1, SESSION, UINT32_MAX, 2);
    const opms_history_report_t got = bench_get_history();
    check_not_held(&got.entries[0], UINT32_MAX);
    check_not_held(&got.entries[1], 0);
}

static void test_lost_pulses_between_held_ones_are_not_held(void)
{
    run(5);
    bench_pass(MS(40));
    bench_pulse_number(9);
    bench_select(1, SESSION, 5, 5);
    opms_history_report_t got = bench_get_history();
    check_held(&got.entries[0], 5);
    check_not_held(&got.entries[1], 6);
    got = bench_get_history();
    check_not_held(&got.entries[0], 7);
    check_not_held(&got.entries[1], 8);
    got = bench_get_history();
    check_held(&got.entries[0], 9);
}

/* --- the log alone ----------------------------------------------------------------------------*/

static pulse_log_t pulse_log;

static void empty_log_before(uint32_t number)
{
    pulse_log.last = number - 1;
    pulse_log.first = number;
}

static void test_an_empty_log_holds_nothing(void)
{
    pulse_log_clear(&pulse_log);
    const uint32_t numbers[] = {0, 1, 2, 8192, UINT32_MAX};
    for (unsigned i = 0; i < 5; i++) {
        TEST_ASSERT_FALSE(pulse_log_holds(&pulse_log, numbers[i]));
        opms_history_entry_t entry;
        pulse_log_read(&pulse_log, numbers[i], &entry);
        check_not_held(&entry, numbers[i]);
    }
    TEST_ASSERT_EQUAL(0, pulse_log_before(&pulse_log, MS(1)));
}

static void test_numbers_go_past_2_to_the_32_without_a_loss(void)
{
    const uint32_t first = UINT32_MAX - 9;
    empty_log_before(first);
    for (uint32_t i = 0; i < 20; i++) {
        TEST_ASSERT_EQUAL(0,
                          pulse_log_add(&pulse_log, first + i, MS(10 * (i + 1)), OPMS_TRIGGER_RUN));
        for (uint32_t k = 0; k < 20; k++) {
            TEST_ASSERT_EQUAL(k <= i, pulse_log_holds(&pulse_log, first + k));
        }
        TEST_ASSERT_FALSE(pulse_log_holds(&pulse_log, first - 1));
        TEST_ASSERT_EQUAL(i == 0 ? 0 : 10000, pulse_log_gap_us(&pulse_log, first + i, 0));
        TEST_ASSERT_EQUAL(i <= 1 ? 0 : 10000, pulse_log_gap_us(&pulse_log, first + i, 1));
        TEST_ASSERT_EQUAL(first + i, pulse_log_before(&pulse_log, MS(10 * (i + 1)) + 5));
    }
}

static void test_reports_go_past_2_to_the_32_without_a_loss(void)
{
    run(1);
    box.log.last = UINT32_MAX - 5;
    box.log.first = UINT32_MAX - 4;
    box.reported = box.strobe_checked = UINT32_MAX - 5;
    pulses = UINT32_MAX - 5;
    for (uint32_t i = 0; i < 10; i++) {
        bench_next_pulse();
        TEST_ASSERT_TRUE(box_has_report(&box));
        TEST_ASSERT_EQUAL(OPMS_REPORT_TRIGGER, bench_take_report());
        TEST_ASSERT_EQUAL(UINT32_MAX - 4 + i,
                          reports.triggers[reports.trigger_count - 1].trigger_number);
    }
    TEST_ASSERT_EQUAL(0, box.dropped);
}

static uint32_t draw(uint64_t *random)
{
    *random = *random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (uint32_t)(*random >> 33);
}

/* A plain list of all that was added is the truth. */
static void test_the_log_agrees_with_a_plain_list_whatever_is_skipped(void)
{
    enum { ADDED = 30000, SPAN = 60000 };
    static box_cycles_t times[SPAN]; /* 0: never added */
    uint64_t random = 20260101;
    const uint32_t base = UINT32_MAX - 20000;
    for (uint32_t i = 0; i < SPAN; i++) {
        times[i] = 0;
    }
    empty_log_before(base);
    uint32_t last = UINT32_MAX, lost = 0; /* offsets from base; before the first */
    box_cycles_t time = 0;
    for (unsigned added = 0; added < ADDED && last + 1 < SPAN - 20; added++) {
        const uint32_t skip = draw(&random) % 10 == 0 ? draw(&random) % 12 : 0;
        time += 1 + draw(&random) % MS(30);
        last += 1 + skip;
        times[last] = time;
        lost += skip;
        TEST_ASSERT_EQUAL(skip, pulse_log_add(&pulse_log, base + last, time, OPMS_TRIGGER_RUN));
        for (unsigned probe = 0; probe < 4; probe++) {
            const uint32_t back = draw(&random) % (OPMS_BOX_HISTORY_ENTRIES + 50);
            if (back > last) {
                continue;
            }
            const uint32_t at = last - back;
            const bool held = back < OPMS_BOX_HISTORY_ENTRIES && times[at] != 0;
            TEST_ASSERT_EQUAL(held, pulse_log_holds(&pulse_log, base + at));
            if (held) {
                TEST_ASSERT_EQUAL_UINT64(times[at], pulse_log_time(&pulse_log, base + at));
                TEST_ASSERT_EQUAL(base + at, pulse_log_before(&pulse_log, times[at]));
            }
        }
    }
    TEST_ASSERT_TRUE(lost > 100);
    TEST_ASSERT_TRUE(last > 3 * OPMS_BOX_HISTORY_ENTRIES);
}

static void test_a_skip_of_more_than_the_log_forgets_all_before(void)
{
    pulse_log_clear(&pulse_log);
    pulse_log_add(&pulse_log, 1, MS(1), OPMS_TRIGGER_RUN);
    TEST_ASSERT_EQUAL(99998, pulse_log_add(&pulse_log, 100000, MS(2), OPMS_TRIGGER_RUN));
    TEST_ASSERT_FALSE(pulse_log_holds(&pulse_log, 1));
    TEST_ASSERT_TRUE(pulse_log_holds(&pulse_log, 100000));
    for (uint32_t back = 1; back < OPMS_BOX_HISTORY_ENTRIES + 2; back++) {
        TEST_ASSERT_FALSE(pulse_log_holds(&pulse_log, 100000 - back));
    }
}

static void test_gaps_are_differences_of_whole_microseconds(void)
{
    pulse_log_clear(&pulse_log);
    pulse_log_add(&pulse_log, 1, US(1000) + 124, OPMS_TRIGGER_RUN);
    pulse_log_add(&pulse_log, 2, US(1001), OPMS_TRIGGER_RUN);
    pulse_log_add(&pulse_log, 3, US(1001) + 124, OPMS_TRIGGER_RUN);
    TEST_ASSERT_EQUAL(1, pulse_log_gap_us(&pulse_log, 2, 0)); /* of 8 ns */
    TEST_ASSERT_EQUAL(0, pulse_log_gap_us(&pulse_log, 3, 0)); /* of 992 ns */
    TEST_ASSERT_EQUAL(1, pulse_log_gap_us(&pulse_log, 3, 1));
}

static void test_a_gap_of_more_than_three_bytes_is_none(void)
{
    pulse_log_clear(&pulse_log);
    pulse_log_add(&pulse_log, 1, US(5), OPMS_TRIGGER_RUN);
    pulse_log_add(&pulse_log, 2, US(5 + 0xFFFFFF), OPMS_TRIGGER_RUN);
    pulse_log_add(&pulse_log, 3, US(5 + 0xFFFFFF + 0x1000000), OPMS_TRIGGER_RUN);
    TEST_ASSERT_EQUAL_HEX32(0xFFFFFF, pulse_log_gap_us(&pulse_log, 2, 0));
    TEST_ASSERT_EQUAL(0, pulse_log_gap_us(&pulse_log, 3, 0));
    TEST_ASSERT_EQUAL_HEX32(0xFFFFFF, pulse_log_gap_us(&pulse_log, 3, 1));
}

static void test_times_of_eighteen_years_keep_their_flags(void)
{
    const box_cycles_t late = (UINT64_C(1) << 56) - 1;
    pulse_log_clear(&pulse_log);
    pulse_log_add(&pulse_log, 1, late, 0x7F & ~OPMS_TRIGGER_NOT_HELD);
    TEST_ASSERT_EQUAL_UINT64(late, pulse_log_time(&pulse_log, 1));
    TEST_ASSERT_EQUAL_HEX8(0x3F, pulse_log_flags(&pulse_log, 1));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_before_any_selection_there_is_none);
    RUN_TEST(test_a_selection_is_returned_two_by_two_and_then_ends);
    RUN_TEST(test_another_selection_replaces_the_first_and_shows_in_the_token);
    RUN_TEST(test_pulses_that_did_not_leave_yet_are_not_held);
    RUN_TEST(test_the_last_8192_pulses_are_held_and_older_ones_are_not);
    RUN_TEST(test_a_session_that_is_not_held_is_told_by_zero);
    RUN_TEST(test_a_session_is_held_after_its_stop_and_until_the_next_arming);
    RUN_TEST(test_a_refused_selection_leaves_the_old_one);
    RUN_TEST(test_a_selection_past_the_largest_number_goes_on_at_zero);
    RUN_TEST(test_lost_pulses_between_held_ones_are_not_held);
    RUN_TEST(test_an_empty_log_holds_nothing);
    RUN_TEST(test_numbers_go_past_2_to_the_32_without_a_loss);
    RUN_TEST(test_reports_go_past_2_to_the_32_without_a_loss);
    RUN_TEST(test_the_log_agrees_with_a_plain_list_whatever_is_skipped);
    RUN_TEST(test_a_skip_of_more_than_the_log_forgets_all_before);
    RUN_TEST(test_gaps_are_differences_of_whole_microseconds);
    RUN_TEST(test_a_gap_of_more_than_three_bytes_is_none);
    RUN_TEST(test_times_of_eighteen_years_keep_their_flags);
    return UNITY_END();
}
