/* SPDX-License-Identifier: Apache-2.0 */
#include "firmware_bench.h"

#include <string.h>

#include <unity.h>

box_t box;
box_cycles_t now;
uint32_t pulses;
bench_reports_t reports;

void bench_power_on(const opms_settings_t *settings)
{
    const box_identity_t identity = {
        .report = {.hardware_version = 1,
                   .firmware_version = {0, 2, 0},
                   .capabilities = OPMS_CAPABILITY_HISTORY,
                   .unique_id = {1, 2, 3, 4, 5, 6, 7, 8},
                   .git_hash = "0123456789abcdef0123",
                   .boot_id = BOOT,
                   .clock_hz = OPMS_BOX_CLOCK_HZ,
                   .start_cycles = OPMS_BOX_START_CYCLES,
                   .ring_entries = OPMS_BOX_RING_ENTRIES,
                   .history_entries = OPMS_BOX_HISTORY_ENTRIES},
        .reset_cause = OPMS_RESET_POWER,
    };
    now = MS(1);
    pulses = 0;
    memset(&reports, 0, sizeof reports);
    box_init(&box, &identity, settings);
}

void bench_pass(box_cycles_t cycles)
{
    while (cycles > 0) {
        const box_cycles_t step = cycles < MS(50) ? cycles : MS(50);
        now += step;
        cycles -= step;
        box_tick(&box, now);
    }
}

static void tell(box_input_kind_t kind, box_cycles_t time, uint32_t number, uint32_t length)
{
    const box_input_t input = {kind, time, number, length};
    box_input(&box, &input);
    /* The loop goes on: a pulse that may be the run's first is held for a moment. */
    box_tick(&box, (time > now ? time : now) + 20);
}

void bench_pulse_number(uint32_t number)
{
    pulses = number;
    tell(BOX_INPUT_PULSE, now, number, 0);
}

void bench_pulse(void)
{
    bench_pulse_number(pulses + 1);
}

void bench_armed(void)
{
    tell(BOX_INPUT_ARMED, now, 0, 0);
}

void bench_stopped(void)
{
    tell(BOX_INPUT_STOPPED, now, 0, 0);
}

void bench_glitch(uint32_t length_cycles)
{
    tell(BOX_INPUT_GLITCH, now, 0, length_cycles);
}

void bench_start_edge(box_cycles_t ago)
{
    tell(BOX_INPUT_START, now - ago, 0, 0);
}

void bench_strobe(box_cycles_t ago, uint32_t length_cycles)
{
    tell(BOX_INPUT_STROBE, now - ago, 0, length_cycles);
}

void bench_command(opms_command_opcode_t opcode, uint32_t argument)
{
    const opms_command_report_t command = {opcode, argument};
    uint8_t bytes[OPMS_WIRE_SIZE];
    opms_wire_write_command(&command, bytes);
    box_command(&box, bytes, sizeof bytes, now);
}

void bench_set_settings(const opms_settings_t *settings)
{
    uint8_t bytes[OPMS_WIRE_SIZE];
    opms_wire_write_settings_set(settings, bytes);
    box_set_feature(&box, bytes, sizeof bytes, now);
}

void bench_bootloader(void)
{
    uint8_t bytes[OPMS_WIRE_SIZE];
    opms_wire_write_bootloader(bytes);
    box_set_feature(&box, bytes, sizeof bytes, now);
}

void bench_select(uint16_t token, uint32_t session_id, uint32_t first, uint16_t count)
{
    const opms_history_request_t request = {token, session_id, first, count};
    uint8_t bytes[OPMS_WIRE_SIZE];
    opms_wire_write_history_request(&request, bytes);
    box_set_feature(&box, bytes, sizeof bytes, now);
}

opms_settings_report_t bench_get_settings(void)
{
    opms_settings_report_t report;
    uint8_t bytes[OPMS_WIRE_SIZE];
    TEST_ASSERT_TRUE(box_get_feature(&box, OPMS_REPORT_SETTINGS, bytes));
    TEST_ASSERT_EQUAL(OPMS_WIRE_OK, opms_wire_read_settings(bytes, sizeof bytes, &report));
    return report;
}

opms_history_report_t bench_get_history(void)
{
    opms_history_report_t report;
    uint8_t bytes[OPMS_WIRE_SIZE];
    TEST_ASSERT_TRUE(box_get_feature(&box, OPMS_REPORT_HISTORY, bytes));
    TEST_ASSERT_EQUAL(OPMS_WIRE_OK, opms_wire_read_history(bytes, sizeof bytes, &report));
    return report;
}

