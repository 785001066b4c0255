/* SPDX-License-Identifier: Apache-2.0 */
/* Every state of the box against everything that can happen to it. */
#include <stdio.h>

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

enum { STATES = OPMS_BOX_RUNNING + 1, NO_EVENT = 0 };

/* What one stimulus does in each state: IDLE, ARMED, PREAMBLE, WAITING, RUNNING. */
typedef struct row {
    const char *name;
    void (*happen)(void);
    opms_box_state_t after[STATES];
    uint32_t actions[STATES];
    int event[STATES]; /* the first one, or NO_EVENT */
    opms_refusal_t refusal[STATES];
} row_t;

static void arm(void)
{
    bench_command(OPMS_COMMAND_ARM, SESSION + 1);
}

static void disarm(void)
{
    bench_command(OPMS_COMMAND_DISARM, 0);
}

static void ping(void)
{
    bench_command(OPMS_COMMAND_PING, 7);
}

static void start(void)
{
    bench_start_edge(box_settings(&box)->debounce_cycles);
}

static void start_and_pulse(void)
{
    start();
    now += OPMS_BOX_START_CYCLES;
    if (box_state(&box) >= OPMS_BOX_PREAMBLE) {
        bench_pulse(); /* before that the hardware sends none */
    }
}

static void glitch(void)
{
    bench_glitch(3);
}

static void set_settings(void)
{
    opms_settings_t settings = *box_settings(&box);
    settings.period_us = 50000;
    bench_set_settings(&settings);
}

static void select_history(void)
{
    bench_select(9, SESSION, 1, 1);
}

static void heal(void)
{
    box_endpoint_healed(&box, now);
}

static void strobe(void)
{
    bench_strobe(5, 3);
}

static void wait_a_day(void)
{
    bench_pass(24 * 3600 * BOX_CYCLES_PER_S);
}

#define SAME                                                                                       \
    {                                                                                              \
        OPMS_BOX_IDLE, OPMS_BOX_ARMED, OPMS_BOX_PREAMBLE, OPMS_BOX_WAITING, OPMS_BOX_RUNNING       \
    }
#define IN_IDLE_ONLY                                                                               \
    {                                                                                              \
        OPMS_REFUSAL_NONE, OPMS_REFUSAL_STATE, OPMS_REFUSAL_STATE, OPMS_REFUSAL_STATE,             \
            OPMS_REFUSAL_STATE                                                                     \
    }
#define REFUSED_BUT_IDLE                                                                           \
    {                                                                                              \
        NO_EVENT, OPMS_EVENT_REFUSED, OPMS_EVENT_REFUSED, OPMS_EVENT_REFUSED, OPMS_EVENT_REFUSED   \
    }
#define ALWAYS(event)                                                                              \
    {                                                                                              \
        event, event, event, event, event                                                          \
    }

