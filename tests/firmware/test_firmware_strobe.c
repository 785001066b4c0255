/* SPDX-License-Identifier: Apache-2.0 */
/* Exposures: of which pulse, told when, and missing when. */
#include <unity.h>

#include "firmware_bench.h"

static void power_on(bool strobe_enabled)
{
    opms_settings_t settings;
    opms_wire_default_settings(&settings);
    for (unsigned i = 0; i < OPMS_BOX_PREAMBLE_MAX; i++) {
        settings.preamble_gap_ms[i] = 0;
    }
    settings.strobe_enabled = strobe_enabled;
    bench_power_on(&settings);
    bench_drain();
}

void setUp(void)
{
    power_on(true);
}

void tearDown(void)
{
}

/* A period: an exposure after `delay`, of `length`, told at its end, then the next pulse. */
static void expose_and_pulse(box_cycles_t delay, box_cycles_t length)
{
    const box_cycles_t pulse = now;
    bench_pass(delay + length);
    bench_strobe(length, (uint32_t)length);
    bench_pass(pulse + MS(100) - now);
    bench_pulse();
}

static const opms_trigger_report_t *last_trigger(void)
{
    bench_drain();
    TEST_ASSERT_TRUE(reports.trigger_count > 0);
    return &reports.triggers[reports.trigger_count - 1];
}

static void check_exposure(const opms_trigger_report_t *trigger, uint32_t of, uint32_t delay,
                           uint32_t length)
{
    TEST_ASSERT_BITS_HIGH(OPMS_TRIGGER_STROBE, trigger->flags);
    TEST_ASSERT_EQUAL(of, trigger->strobe_for_trigger);
    TEST_ASSERT_EQUAL(delay, trigger->strobe_delay_cycles);
    TEST_ASSERT_EQUAL(length, trigger->strobe_length_cycles);
}

static opms_history_entry_t held(uint32_t number)
{
    bench_select(1, SESSION, number, 1);
    return bench_get_history().entries[0];
}

static void test_an_exposure_is_told_with_the_next_pulse(void)
{
    bench_run();
    TEST_ASSERT_BITS_LOW(OPMS_TRIGGER_STROBE, last_trigger()->flags);
    for (uint32_t pulse = 1; pulse <= 10; pulse++) {
        expose_and_pulse(1875 + pulse, MS(8) + pulse);
        check_exposure(last_trigger(), pulse, 1875 + pulse, (uint32_t)MS(8) + pulse);
    }
    TEST_ASSERT_EQUAL(0, box.strobes_missing);
}

static void test_an_exposure_is_told_again_until_a_newer_one_is_complete(void)
{
    bench_run();
    expose_and_pulse(5, 50);
    check_exposure(last_trigger(), 1, 5, 50);
    bench_next_pulse();
    check_exposure(last_trigger(), 1, 5, 50);
    bench_next_pulse();
    check_exposure(last_trigger(), 1, 5, 50);
}

static void test_no_report_waits_for_an_exposure(void)
{
    bench_run();
    bench_drain();
    for (unsigned i = 0; i < 3; i++) {
        bench_next_pulse();
        TEST_ASSERT_TRUE(box_has_report(&box));
        bench_drain();
        TEST_ASSERT_EQUAL(1, reports.trigger_count);
    }
}

static void test_history_tells_each_pulse_its_own_exposure(void)
{
    bench_run();
    for (uint32_t pulse = 1; pulse <= 5; pulse++) {
        expose_and_pulse(1000 * pulse, 77 * pulse);
    }
    for (uint32_t pulse = 1; pulse <= 5; pulse++) {
        const opms_history_entry_t entry = held(pulse);
        TEST_ASSERT_EQUAL_HEX16(OPMS_TRIGGER_RUN | OPMS_TRIGGER_STROBE, entry.flags);
        TEST_ASSERT_EQUAL(1000 * pulse, entry.strobe_delay_cycles);
        TEST_ASSERT_EQUAL(77 * pulse, entry.strobe_length_cycles);
    }
    TEST_ASSERT_EQUAL_HEX16(OPMS_TRIGGER_RUN, held(6).flags);
}

