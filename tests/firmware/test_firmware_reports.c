/* SPDX-License-Identifier: Apache-2.0 */
/* Which report goes out when, and what it says of what was lost. */
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

static void ping(void)
{
    bench_command(OPMS_COMMAND_PING, 1);
}

static void test_a_trigger_goes_before_pong_event_and_status(void)
{
    bench_run();
    bench_drain();
    bench_pass(BOX_CYCLES_PER_S);
    bench_glitch(1);
    ping();
    bench_pulse();

    TEST_ASSERT_EQUAL(OPMS_REPORT_TRIGGER, bench_take_report());
    TEST_ASSERT_EQUAL(OPMS_REPORT_PONG, bench_take_report());
    TEST_ASSERT_EQUAL(OPMS_REPORT_EVENT, bench_take_report());
    TEST_ASSERT_EQUAL(OPMS_REPORT_STATUS, bench_take_report());
    TEST_ASSERT_EQUAL(0, bench_take_report());
}

static void test_a_lone_trigger_goes_first_however_many_went_before(void)
{
    bench_run();
    for (unsigned pulse = 0; pulse < 60; pulse++) {
        while (box_has_report(&box)) {
            bench_take_report();
        }
        bench_next_pulse();
        if (pulse % 20 == 19) {
            ping();
        }
        TEST_ASSERT_EQUAL(OPMS_REPORT_TRIGGER, bench_take_report());
    }
}

static void test_of_many_triggers_every_eighth_lets_another_pass(void)
{
    bench_run();
    bench_drain();
    for (unsigned pulse = 0; pulse < 100; pulse++) {
        bench_next_pulse();
    }
    for (unsigned i = 0; i < 3; i++) {
        ping();
    }
    for (unsigned other = 0; other < 3; other++) {
        for (unsigned i = 0; i < 8; i++) {
            TEST_ASSERT_EQUAL(OPMS_REPORT_TRIGGER, bench_take_report());
        }
        TEST_ASSERT_EQUAL(OPMS_REPORT_PONG, bench_take_report());
    }
    bench_drain();
    TEST_ASSERT_EQUAL(100 - 24, reports.trigger_count);
}

/* The endpoint takes one report a millisecond, and half of the time the host pings and the line
 * glitches at each of them: 10 s at the shortest period. A report is handed over when the one
 * before has been taken. */
static void test_each_trigger_is_taken_within_2_ms_whatever_else_is_going_on(void)
{
    bench_run();
    bench_drain();
    bench_drain(); /* forgets the first pulse, too */
    const box_cycles_t start = now;
    uint32_t left = 0;
    box_cycles_t left_at[1001] = {0};
    for (uint32_t ms = 0; ms < 10000; ms++) {
        /* Pulses come at every phase of USB's frame. */
        const box_cycles_t pulse_at = start + (left + 1) * MS(10) + (left * 997) % MS(1);
        if (left < 1000 && pulse_at <= start + MS(ms + 1)) {
            now = pulse_at;
            bench_pulse();
            left_at[left++] = pulse_at;
        }
        now = start + MS(ms + 1);
        box_tick(&box, now);
        if (ms / 200 % 2 != 0) {
            ping();
            bench_glitch(1);
        }
        const uint32_t before = reports.trigger_count;
        const uint8_t handed_over = bench_take_report();
        reports.event_count = reports.pong_count = reports.status_count = 0;
        reports.order_count = 0;
        if (handed_over == OPMS_REPORT_TRIGGER) {
            const opms_trigger_report_t *trigger = &reports.triggers[before];
            TEST_ASSERT_BITS_LOW(OPMS_TRIGGER_DELAYED, trigger->flags);
            TEST_ASSERT_EQUAL(before + 2, trigger->trigger_number);
            TEST_ASSERT_TRUE(now + MS(1) - left_at[before] <= MS(2)); /* taken a frame later */
        }
    }
    TEST_ASSERT_EQUAL(1000 - 1, reports.trigger_count);
}

static void test_a_report_is_delayed_when_it_leaves_more_than_2_ms_after_its_pulse(void)
{
    const box_cycles_t lateness[] = {0, MS(2), MS(2) + 1, MS(6000)};
    const bool delayed[] = {false, false, true, true};
    for (unsigned i = 0; i < 4; i++) {
        bench_run();
        bench_drain();
        bench_next_pulse();
        now += lateness[i];
        bench_drain();
        TEST_ASSERT_EQUAL(1, reports.trigger_count);
        TEST_ASSERT_EQUAL(delayed[i], (reports.triggers[0].flags & OPMS_TRIGGER_DELAYED) != 0);
        bench_stop();
    }
}