static void send_preamble(void)
{
    bench_pulse();
    for (unsigned gap = 0; gap < box_preamble_gaps(box_settings(&box)); gap++) {
        bench_pass(MS(box_settings(&box)->preamble_gap_ms[gap]));
        bench_pulse();
    }
}

static void start_run(void)
{
    const box_cycles_t debounce = box_settings(&box)->debounce_cycles;
    bench_pass(MS(40));
    bench_start_edge(debounce);
    now += OPMS_BOX_START_CYCLES;
    bench_pulse();
}

void bench_bring_to(opms_box_state_t state)
{
    pulses = 0;
    if (state >= OPMS_BOX_ARMED) {
        bench_command(OPMS_COMMAND_ARM, SESSION);
        TEST_ASSERT_EQUAL_HEX32(BOX_DO_ARM, box_take_actions(&box));
    }
    if (state >= OPMS_BOX_PREAMBLE) {
        bench_armed();
    }
    if (state >= OPMS_BOX_WAITING) {
        send_preamble();
    }
    if (state >= OPMS_BOX_RUNNING) {
        start_run();
    }
    bench_drain();
    TEST_ASSERT_EQUAL_STRING(opms_box_state_name(state), opms_box_state_name(box_state(&box)));
}

void bench_run(void)
{
    pulses = 0;
    bench_command(OPMS_COMMAND_ARM, SESSION);
    TEST_ASSERT_EQUAL_HEX32(BOX_DO_ARM, box_take_actions(&box));
    bench_armed();
    TEST_ASSERT_EQUAL(OPMS_BOX_WAITING, box_state(&box));
    start_run();
    TEST_ASSERT_EQUAL(OPMS_BOX_RUNNING, box_state(&box));
}

void bench_next_pulse(void)
{
    bench_pass(US(box_settings(&box)->period_us));
    bench_pulse();
}

void bench_stop(void)
{
    bench_command(OPMS_COMMAND_DISARM, 0);
    TEST_ASSERT_EQUAL_HEX32(BOX_DO_STOP, box_take_actions(&box));
    bench_stopped();
    TEST_ASSERT_EQUAL(OPMS_BOX_IDLE, box_state(&box));
}

#define ROOM(array) (sizeof(array) / sizeof((array)[0]))

static bool has_room(void)
{
    return reports.trigger_count < ROOM(reports.triggers) &&
           reports.event_count < ROOM(reports.events) && reports.pong_count < ROOM(reports.pongs) &&
           reports.status_count < ROOM(reports.statuses) &&
           reports.order_count < ROOM(reports.order);
}

static void keep(uint8_t id, const uint8_t *bytes)
{
    opms_wire_result_t result = OPMS_WIRE_ID;
    TEST_ASSERT_TRUE_MESSAGE(has_room(), "the bench has no room for more reports");
    if (id == OPMS_REPORT_TRIGGER) {
        result = opms_wire_read_trigger(bytes, OPMS_WIRE_SIZE,
                                        &reports.triggers[reports.trigger_count++]);
    } else if (id == OPMS_REPORT_EVENT) {
        result =
            opms_wire_read_event(bytes, OPMS_WIRE_SIZE, &reports.events[reports.event_count++]);
    } else if (id == OPMS_REPORT_PONG) {
        result = opms_wire_read_pong(bytes, OPMS_WIRE_SIZE, &reports.pongs[reports.pong_count++]);
    } else if (id == OPMS_REPORT_STATUS) {
        result =
            opms_wire_read_status(bytes, OPMS_WIRE_SIZE, &reports.statuses[reports.status_count++]);
    }
    TEST_ASSERT_EQUAL_STRING("OK", opms_wire_result_name(result));
}

uint8_t bench_take_report(void)
{
    uint8_t bytes[OPMS_WIRE_SIZE];
    if (!box_next_report(&box, now, bytes)) {
        return 0;
    }
    keep(bytes[0], bytes);
    reports.order[reports.order_count++] = bytes[0];
    return bytes[0];
}

void bench_drain(void)
{
    memset(&reports, 0, sizeof reports);
    while (bench_take_report() != 0) {
    }
    TEST_ASSERT_FALSE(box_has_report(&box));
}

const opms_event_report_t *bench_the_event(opms_event_kind_t kind)
{
    const opms_event_report_t *found = NULL;
    for (uint32_t i = 0; i < reports.event_count; i++) {
        if (reports.events[i].kind == kind) {
            TEST_ASSERT_NULL_MESSAGE(found, "more than one event of this kind");
            found = &reports.events[i];
        }
    }
    TEST_ASSERT_NOT_NULL_MESSAGE(found, opms_event_name(kind));
    return found;
}
