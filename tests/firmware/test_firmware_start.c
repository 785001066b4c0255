/* SPDX-License-Identifier: Apache-2.0 */
/* START: the debounce, a cut preamble, glitches, and the wait for it. */
#include <unity.h>

#include "firmware_bench.h"

void setUp(void)
{
    bench_power_on(NULL);
    bench_drain();
}

void tearDown(void)
{
}

static opms_settings_t settings_with(uint32_t debounce_cycles, uint16_t wait_timeout_s)
{
    opms_settings_t settings;
    opms_wire_default_settings(&settings);
    settings.debounce_cycles = debounce_cycles;
    settings.wait_timeout_s = wait_timeout_s;
    return settings;
}

static void check_time(box_cycles_t want, opms_box_time_t got)
{
    TEST_ASSERT_EQUAL_UINT64(want / OPMS_BOX_CYCLES_PER_US, got.us);
    TEST_ASSERT_EQUAL_UINT8(want % OPMS_BOX_CYCLES_PER_US, got.cycles);
}

static void test_the_start_edge_is_debounce_and_four_cycles_before_the_first_pulse(void)
{
    const uint32_t debounces[] = {0, 1, 125, 126, 1250000};
    for (unsigned i = 0; i < sizeof debounces / sizeof debounces[0]; i++) {
        const opms_settings_t settings = settings_with(debounces[i], 0);
        bench_power_on(&settings);
        bench_bring_to(OPMS_BOX_WAITING);
        bench_pass(MS(1234) + 77);
        const box_cycles_t edge = now;

        bench_pass(debounces[i]);
        bench_start_edge(debounces[i]);
        bench_pass(OPMS_BOX_START_CYCLES);
        bench_pulse();
        bench_drain();

        TEST_ASSERT_EQUAL(1, reports.trigger_count);
        const opms_trigger_report_t *trigger = &reports.triggers[0];
        TEST_ASSERT_EQUAL_HEX16(OPMS_TRIGGER_RUN, trigger->flags);
        TEST_ASSERT_EQUAL(7, trigger->trigger_number);
        TEST_ASSERT_EQUAL(7, trigger->first_run_number);
        check_time(edge, trigger->start_edge);
        check_time(edge + debounces[i] + 4, trigger->time);
        check_time(edge, bench_the_event(OPMS_EVENT_START)->time);
        TEST_ASSERT_EQUAL(7, bench_the_event(OPMS_EVENT_START)->argument);
    }
}

static void test_the_run_keeps_its_start_edge_and_first_number(void)
{
    bench_bring_to(OPMS_BOX_RUNNING);
    const box_cycles_t edge = now - OPMS_BOX_START_CYCLES - 125;

    for (unsigned i = 0; i < 20; i++) {
        bench_next_pulse();
    }
    bench_drain();

    TEST_ASSERT_EQUAL(20, reports.trigger_count);
    for (uint32_t i = 0; i < 20; i++) {
        const opms_trigger_report_t *trigger = &reports.triggers[i];
        TEST_ASSERT_EQUAL(8 + i, trigger->trigger_number);
        TEST_ASSERT_EQUAL(7, trigger->first_run_number);
        check_time(edge, trigger->start_edge);
        check_time(edge + 129 + (i + 1) * MS(100), trigger->time);
    }
}

static void test_pulses_of_the_preamble_say_so_and_know_no_run(void)
{
    bench_bring_to(OPMS_BOX_PREAMBLE);
    for (unsigned i = 0; i < 6; i++) {
        bench_pulse();
        bench_pass(MS(100));
    }
    bench_drain();

    TEST_ASSERT_EQUAL(6, reports.trigger_count);
    for (uint32_t i = 0; i < 6; i++) {
        TEST_ASSERT_EQUAL(i + 1, reports.triggers[i].trigger_number);
        TEST_ASSERT_EQUAL_HEX16(OPMS_TRIGGER_PREAMBLE,
                                reports.triggers[i].flags & ~(unsigned)OPMS_TRIGGER_DELAYED);
        TEST_ASSERT_EQUAL(0, reports.triggers[i].first_run_number);
        check_time(0, reports.triggers[i].start_edge);
    }
}