static const row_t rows[] = {
    {"ARM",
     arm,
     {OPMS_BOX_ARMED, OPMS_BOX_ARMED, OPMS_BOX_PREAMBLE, OPMS_BOX_WAITING, OPMS_BOX_RUNNING},
     {BOX_DO_ARM, 0, 0, 0, 0},
     {OPMS_EVENT_ARMED, OPMS_EVENT_REFUSED, OPMS_EVENT_REFUSED, OPMS_EVENT_REFUSED,
      OPMS_EVENT_REFUSED},
     IN_IDLE_ONLY},
    {"DISARM",
     disarm,
     SAME,
     {0, BOX_DO_STOP, BOX_DO_STOP, BOX_DO_STOP, BOX_DO_STOP},
     {OPMS_EVENT_STOP, 0, 0, 0, 0},
     {0}},
    {"PING", ping, SAME, {0}, {0}, {0}},
    {"START",
     start,
     SAME,
     {0},
     {OPMS_EVENT_START_REFUSED, OPMS_EVENT_START_REFUSED, 0, 0, OPMS_EVENT_START_REFUSED},
     {0}},
    {"START and the next pulse",
     start_and_pulse,
     {OPMS_BOX_IDLE, OPMS_BOX_ARMED, OPMS_BOX_RUNNING, OPMS_BOX_RUNNING, OPMS_BOX_RUNNING},
     {0},
     {OPMS_EVENT_START_REFUSED, OPMS_EVENT_START_REFUSED, OPMS_EVENT_PREAMBLE_CUT, OPMS_EVENT_START,
      OPMS_EVENT_START_REFUSED},
     {0}},
    {"a glitch", glitch, SAME, {0}, ALWAYS(OPMS_EVENT_GLITCH), {0}},
    {"the hardware is armed",
     bench_armed,
     {OPMS_BOX_IDLE, OPMS_BOX_PREAMBLE, OPMS_BOX_PREAMBLE, OPMS_BOX_WAITING, OPMS_BOX_RUNNING},
     {0},
     {0},
     {0}},
    {"the hardware has stopped",
     bench_stopped,
     {OPMS_BOX_IDLE, OPMS_BOX_IDLE, OPMS_BOX_IDLE, OPMS_BOX_IDLE, OPMS_BOX_IDLE},
     {0},
     {0, OPMS_EVENT_STOP, OPMS_EVENT_STOP, OPMS_EVENT_STOP, OPMS_EVENT_STOP},
     {0}},
    {"a strobe", strobe, SAME, {0}, {0}, {0}},
    {"SET SETTINGS",
     set_settings,
     SAME,
     {BOX_DO_STORE_SETTINGS, 0, 0, 0, 0},
     REFUSED_BUT_IDLE,
     IN_IDLE_ONLY},
    {"SET BOOTLOADER",
     bench_bootloader,
     SAME,
     {BOX_DO_BOOTLOADER, 0, 0, 0, 0},
     REFUSED_BUT_IDLE,
     IN_IDLE_ONLY},
    {"SET HISTORY", select_history, SAME, {0}, {0}, {0}},
    {"the endpoint is healed", heal, SAME, {0}, ALWAYS(OPMS_EVENT_ENDPOINT_HEALED), {0}},
    {"a day without a START", wait_a_day, SAME, {0}, {0}, {0}},
};

static void check_cell(const row_t *row, unsigned state)
{
    char name[100];
    snprintf(name, sizeof name, "%s in %s", row->name,
             opms_box_state_name((opms_box_state_t)state));
    bench_power_on(NULL);
    bench_bring_to((opms_box_state_t)state);
    const uint32_t refused_before = box.commands_refused;

    row->happen();

    const int refused = row->refusal[state] != OPMS_REFUSAL_NONE;
    TEST_ASSERT_EQUAL_MESSAGE(row->after[state], box_state(&box), name);
    TEST_ASSERT_EQUAL_HEX32_MESSAGE(row->actions[state], box_take_actions(&box), name);
    TEST_ASSERT_EQUAL_HEX32_MESSAGE(0, box_take_actions(&box), "an action is told once");
    TEST_ASSERT_EQUAL_MESSAGE(refused_before + (uint32_t)refused, box.commands_refused, name);
    bench_drain();
    TEST_ASSERT_EQUAL_MESSAGE(row->event[state] != NO_EVENT, reports.event_count > 0, name);
    if (reports.event_count > 0) {
        TEST_ASSERT_EQUAL_MESSAGE(row->event[state], reports.events[0].kind, name);
        TEST_ASSERT_EQUAL_MESSAGE(row->refusal[state], reports.events[0].detail, name);
    }
}

static void test_each_stimulus_does_in_each_state_what_the_table_says(void)
{
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        for (unsigned state = 0; state < STATES; state++) {
            check_cell(&rows[i], state);
        }
    }
}

