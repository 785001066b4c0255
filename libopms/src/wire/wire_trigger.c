/* SPDX-License-Identifier: Apache-2.0 */
#include "wire_bytes.h"
#include "wire_flags.h"
#include "wire_frame.h"

enum {
    FLAGS = 2,
    BOOT = 4,
    SESSION = 8,
    REPORT_NUMBER = 12,
    TRIGGER_NUMBER = 16,
    TIME_US = 20,
    START_US = 28,
    TIME_CYCLES = 36,
    START_CYCLES = 37,
    DROPPED = 38,
    FIRST_RUN_NUMBER = 40,
    STROBE_FOR = 44,
    STROBE_DELAY = 48,
    STROBE_LENGTH = 52,
    GAP_1 = 56,
    GAP_2 = 59
};

/* A gap that does not fit is told as none. */
static void put_gap(uint8_t *at, uint32_t gap_us)
{
    put_u24(at, gap_us <= 0xFFFFFFU ? gap_us : 0);
}

void opms_wire_write_trigger(const opms_trigger_report_t *report, uint8_t *bytes)
{
    wire_begin(bytes, OPMS_REPORT_TRIGGER);
    put_u16(bytes + FLAGS, report->flags);
    put_u32(bytes + BOOT, report->boot_id);
    put_u32(bytes + SESSION, report->session_id);
    put_u32(bytes + REPORT_NUMBER, report->report_number);
    put_u32(bytes + TRIGGER_NUMBER, report->trigger_number);
    put_time(bytes + TIME_US, bytes + TIME_CYCLES, report->time);
    put_time(bytes + START_US, bytes + START_CYCLES, report->start_edge);
    put_u16(bytes + DROPPED, report->dropped);
    put_u32(bytes + FIRST_RUN_NUMBER, report->first_run_number);
    put_u32(bytes + STROBE_FOR, report->strobe_for_trigger);
    put_u32(bytes + STROBE_DELAY, report->strobe_delay_cycles);
    put_u32(bytes + STROBE_LENGTH, report->strobe_length_cycles);
    put_gap(bytes + GAP_1, report->gap_us[0]);
    put_gap(bytes + GAP_2, report->gap_us[1]);
    wire_seal(bytes);
}

static opms_trigger_report_t decode_trigger(const uint8_t *bytes)
{
    opms_trigger_report_t report = {
        .flags = get_u16(bytes + FLAGS),
        .boot_id = get_u32(bytes + BOOT),
        .session_id = get_u32(bytes + SESSION),
        .report_number = get_u32(bytes + REPORT_NUMBER),
        .trigger_number = get_u32(bytes + TRIGGER_NUMBER),
        .time = get_time(bytes + TIME_US, bytes + TIME_CYCLES),
        .start_edge = get_time(bytes + START_US, bytes + START_CYCLES),
        .first_run_number = get_u32(bytes + FIRST_RUN_NUMBER),
        .strobe_for_trigger = get_u32(bytes + STROBE_FOR),
        .strobe_delay_cycles = get_u32(bytes + STROBE_DELAY),
        .strobe_length_cycles = get_u32(bytes + STROBE_LENGTH),
        .gap_us = {get_u24(bytes + GAP_1), get_u24(bytes + GAP_2)},
        .dropped = get_u16(bytes + DROPPED),
    };
    return report;
}

static bool is_strobe(const opms_trigger_report_t *report)
{
    return (report->flags & OPMS_TRIGGER_STROBE) != 0 ||
           (report->strobe_for_trigger == 0 && report->strobe_delay_cycles == 0 &&
            report->strobe_length_cycles == 0);
}

static bool is_trigger(const opms_trigger_report_t *report)
{
    return are_pulse_flags(report->flags) && report->boot_id != 0 && report->session_id != 0 &&
           is_time(report->time) && is_time(report->start_edge) && is_strobe(report);
}

opms_wire_result_t opms_wire_read_trigger(const uint8_t *bytes, size_t size,
                                          opms_trigger_report_t *report)
{
    const opms_wire_result_t result = wire_open(bytes, size, OPMS_REPORT_TRIGGER);
    if (result != OPMS_WIRE_OK) {
        return result;
    }
    const opms_trigger_report_t got = decode_trigger(bytes);
    if (!is_trigger(&got)) {
        return OPMS_WIRE_VALUE;
    }
    if (report != NULL) {
        *report = got;
    }
    return OPMS_WIRE_OK;
}
