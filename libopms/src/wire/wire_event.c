/* SPDX-License-Identifier: Apache-2.0 */
#include "wire_bytes.h"
#include "wire_frame.h"

enum {
    KIND = 2,
    STATE = 3,
    BOOT = 4,
    SESSION = 8,
    REPORT_NUMBER = 12,
    EVENT_NUMBER = 16,
    TIME_US = 20,
    TIME_CYCLES = 28,
    ARGUMENT = 32,
    DETAIL = 36
};

void opms_wire_write_event(const opms_event_report_t *report, uint8_t *bytes)
{
    wire_begin(bytes, OPMS_REPORT_EVENT);
    bytes[KIND] = (uint8_t)report->kind;
    bytes[STATE] = (uint8_t)report->state;
    put_u32(bytes + BOOT, report->boot_id);
    put_u32(bytes + SESSION, report->session_id);
    put_u32(bytes + REPORT_NUMBER, report->report_number);
    put_u32(bytes + EVENT_NUMBER, report->event_number);
    put_time(bytes + TIME_US, bytes + TIME_CYCLES, report->time);
    put_u32(bytes + ARGUMENT, report->argument);
    put_u32(bytes + DETAIL, report->detail);
    wire_seal(bytes);
}

static opms_event_report_t decode_event(const uint8_t *bytes)
{
    opms_event_report_t report = {
        .kind = (opms_event_kind_t)bytes[KIND],
        .state = (opms_box_state_t)bytes[STATE],
        .boot_id = get_u32(bytes + BOOT),
        .session_id = get_u32(bytes + SESSION),
        .report_number = get_u32(bytes + REPORT_NUMBER),
        .event_number = get_u32(bytes + EVENT_NUMBER),
        .time = get_time(bytes + TIME_US, bytes + TIME_CYCLES),
        .argument = get_u32(bytes + ARGUMENT),
        .detail = get_u32(bytes + DETAIL),
    };
    return report;
}

opms_wire_result_t opms_wire_read_event(const uint8_t *bytes, size_t size,
                                        opms_event_report_t *report)
{
    const opms_wire_result_t result = wire_open(bytes, size, OPMS_REPORT_EVENT);
    if (result != OPMS_WIRE_OK) {
        return result;
    }
    if (bytes[KIND] < OPMS_EVENT_ARMED || bytes[KIND] > OPMS_EVENT_ENDPOINT_HEALED ||
        bytes[STATE] > OPMS_BOX_RUNNING) {
        return OPMS_WIRE_VALUE;
    }
    const opms_event_report_t got = decode_event(bytes);
    uint8_t again[OPMS_WIRE_SIZE];
    opms_wire_write_event(&got, again);
    if (got.boot_id == 0 || !is_time(got.time) || !wire_same(bytes, again)) {
        return OPMS_WIRE_VALUE;
    }
    if (report != NULL) {
        *report = got;
    }
    return OPMS_WIRE_OK;
}