static void test_a_trigger_tells_the_gaps_to_the_two_pulses_before(void)
{
    const uint32_t first[] = {0, 0, 10000, 10000, 25000};
    const uint32_t gaps[] = {0, 10000, 10000, 25000, 10000};
    bench_run();
    bench_next_pulse();
    bench_next_pulse();
    bench_pass(MS(15));
    bench_next_pulse();
    bench_next_pulse();
    bench_drain();

    TEST_ASSERT_EQUAL(5, reports.trigger_count);
    for (unsigned i = 0; i < 5; i++) {
        TEST_ASSERT_EQUAL(gaps[i], reports.triggers[i].gap_us[0]);
        TEST_ASSERT_EQUAL(first[i], reports.triggers[i].gap_us[1]);
    }
}

/* Of three reports any two may be lost: the third gives their times to the microsecond. */
static void test_from_one_trigger_the_two_before_can_be_told(void)
{
    bench_run();
    for (unsigned i = 0; i < 30; i++) {
        bench_pass(MS(10) + i * 31 + 7);
        bench_pulse();
    }
    bench_drain();
    for (unsigned i = 2; i < 31; i++) {
        const opms_trigger_report_t *trigger = &reports.triggers[i];
        const uint64_t before = trigger->time.us - trigger->gap_us[0];
        TEST_ASSERT_EQUAL_UINT64(reports.triggers[i - 1].time.us, before);
        TEST_ASSERT_EQUAL_UINT64(reports.triggers[i - 2].time.us, before - trigger->gap_us[1]);
    }
}

static void test_reports_of_all_kinds_are_numbered_one_by_one(void)
{
    const opms_settings_t settings = *box_settings(&box);
    bench_power_on(&settings); /* nothing has been sent yet */
    bench_run();
    uint32_t next = 1;
    for (unsigned i = 0; i < 40; i++) {
        bench_next_pulse();
        bench_pass(MS(500));
        ping();
        bench_glitch(1);
        uint32_t t = reports.trigger_count, p = reports.pong_count, s = reports.status_count,
                 e = reports.event_count;
        for (uint8_t id = bench_take_report(); id != 0; id = bench_take_report()) {
            const uint32_t number = id == OPMS_REPORT_TRIGGER  ? reports.triggers[t++].report_number
                                    : id == OPMS_REPORT_PONG   ? reports.pongs[p++].report_number
                                    : id == OPMS_REPORT_STATUS ? reports.statuses[s++].report_number
                                                               : reports.events[e++].report_number;
            TEST_ASSERT_EQUAL(next++, number);
        }
    }
    TEST_ASSERT_TRUE(next > 120);
}

static void test_report_numbers_wrap(void)
{
    box.report_number = UINT32_MAX - 1;
    ping();
    ping();
    bench_drain();
    TEST_ASSERT_EQUAL_HEX32(UINT32_MAX, reports.pongs[0].report_number);
    TEST_ASSERT_EQUAL(0, reports.pongs[1].report_number);
}

static void test_status_comes_at_power_on_and_once_a_second(void)
{
    bench_power_on(NULL);
    bench_drain();
    TEST_ASSERT_EQUAL(1, reports.status_count);
    for (unsigned second = 1; second <= 10; second++) {
        bench_pass(BOX_CYCLES_PER_S);
        while (bench_take_report() != 0) {
        }
        TEST_ASSERT_EQUAL(1 + second, reports.status_count);
        TEST_ASSERT_UINT64_WITHIN(50000, second * 1000000 + 1000,
                                  reports.statuses[second].uptime_us);
    }
}

static void test_a_silent_host_finds_one_status_that_is_new(void)
{
    bench_pass(3600 * BOX_CYCLES_PER_S);
    bench_drain();
    TEST_ASSERT_EQUAL(1, reports.status_count);
    TEST_ASSERT_EQUAL_UINT64(now / 125, reports.statuses[0].uptime_us);
}