static void test_start_within_the_preamble_cuts_it_after_any_of_its_pulses(void)
{
    for (uint32_t sent = 0; sent <= 5; sent++) {
        bench_power_on(NULL);
        bench_bring_to(OPMS_BOX_PREAMBLE);
        for (uint32_t i = 0; i < sent; i++) {
            bench_pulse();
            bench_pass(MS(100));
        }
        bench_start_edge(125);
        bench_pass(OPMS_BOX_START_CYCLES);
        bench_pulse();
        bench_next_pulse();
        bench_drain();

        TEST_ASSERT_EQUAL(OPMS_BOX_RUNNING, box_state(&box));
        TEST_ASSERT_EQUAL(sent, bench_the_event(OPMS_EVENT_PREAMBLE_CUT)->argument);
        TEST_ASSERT_EQUAL(sent + 1, bench_the_event(OPMS_EVENT_START)->argument);
        TEST_ASSERT_EQUAL(sent + 2, reports.trigger_count);
        for (uint32_t i = sent; i < sent + 2; i++) {
            TEST_ASSERT_EQUAL(sent + 1, reports.triggers[i].first_run_number);
            TEST_ASSERT_BITS(OPMS_TRIGGER_RUN | OPMS_TRIGGER_PREAMBLE_CUT | OPMS_TRIGGER_PREAMBLE,
                             OPMS_TRIGGER_RUN | OPMS_TRIGGER_PREAMBLE_CUT,
                             reports.triggers[i].flags);
        }
    }
}

static void test_a_pulse_of_the_preamble_within_the_debounce_is_not_of_the_run(void)
{
    const opms_settings_t settings = settings_with(1250000, 0); /* 10 ms */
    bench_power_on(&settings);
    bench_bring_to(OPMS_BOX_PREAMBLE);
    bench_pulse();
    bench_pass(MS(95));
    const box_cycles_t edge = now;
    bench_pass(MS(5));
    const box_cycles_t second = now;
    bench_pass(MS(5));
    /* Hardware records START when its debounce has passed: the pulse may come after it in the
     * log though it left before. */
    const box_input_t start = {BOX_INPUT_START, edge, 0, 0};
    const box_input_t pulse = {BOX_INPUT_PULSE, second, 2, 0};
    box_input(&box, &start);
    box_input(&box, &pulse);
    pulses = 2;
    bench_pass(OPMS_BOX_START_CYCLES);
    bench_pulse();
    bench_drain();

    TEST_ASSERT_EQUAL(3, reports.trigger_count);
    TEST_ASSERT_BITS_HIGH(OPMS_TRIGGER_PREAMBLE, reports.triggers[1].flags);
    TEST_ASSERT_BITS_HIGH(OPMS_TRIGGER_RUN, reports.triggers[2].flags);
    TEST_ASSERT_EQUAL(3, bench_the_event(OPMS_EVENT_START)->argument);
    TEST_ASSERT_EQUAL(2, bench_the_event(OPMS_EVENT_PREAMBLE_CUT)->argument);
    check_time(edge, reports.triggers[2].start_edge);
}

/* Debounce 0: the preamble's second pulse rises two cycles before the run's first. */
static void test_of_two_pulses_at_once_the_later_is_the_first_of_the_run(void)
{
    const opms_settings_t settings = settings_with(0, 0);
    bench_power_on(&settings);
    bench_bring_to(OPMS_BOX_PREAMBLE);
    bench_pulse();
    bench_pass(MS(100));
    const box_input_t inputs[3] = {{BOX_INPUT_START, now, 0, 0},
                                   {BOX_INPUT_PULSE, now + 2, 2, 0},
                                   {BOX_INPUT_PULSE, now + 4, 3, 0}};
    for (int i = 0; i < 3; i++) {
        box_input(&box, &inputs[i]);
    }
    pulses = 3;
    bench_pass(MS(1));
    bench_drain();

    TEST_ASSERT_BITS_HIGH(OPMS_TRIGGER_PREAMBLE, reports.triggers[1].flags);
    TEST_ASSERT_BITS_HIGH(OPMS_TRIGGER_RUN, reports.triggers[2].flags);
    TEST_ASSERT_EQUAL(3, bench_the_event(OPMS_EVENT_START)->argument);
}