static void test_a_whole_session_tells_its_states_in_order(void)
{
    const opms_event_kind_t kinds[] = {OPMS_EVENT_ARMED, OPMS_EVENT_WAITING, OPMS_EVENT_START,
                                       OPMS_EVENT_STOP};
    const opms_box_state_t states[] = {OPMS_BOX_ARMED, OPMS_BOX_WAITING, OPMS_BOX_RUNNING,
                                       OPMS_BOX_IDLE};
    const uint32_t arguments[] = {SESSION, 6, 7, 7};
    bench_reports_t *all = &reports;
    bench_bring_to(OPMS_BOX_RUNNING);
    TEST_ASSERT_EQUAL(3, all->event_count);
    for (unsigned i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL(kinds[i], all->events[i].kind);
        TEST_ASSERT_EQUAL(states[i], all->events[i].state);
        TEST_ASSERT_EQUAL_HEX32(arguments[i], all->events[i].argument);
        TEST_ASSERT_EQUAL(i + 1, all->events[i].event_number);
        TEST_ASSERT_EQUAL_HEX32(SESSION, all->events[i].session_id);
        TEST_ASSERT_EQUAL_HEX32(BOOT, all->events[i].boot_id);
    }

    bench_stop();
    bench_drain();

    TEST_ASSERT_EQUAL(1, all->event_count);
    TEST_ASSERT_EQUAL(kinds[3], all->events[0].kind);
    TEST_ASSERT_EQUAL(states[3], all->events[0].state);
    TEST_ASSERT_EQUAL(arguments[3], all->events[0].argument);
}

static void test_disarm_in_any_state_ends_in_idle_with_one_stop(void)
{
    for (unsigned state = OPMS_BOX_ARMED; state < STATES; state++) {
        bench_power_on(NULL);
        bench_bring_to((opms_box_state_t)state);
        const uint32_t last = pulses;

        bench_command(OPMS_COMMAND_DISARM, 0);
        TEST_ASSERT_EQUAL_HEX32(BOX_DO_STOP, box_take_actions(&box));
        bench_command(OPMS_COMMAND_DISARM, 0);
        TEST_ASSERT_EQUAL_HEX32_MESSAGE(0, box_take_actions(&box), "stopping already");
        bench_stopped();
        bench_drain();

        TEST_ASSERT_EQUAL(OPMS_BOX_IDLE, box_state(&box));
        TEST_ASSERT_EQUAL(last, bench_the_event(OPMS_EVENT_STOP)->argument);
    }
}

static void test_a_pulse_that_leaves_while_the_box_stops_is_told(void)
{
    bench_bring_to(OPMS_BOX_RUNNING);
    bench_command(OPMS_COMMAND_DISARM, 0);
    box_take_actions(&box);

    bench_next_pulse();
    bench_stopped();
    bench_drain();

    TEST_ASSERT_EQUAL(1, reports.trigger_count);
    TEST_ASSERT_EQUAL(8, reports.triggers[0].trigger_number);
    TEST_ASSERT_EQUAL(8, bench_the_event(OPMS_EVENT_STOP)->argument);
}

static void test_a_disarm_before_the_hardware_was_armed_cancels(void)
{
    bench_command(OPMS_COMMAND_ARM, SESSION);
    bench_command(OPMS_COMMAND_DISARM, 0);

    TEST_ASSERT_EQUAL_HEX32(0, box_take_actions(&box));
    TEST_ASSERT_EQUAL(OPMS_BOX_IDLE, box_state(&box));
    bench_drain();
    bench_the_event(OPMS_EVENT_ARMED);
    TEST_ASSERT_EQUAL(0, bench_the_event(OPMS_EVENT_STOP)->argument);
    bench_bring_to(OPMS_BOX_RUNNING);
}

static void test_arming_is_refused_until_the_stop_is_done(void)
{
    bench_bring_to(OPMS_BOX_RUNNING);
    bench_command(OPMS_COMMAND_DISARM, 0);
    bench_command(OPMS_COMMAND_ARM, SESSION + 1);
    bench_drain();
    TEST_ASSERT_EQUAL(OPMS_REFUSAL_STATE, bench_the_event(OPMS_EVENT_REFUSED)->detail);
    TEST_ASSERT_EQUAL_HEX32(BOX_DO_STOP, box_take_actions(&box));

    bench_stopped();
    bench_command(OPMS_COMMAND_ARM, SESSION + 1);

    TEST_ASSERT_EQUAL(OPMS_BOX_ARMED, box_state(&box));
    TEST_ASSERT_EQUAL_HEX32(BOX_DO_ARM, box_take_actions(&box));
}