static void test_status_tells_all_that_is_counted(void)
{
    bench_run();
    bench_next_pulse();
    bench_glitch(1);
    bench_glitch(1);
    bench_start_edge(125);
    bench_command(OPMS_COMMAND_ARM, 5);
    bench_pulse_number(6);
    box_endpoint_healed(&box, now);
    bench_pass(BOX_CYCLES_PER_S);
    bench_drain();

    const opms_status_report_t *status = &reports.statuses[0];
    TEST_ASSERT_EQUAL(OPMS_BOX_RUNNING, status->state);
    TEST_ASSERT_EQUAL(OPMS_RESET_POWER, status->reset_cause);
    TEST_ASSERT_EQUAL_HEX32(BOOT, status->boot_id);
    TEST_ASSERT_EQUAL_HEX32(SESSION, status->session_id);
    TEST_ASSERT_EQUAL(6, status->trigger_number);
    TEST_ASSERT_EQUAL(1, status->first_run_number);
    TEST_ASSERT_EQUAL(2, status->glitches);
    TEST_ASSERT_EQUAL(1, status->starts_refused);
    TEST_ASSERT_EQUAL(1, status->commands_refused);
    TEST_ASSERT_EQUAL(3, status->dropped);
    TEST_ASSERT_EQUAL(1, status->reenumerations);
    TEST_ASSERT_EQUAL_HEX16(opms_wire_settings_crc(box_settings(&box)), status->settings_crc);
}

static void test_six_seconds_of_a_silent_host_lose_nothing(void)
{
    bench_run();
    bench_drain();
    for (unsigned i = 0; i < 600; i++) {
        bench_next_pulse();
    }
    bench_drain();
    TEST_ASSERT_EQUAL(600, reports.trigger_count);
    for (uint32_t i = 0; i < 600; i++) {
        TEST_ASSERT_EQUAL(2 + i, reports.triggers[i].trigger_number);
        TEST_ASSERT_EQUAL(0, reports.triggers[i].dropped);
    }
}

static void test_pulses_that_hardware_lost_are_counted_and_skipped(void)
{
    bench_run();
    bench_pass(MS(40));
    bench_pulse_number(5);
    bench_drain();
    TEST_ASSERT_EQUAL(2, reports.trigger_count);
    TEST_ASSERT_EQUAL(5, reports.triggers[1].trigger_number);
    TEST_ASSERT_EQUAL(3, reports.triggers[1].dropped);
    TEST_ASSERT_EQUAL(0, reports.triggers[1].gap_us[0]);
    TEST_ASSERT_EQUAL(0, reports.triggers[1].gap_us[1]);
}

static void test_a_number_that_is_not_after_the_last_is_no_pulse(void)
{
    bench_run();
    bench_next_pulse();
    bench_drain();
    bench_pulse_number(2);
    bench_pulse_number(1);
    bench_drain();
    TEST_ASSERT_EQUAL(0, reports.trigger_count);
    TEST_ASSERT_EQUAL(0, box.dropped);
    bench_pulse_number(3);
    bench_drain();
    TEST_ASSERT_EQUAL(3, reports.triggers[0].trigger_number);
}

static void test_what_no_report_told_before_the_log_was_overrun_is_counted(void)
{
    bench_run();
    bench_drain();
    for (unsigned i = 0; i < OPMS_BOX_HISTORY_ENTRIES + 100; i++) {
        bench_next_pulse();
    }
    bench_drain();
    TEST_ASSERT_EQUAL(OPMS_BOX_HISTORY_ENTRIES, reports.trigger_count);
    TEST_ASSERT_EQUAL(102, reports.triggers[0].trigger_number);
    TEST_ASSERT_EQUAL(100, reports.triggers[0].dropped);
    TEST_ASSERT_EQUAL(100, box.dropped);
}

static void test_what_no_report_told_before_the_next_arming_is_counted(void)
{
    bench_run();
    for (unsigned i = 0; i < 7; i++) {
        bench_next_pulse();
    }
    bench_stop();
    bench_run();
    bench_drain();
    TEST_ASSERT_EQUAL(8, box.dropped);
    TEST_ASSERT_EQUAL(1, reports.trigger_count);
    TEST_ASSERT_EQUAL(8, reports.triggers[0].dropped);
}

static void test_a_pulse_that_hardware_lost_is_counted_once_though_no_report_told_its_session(void)
{
    bench_run();
    bench_next_pulse();
    bench_pulse_number(6); /* 3, 4 and 5 are lost */
    bench_stop();
    bench_run();
    TEST_ASSERT_EQUAL(6, box.dropped);
}

static void test_the_count_of_the_lost_stays_at_its_largest_in_a_trigger(void)
{
    box.dropped = 65534;
    bench_run();
    bench_next_pulse();
    bench_pulse_number(4);
    bench_pulse_number(6);
    bench_drain();
    TEST_ASSERT_EQUAL(4, reports.trigger_count);
    TEST_ASSERT_EQUAL(65535, reports.triggers[3].dropped);
    bench_pass(BOX_CYCLES_PER_S);
    bench_drain();
    TEST_ASSERT_EQUAL(65536, reports.statuses[0].dropped);
}