static void test_a_missing_exposure_is_told_at_the_second_pulse_after(void)
{
    bench_run();
    expose_and_pulse(5, 50); /* of pulse 1; pulse 2 has none */
    bench_next_pulse();
    bench_drain();
    for (uint32_t i = 0; i < reports.event_count; i++) {
        TEST_ASSERT_NOT_EQUAL(OPMS_EVENT_STROBE_MISSING, reports.events[i].kind);
    }
    bench_next_pulse();
    bench_drain();

    TEST_ASSERT_EQUAL(2, bench_the_event(OPMS_EVENT_STROBE_MISSING)->argument);
    TEST_ASSERT_BITS_HIGH(OPMS_TRIGGER_STROBE_MISSING, reports.triggers[0].flags);
    TEST_ASSERT_EQUAL(4, reports.triggers[0].trigger_number);
    TEST_ASSERT_EQUAL(1, box.strobes_missing);
    TEST_ASSERT_EQUAL_HEX16(OPMS_TRIGGER_RUN | OPMS_TRIGGER_STROBE_MISSING, held(2).flags);
    TEST_ASSERT_EQUAL_HEX16(OPMS_TRIGGER_RUN, held(3).flags);
}

static void test_a_missing_exposure_is_told_at_once_when_a_later_one_has_come(void)
{
    bench_run();
    expose_and_pulse(5, 50);
    bench_next_pulse(); /* pulse 2 had none */
    bench_drain();
    bench_pass(100);
    bench_strobe(60, 60); /* of pulse 3 */
    bench_drain();
    TEST_ASSERT_EQUAL(2, bench_the_event(OPMS_EVENT_STROBE_MISSING)->argument);
}

static void test_a_camera_that_does_nothing_is_missed_at_every_pulse(void)
{
    bench_run();
    for (unsigned i = 1; i < 20; i++) {
        bench_next_pulse();
    }
    bench_drain();
    TEST_ASSERT_EQUAL(18, box.strobes_missing);
}

static void test_a_missing_exposure_is_counted_and_told_once(void)
{
    bench_run();
    bench_next_pulse(); /* pulse 1 has none */
    for (unsigned i = 0; i < 10; i++) {
        expose_and_pulse(5, 50);
    }
    bench_drain();
    TEST_ASSERT_EQUAL(1, box.strobes_missing);
    TEST_ASSERT_EQUAL(1, bench_the_event(OPMS_EVENT_STROBE_MISSING)->argument);
}

static void test_the_flag_of_a_missing_exposure_is_news_once(void)
{
    bench_run();
    bench_next_pulse();
    bench_drain();
    bench_next_pulse();
    TEST_ASSERT_BITS_HIGH(OPMS_TRIGGER_STROBE_MISSING, last_trigger()->flags);
    expose_and_pulse(5, 50); /* pulse 2 is missing, pulse 3 is not */
    TEST_ASSERT_BITS_HIGH(OPMS_TRIGGER_STROBE_MISSING, last_trigger()->flags);
    expose_and_pulse(5, 50);
    TEST_ASSERT_BITS_LOW(OPMS_TRIGGER_STROBE_MISSING, last_trigger()->flags);
}

static void test_late_reports_of_pulses_without_exposure_tell_it_once(void)
{
    bench_run();
    for (unsigned i = 1; i < 6; i++) {
        bench_next_pulse();
    }
    bench_drain();
    TEST_ASSERT_EQUAL(6, reports.trigger_count);
    TEST_ASSERT_BITS_HIGH(OPMS_TRIGGER_STROBE_MISSING, reports.triggers[0].flags);
    for (unsigned i = 1; i < 6; i++) {
        TEST_ASSERT_BITS_LOW(OPMS_TRIGGER_STROBE_MISSING, reports.triggers[i].flags);
    }
}

static void test_an_exposure_may_last_beyond_the_next_pulse(void)
{
    bench_run();
    const box_cycles_t rise = now + MS(50);
    bench_next_pulse();
    bench_pass(MS(40));
    bench_strobe(now - rise, (uint32_t)(now - rise)); /* 90 ms, over pulse 2 */
    bench_pass(MS(60));
    bench_pulse();
    check_exposure(last_trigger(), 1, (uint32_t)MS(50), (uint32_t)MS(90));
    TEST_ASSERT_EQUAL(0, box.strobes_missing);
}

static void test_an_exposure_that_ends_after_it_was_told_missing_changes_nothing(void)
{
    bench_run();
    const box_cycles_t rise = now + MS(1);
    bench_next_pulse();
    bench_next_pulse();
    TEST_ASSERT_EQUAL(1, box.strobes_missing);
    bench_strobe(now - rise, (uint32_t)(now - rise));
    bench_next_pulse();
    bench_drain();
    TEST_ASSERT_EQUAL_HEX16(OPMS_TRIGGER_RUN | OPMS_TRIGGER_STROBE_MISSING, held(1).flags);
}