/* START at `edge`, its debounce over; then two pulses `apart`. */
static void send_start_and_two_pulses(box_cycles_t apart)
{
    bench_power_on(NULL);
    bench_bring_to(OPMS_BOX_PREAMBLE);
    const box_input_t start = {BOX_INPUT_START, now, 0, 0};
    const box_input_t first = {BOX_INPUT_PULSE, now + 125, 1, 0};
    const box_input_t second = {BOX_INPUT_PULSE, now + 125 + apart, 2, 0};
    box_input(&box, &start);
    box_input(&box, &first);
    box_input(&box, &second);
    bench_pass(MS(1));
    bench_drain();
    TEST_ASSERT_EQUAL(2, reports.trigger_count);
    TEST_ASSERT_EQUAL(OPMS_BOX_RUNNING, box_state(&box));
}

static void test_of_two_pulses_at_once_the_later_is_the_runs_first(void)
{
    const box_cycles_t at_once[] = {0, 1, 4, 16};
    for (unsigned i = 0; i < 4; i++) {
        send_start_and_two_pulses(at_once[i]);
        TEST_ASSERT_EQUAL(2, bench_the_event(OPMS_EVENT_START)->argument);
        TEST_ASSERT_BITS_HIGH(OPMS_TRIGGER_PREAMBLE, reports.triggers[0].flags);
        TEST_ASSERT_BITS_HIGH(OPMS_TRIGGER_RUN, reports.triggers[1].flags);
        TEST_ASSERT_EQUAL(2, reports.triggers[1].first_run_number);
    }
}

static void test_of_two_pulses_a_period_apart_the_first_is_the_runs(void)
{
    send_start_and_two_pulses(US(500));
    TEST_ASSERT_EQUAL(1, bench_the_event(OPMS_EVENT_START)->argument);
    TEST_ASSERT_BITS_HIGH(OPMS_TRIGGER_RUN, reports.triggers[0].flags);
    TEST_ASSERT_EQUAL(1, reports.triggers[1].first_run_number);
}

static void test_the_runs_first_pulse_is_told_without_a_second(void)
{
    bench_bring_to(OPMS_BOX_WAITING);
    const box_input_t start = {BOX_INPUT_START, now, 0, 0};
    const box_input_t pulse = {BOX_INPUT_PULSE, now + 129, 7, 0};
    box_input(&box, &start);
    box_input(&box, &pulse);
    TEST_ASSERT_TRUE(box_has_report(&box)); /* the loop must not go to sleep on it */
    now += 129 + 17;
    box_tick(&box, now);
    TEST_ASSERT_EQUAL(OPMS_REPORT_TRIGGER, bench_take_report());
    TEST_ASSERT_EQUAL(OPMS_BOX_RUNNING, box_state(&box));
}

static void test_a_stop_at_once_after_the_first_pulse_still_tells_the_run(void)
{
    bench_bring_to(OPMS_BOX_WAITING);
    const box_input_t start = {BOX_INPUT_START, now, 0, 0};
    const box_input_t pulse = {BOX_INPUT_PULSE, now + 129, 7, 0};
    const box_input_t stopped = {BOX_INPUT_STOPPED, now + 130, 0, 0};
    box_input(&box, &start);
    box_input(&box, &pulse);
    box_input(&box, &stopped);
    bench_drain();
    TEST_ASSERT_EQUAL(OPMS_BOX_IDLE, box_state(&box));
    TEST_ASSERT_EQUAL(7, bench_the_event(OPMS_EVENT_START)->argument);
    TEST_ASSERT_EQUAL(7, bench_the_event(OPMS_EVENT_STOP)->argument);
    TEST_ASSERT_EQUAL(1, reports.trigger_count);
}

static void test_start_after_the_last_pulse_of_the_preamble_cuts_nothing(void)
{
    bench_bring_to(OPMS_BOX_RUNNING);
    bench_next_pulse();
    bench_drain();
    TEST_ASSERT_EQUAL(1, reports.trigger_count);
    TEST_ASSERT_BITS_LOW(OPMS_TRIGGER_PREAMBLE_CUT, reports.triggers[0].flags);
}