static void test_events_beyond_the_queue_show_as_a_gap_in_their_numbers(void)
{
    const uint32_t before = box.event_number;
    for (unsigned i = 0; i < BOX_EVENTS + 10; i++) {
        bench_glitch(i);
    }
    bench_drain();
    TEST_ASSERT_EQUAL(BOX_EVENTS, reports.event_count);
    for (uint32_t i = 0; i < BOX_EVENTS; i++) {
        TEST_ASSERT_EQUAL(before + 1 + i, reports.events[i].event_number);
        TEST_ASSERT_EQUAL(i, reports.events[i].argument);
    }
    TEST_ASSERT_EQUAL(BOX_EVENTS + 10, box.glitches);
    bench_glitch(1);
    bench_drain();
    TEST_ASSERT_EQUAL(before + BOX_EVENTS + 11, reports.events[0].event_number);
}

static void test_healing_the_endpoint_is_told_and_counted(void)
{
    box_endpoint_healed(&box, now);
    box_endpoint_healed(&box, now);
    bench_drain();
    TEST_ASSERT_EQUAL(2, reports.event_count);
    TEST_ASSERT_EQUAL(OPMS_EVENT_ENDPOINT_HEALED, reports.events[1].kind);
    TEST_ASSERT_EQUAL(2, reports.events[1].argument);
}

static double part_lit(box_cycles_t over)
{
    unsigned lit = 0, looks = 0;
    for (box_cycles_t at = 0; at < over; at += MS(1), looks++) {
        lit += box_led(&box, now + at);
    }
    return (double)lit / looks;
}

static void test_the_led_shows_the_state(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(0.001, 0.05, part_lit(MS(20000)));
    bench_command(OPMS_COMMAND_ARM, SESSION);
    box_take_actions(&box);
    TEST_ASSERT_DOUBLE_WITHIN(0.001, 0.5, part_lit(MS(20000)));
    bench_armed();
    TEST_ASSERT_DOUBLE_WITHIN(0, 1, part_lit(MS(20000)));
    bench_start_edge(125);
    bench_pass(OPMS_BOX_START_CYCLES);
    bench_pulse();
    TEST_ASSERT_TRUE(box_led(&box, now));
    TEST_ASSERT_FALSE(box_led(&box, now + MS(5)));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_trigger_goes_before_pong_event_and_status);
    RUN_TEST(test_a_lone_trigger_goes_first_however_many_went_before);
    RUN_TEST(test_of_many_triggers_every_eighth_lets_another_pass);
    RUN_TEST(test_each_trigger_is_taken_within_2_ms_whatever_else_is_going_on);
    RUN_TEST(test_a_report_is_delayed_when_it_leaves_more_than_2_ms_after_its_pulse);
    RUN_TEST(test_a_trigger_tells_the_gaps_to_the_two_pulses_before);
    RUN_TEST(test_from_one_trigger_the_two_before_can_be_told);
    RUN_TEST(test_reports_of_all_kinds_are_numbered_one_by_one);
    RUN_TEST(test_report_numbers_wrap);
    RUN_TEST(test_status_comes_at_power_on_and_once_a_second);
    RUN_TEST(test_a_silent_host_finds_one_status_that_is_new);
    RUN_TEST(test_status_tells_all_that_is_counted);
    RUN_TEST(test_six_seconds_of_a_silent_host_lose_nothing);
    RUN_TEST(test_pulses_that_hardware_lost_are_counted_and_skipped);
    RUN_TEST(test_a_number_that_is_not_after_the_last_is_no_pulse);
    RUN_TEST(test_what_no_report_told_before_the_log_was_overrun_is_counted);
    RUN_TEST(test_what_no_report_told_before_the_next_arming_is_counted);
    RUN_TEST(test_a_pulse_that_hardware_lost_is_counted_once_though_no_report_told_its_session);
    RUN_TEST(test_the_count_of_the_lost_stays_at_its_largest_in_a_trigger);
    RUN_TEST(test_events_beyond_the_queue_show_as_a_gap_in_their_numbers);
    RUN_TEST(test_healing_the_endpoint_is_told_and_counted);
    RUN_TEST(test_the_led_shows_the_state);
    return UNITY_END();
}