static void test_only_the_first_exposure_after_a_pulse_counts(void)
{
    bench_run();
    bench_pass(100);
    bench_strobe(90, 20);
    bench_pass(1000);
    bench_strobe(500, 400);
    bench_next_pulse();
    check_exposure(last_trigger(), 1, 10, 20);
}

static void test_an_exposure_at_the_very_edge_has_no_delay(void)
{
    bench_run();
    bench_pass(33);
    bench_strobe(33, 33);
    bench_next_pulse();
    check_exposure(last_trigger(), 1, 0, 33);
}

static void test_an_exposure_before_the_first_pulse_is_of_none(void)
{
    bench_bring_to(OPMS_BOX_ARMED);
    bench_armed();
    bench_strobe(10, 10);
    bench_pass(MS(1));
    bench_start_edge(125);
    bench_pass(OPMS_BOX_START_CYCLES);
    bench_pulse();
    TEST_ASSERT_BITS_LOW(OPMS_TRIGGER_STROBE, last_trigger()->flags);
    bench_strobe(1000, 10); /* rose before the pulse */
    bench_next_pulse();
    TEST_ASSERT_BITS_LOW(OPMS_TRIGGER_STROBE, last_trigger()->flags);
}

static void test_a_new_session_knows_nothing_of_the_last_exposure(void)
{
    bench_run();
    expose_and_pulse(5, 50);
    bench_stop();
    bench_run();
    bench_next_pulse();
    TEST_ASSERT_BITS_LOW(OPMS_TRIGGER_STROBE | OPMS_TRIGGER_STROBE_MISSING, last_trigger()->flags);
}

static void test_where_no_strobe_is_wired_none_is_expected_or_told(void)
{
    power_on(false);
    bench_run();
    for (unsigned i = 0; i < 5; i++) {
        expose_and_pulse(5, 50);
    }
    bench_drain();
    TEST_ASSERT_EQUAL(0, box.strobes_missing);
    for (uint32_t i = 0; i < reports.trigger_count; i++) {
        TEST_ASSERT_BITS_LOW(OPMS_TRIGGER_STROBE | OPMS_TRIGGER_STROBE_MISSING,
                             reports.triggers[i].flags);
    }
}

static void test_exposures_of_lost_pulses_are_not_missed(void)
{
    bench_run();
    bench_pass(MS(500));
    bench_pulse_number(6);
    bench_next_pulse();
    bench_next_pulse();
    TEST_ASSERT_EQUAL(2, box.strobes_missing); /* of 1 and 6, not of 2 to 5 */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_an_exposure_is_told_with_the_next_pulse);
    RUN_TEST(test_an_exposure_is_told_again_until_a_newer_one_is_complete);
    RUN_TEST(test_no_report_waits_for_an_exposure);
    RUN_TEST(test_history_tells_each_pulse_its_own_exposure);
    RUN_TEST(test_a_missing_exposure_is_told_at_the_second_pulse_after);
    RUN_TEST(test_a_missing_exposure_is_told_at_once_when_a_later_one_has_come);
    RUN_TEST(test_a_camera_that_does_nothing_is_missed_at_every_pulse);
    RUN_TEST(test_a_missing_exposure_is_counted_and_told_once);
    RUN_TEST(test_the_flag_of_a_missing_exposure_is_news_once);
    RUN_TEST(test_late_reports_of_pulses_without_exposure_tell_it_once);
    RUN_TEST(test_an_exposure_may_last_beyond_the_next_pulse);
    RUN_TEST(test_an_exposure_that_ends_after_it_was_told_missing_changes_nothing);
    RUN_TEST(test_only_the_first_exposure_after_a_pulse_counts);
    RUN_TEST(test_an_exposure_at_the_very_edge_has_no_delay);
    RUN_TEST(test_an_exposure_before_the_first_pulse_is_of_none);
    RUN_TEST(test_a_new_session_knows_nothing_of_the_last_exposure);
    RUN_TEST(test_where_no_strobe_is_wired_none_is_expected_or_told);
    RUN_TEST(test_exposures_of_lost_pulses_are_not_missed);
    return UNITY_END();
}