static void test_further_starts_are_refused_and_disturb_nothing(void)
{
    bench_bring_to(OPMS_BOX_WAITING);
    bench_start_edge(125);
    bench_start_edge(60); /* before the first pulse has left */
    bench_pass(OPMS_BOX_START_CYCLES);
    bench_pulse();
    const box_cycles_t first = now;
    bench_start_edge(125);
    bench_next_pulse();
    bench_drain();

    TEST_ASSERT_EQUAL(2, box.starts_refused);
    uint32_t refused = 0;
    for (uint32_t i = 0; i < reports.event_count; i++) {
        if (reports.events[i].kind == OPMS_EVENT_START_REFUSED) {
            refused++;
            TEST_ASSERT_EQUAL(OPMS_BOX_RUNNING, reports.events[i].argument);
        }
    }
    TEST_ASSERT_EQUAL(2, refused);
    TEST_ASSERT_EQUAL(7, bench_the_event(OPMS_EVENT_START)->argument);
    check_time(first - OPMS_BOX_START_CYCLES - 125, reports.triggers[1].start_edge);
    TEST_ASSERT_EQUAL(OPMS_BOX_RUNNING, box_state(&box));
}

static void test_a_refused_start_tells_the_state_and_its_edge(void)
{
    const opms_box_state_t states[] = {OPMS_BOX_IDLE, OPMS_BOX_ARMED, OPMS_BOX_RUNNING};
    for (unsigned i = 0; i < 3; i++) {
        bench_power_on(NULL);
        bench_bring_to(states[i]);
        bench_start_edge(1000);
        bench_drain();
        TEST_ASSERT_EQUAL(states[i], bench_the_event(OPMS_EVENT_START_REFUSED)->argument);
        check_time(now - 1000, bench_the_event(OPMS_EVENT_START_REFUSED)->time);
        TEST_ASSERT_EQUAL(1, box.starts_refused);
    }
}

static void test_a_start_before_arming_does_not_start_the_next_session(void)
{
    bench_start_edge(125);
    bench_bring_to(OPMS_BOX_WAITING);
    bench_pass(MS(1000));
    TEST_ASSERT_EQUAL(OPMS_BOX_WAITING, box_state(&box));
    TEST_ASSERT_EQUAL(0, box.first_run_number);
}

static void test_a_start_without_its_pulse_leaves_nothing_to_the_next_session(void)
{
    bench_bring_to(OPMS_BOX_WAITING);
    bench_start_edge(125);
    bench_stop();
    bench_drain();
    TEST_ASSERT_EQUAL(0, bench_the_event(OPMS_EVENT_STOP)->detail);
    bench_bring_to(OPMS_BOX_WAITING);
    bench_pass(MS(100));
    TEST_ASSERT_EQUAL(OPMS_BOX_WAITING, box_state(&box));
    bench_start_edge(125);
    bench_pass(OPMS_BOX_START_CYCLES);
    bench_pulse();
    bench_drain();
    TEST_ASSERT_EQUAL(7, bench_the_event(OPMS_EVENT_START)->argument);
    TEST_ASSERT_BITS_LOW(OPMS_TRIGGER_PREAMBLE_CUT, reports.triggers[0].flags);
}

static void test_a_glitch_tells_its_edge_and_length_and_starts_nothing(void)
{
    bench_bring_to(OPMS_BOX_WAITING);
    bench_glitch(124);
    bench_pass(MS(10));
    bench_drain();

    const opms_event_report_t *event = bench_the_event(OPMS_EVENT_GLITCH);
    TEST_ASSERT_EQUAL(124, event->argument);
    check_time(now - MS(10), event->time);
    TEST_ASSERT_EQUAL(OPMS_BOX_WAITING, event->state);
    TEST_ASSERT_EQUAL(1, box.glitches);
    TEST_ASSERT_EQUAL(OPMS_BOX_WAITING, box_state(&box));
    TEST_ASSERT_EQUAL(0, reports.trigger_count);
}

static void test_a_wait_ends_after_its_timeout_and_not_before(void)
{
    const uint16_t seconds[] = {1, 60, 65535};
    for (unsigned i = 0; i < 3; i++) {
        const opms_settings_t settings = settings_with(125, seconds[i]);
        bench_power_on(&settings);
        bench_bring_to(OPMS_BOX_WAITING);

        bench_pass(seconds[i] * BOX_CYCLES_PER_S - 1);
        TEST_ASSERT_EQUAL_HEX32(0, box_take_actions(&box));
        bench_pass(1);
        TEST_ASSERT_EQUAL_HEX32(BOX_DO_STOP, box_take_actions(&box));
        bench_pass(MS(50));
        TEST_ASSERT_EQUAL_HEX32_MESSAGE(0, box_take_actions(&box), "told once");
        bench_stopped();
        bench_drain();

        TEST_ASSERT_EQUAL(OPMS_BOX_IDLE, box_state(&box));
        TEST_ASSERT_EQUAL(6, bench_the_event(OPMS_EVENT_WAIT_TIMEOUT)->argument);
        for (uint32_t k = 0; k < reports.event_count; k++) {
            TEST_ASSERT_NOT_EQUAL(OPMS_EVENT_STOP, reports.events[k].kind);
        }
    }
}