static void test_without_a_preamble_the_armed_box_waits_at_once(void)
{
    opms_settings_t settings;
    opms_wire_default_settings(&settings);
    settings.preamble_gap_ms[0] = 0;
    for (unsigned i = 1; i < OPMS_BOX_PREAMBLE_MAX; i++) {
        settings.preamble_gap_ms[i] = 0;
    }
    bench_power_on(&settings);
    bench_command(OPMS_COMMAND_ARM, SESSION);
    box_take_actions(&box);

    bench_armed();

    TEST_ASSERT_EQUAL(OPMS_BOX_WAITING, box_state(&box));
    bench_drain();
    TEST_ASSERT_EQUAL(0, bench_the_event(OPMS_EVENT_WAITING)->argument);
}

static void test_a_preamble_of_one_gap_has_two_pulses_and_the_longest_nine(void)
{
    for (unsigned gaps = 1; gaps <= OPMS_BOX_PREAMBLE_MAX; gaps++) {
        opms_settings_t settings;
        opms_wire_default_settings(&settings);
        for (unsigned i = 0; i < OPMS_BOX_PREAMBLE_MAX; i++) {
            settings.preamble_gap_ms[i] = i < gaps ? 100 : 0;
        }
        bench_power_on(&settings);
        bench_bring_to(OPMS_BOX_PREAMBLE);
        for (unsigned pulse = 1; pulse <= gaps; pulse++) {
            bench_pulse();
            TEST_ASSERT_EQUAL(OPMS_BOX_PREAMBLE, box_state(&box));
        }
        bench_pulse();
        TEST_ASSERT_EQUAL(OPMS_BOX_WAITING, box_state(&box));
    }
}

static void test_a_thousand_sessions_each_count_from_one_and_end_in_idle(void)
{
    uint32_t last_report = 0, last_event = 0;
    for (uint32_t session = 1; session <= 1000; session++) {
        const opms_box_state_t reach = (opms_box_state_t)(1 + session % 4);
        bench_command(OPMS_COMMAND_ARM, session);
        TEST_ASSERT_EQUAL_HEX32(BOX_DO_ARM, box_take_actions(&box));
        pulses = 0;
        if (reach >= OPMS_BOX_PREAMBLE) {
            bench_armed();
            bench_pulse();
        }
        if (reach == OPMS_BOX_RUNNING) {
            start_and_pulse();
        }
        bench_drain();
        for (uint32_t i = 0; i < reports.trigger_count; i++) {
            TEST_ASSERT_EQUAL(i + 1, reports.triggers[i].trigger_number);
            TEST_ASSERT_EQUAL(session, reports.triggers[i].session_id);
        }
        TEST_ASSERT_EQUAL(pulses, reports.trigger_count);
        bench_stop();
        bench_pass(MS(1));
        while (bench_take_report() != 0) {
        }
        for (uint32_t i = 0; i < reports.event_count; i++) {
            TEST_ASSERT_EQUAL(last_event + 1, reports.events[i].event_number);
            TEST_ASSERT_TRUE(reports.events[i].report_number > last_report);
            last_event++;
            last_report = reports.events[i].report_number;
        }
    }
    TEST_ASSERT_EQUAL(0, box.dropped);
    TEST_ASSERT_EQUAL(0, box.commands_refused);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_each_stimulus_does_in_each_state_what_the_table_says);
    RUN_TEST(test_a_whole_session_tells_its_states_in_order);
    RUN_TEST(test_disarm_in_any_state_ends_in_idle_with_one_stop);
    RUN_TEST(test_a_pulse_that_leaves_while_the_box_stops_is_told);
    RUN_TEST(test_a_disarm_before_the_hardware_was_armed_cancels);
    RUN_TEST(test_arming_is_refused_until_the_stop_is_done);
    RUN_TEST(test_without_a_preamble_the_armed_box_waits_at_once);
    RUN_TEST(test_a_preamble_of_one_gap_has_two_pulses_and_the_longest_nine);
    RUN_TEST(test_a_thousand_sessions_each_count_from_one_and_end_in_idle);
    return UNITY_END();
}