static void test_a_start_while_the_timeout_stops_the_box_still_begins_its_run_and_is_stopped(void)
{
    const opms_settings_t settings = settings_with(125, 1);
    bench_power_on(&settings);
    bench_bring_to(OPMS_BOX_WAITING);
    bench_pass(BOX_CYCLES_PER_S);
    TEST_ASSERT_EQUAL_HEX32(BOX_DO_STOP, box_take_actions(&box));

    bench_start_edge(125);
    bench_pass(OPMS_BOX_START_CYCLES);
    bench_pulse();
    bench_stopped();
    bench_drain();

    TEST_ASSERT_EQUAL(OPMS_BOX_IDLE, box_state(&box));
    TEST_ASSERT_EQUAL(7, bench_the_event(OPMS_EVENT_START)->argument);
    TEST_ASSERT_EQUAL(7, bench_the_event(OPMS_EVENT_STOP)->argument);
    TEST_ASSERT_EQUAL(1, reports.trigger_count);
}

static void test_the_timeout_counts_only_while_the_box_waits(void)
{
    const opms_settings_t settings = settings_with(125, 1);
    const opms_box_state_t states[] = {OPMS_BOX_IDLE, OPMS_BOX_ARMED, OPMS_BOX_PREAMBLE,
                                       OPMS_BOX_RUNNING};
    for (unsigned i = 0; i < 4; i++) {
        bench_power_on(&settings);
        bench_bring_to(states[i]);
        bench_pass(10 * BOX_CYCLES_PER_S);
        TEST_ASSERT_EQUAL_HEX32(0, box_take_actions(&box));
        TEST_ASSERT_EQUAL(states[i], box_state(&box));
    }
}

static void test_an_input_from_after_the_tick_does_not_time_out(void)
{
    const opms_settings_t settings = settings_with(125, 1);
    bench_power_on(&settings);
    bench_bring_to(OPMS_BOX_WAITING);
    box_tick(&box, now - MS(1)); /* read before the input was */
    TEST_ASSERT_EQUAL_HEX32(0, box_take_actions(&box));
    TEST_ASSERT_EQUAL(OPMS_BOX_WAITING, box_state(&box));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_start_edge_is_debounce_and_four_cycles_before_the_first_pulse);
    RUN_TEST(test_the_run_keeps_its_start_edge_and_first_number);
    RUN_TEST(test_pulses_of_the_preamble_say_so_and_know_no_run);
    RUN_TEST(test_start_within_the_preamble_cuts_it_after_any_of_its_pulses);
    RUN_TEST(test_a_pulse_of_the_preamble_within_the_debounce_is_not_of_the_run);
    RUN_TEST(test_of_two_pulses_at_once_the_later_is_the_first_of_the_run);
    RUN_TEST(test_of_two_pulses_at_once_the_later_is_the_runs_first);
    RUN_TEST(test_of_two_pulses_a_period_apart_the_first_is_the_runs);
    RUN_TEST(test_the_runs_first_pulse_is_told_without_a_second);
    RUN_TEST(test_a_stop_at_once_after_the_first_pulse_still_tells_the_run);
    RUN_TEST(test_start_after_the_last_pulse_of_the_preamble_cuts_nothing);
    RUN_TEST(test_further_starts_are_refused_and_disturb_nothing);
    RUN_TEST(test_a_refused_start_tells_the_state_and_its_edge);
    RUN_TEST(test_a_start_before_arming_does_not_start_the_next_session);
    RUN_TEST(test_a_start_without_its_pulse_leaves_nothing_to_the_next_session);
    RUN_TEST(test_a_glitch_tells_its_edge_and_length_and_starts_nothing);
    RUN_TEST(test_a_wait_ends_after_its_timeout_and_not_before);
    RUN_TEST(test_a_start_while_the_timeout_stops_the_box_still_begins_its_run_and_is_stopped);
    RUN_TEST(test_the_timeout_counts_only_while_the_box_waits);
    RUN_TEST(test_an_input_from_after_the_tick_does_not_time_out);
    return UNITY_END();
}
