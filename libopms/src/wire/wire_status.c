/* SPDX-License-Identifier: Apache-2.0 */
#include "wire_bytes.h"
#include "wire_frame.h"

enum {
    STATE = 2,
    RESET_CAUSE = 3,
    BOOT = 4,
    SESSION = 8,
    REPORT_NUMBER = 12,
    UPTIME_US = 16,
    TRIGGER_NUMBER = 24,
    FIRST_RUN_NUMBER = 28,
    GLITCHES = 32,
    STARTS_REFUSED = 36,
    STROBES_MISSING = 40,
    DROPPED = 44,
    COMMANDS_REFUSED = 48,
    REENUMERATIONS = 52,
    SETTINGS_CRC = 54
};

void opms_wire_write_status(const opms_status_report_t *report, uint8_t *bytes)
{
    wire_begin(bytes, OPMS_REPORT_STATUS);
    bytes[STATE] = (uint8_t)report->state;
    bytes[RESET_CAUSE] = (uint8_t)report->reset_cause;
    put_u32(bytes + BOOT, report->boot_id);
    put_u32(bytes + SESSION, report->session_id);
    put_u32(bytes + REPORT_NUMBER, report->report_number);
    put_u64(bytes + UPTIME_US, report->uptime_us);
    put_u32(bytes + TRIGGER_NUMBER, report->trigger_number);
    put_u32(bytes + FIRST_RUN_NUMBER, report->first_run_number);
    put_u32(bytes + GLITCHES, report->glitches);
    put_u32(bytes + STARTS_REFUSED, report->starts_refused);
    put_u32(bytes + STROBES_MISSING, report->strobes_missing);
    put_u32(bytes + DROPPED, report->dropped);
    put_u32(bytes + COMMANDS_REFUSED, report->commands_refused);
    put_u16(bytes + REENUMERATIONS, report->reenumerations);
    put_u16(bytes + SETTINGS_CRC, report->settings_crc);
    wire_seal(bytes);
}

static opms_status_report_t decode_status(const uint8_t *bytes)
{
    opms_status_report_t report = {
        .state = (opms_box_state_t)bytes[STATE],
        .reset_cause = (opms_reset_cause_t)bytes[RESET_CAUSE],
        .boot_id = get_u32(bytes + BOOT),
        .session_id = get_u32(bytes + SESSION),
        .report_number = get_u32(bytes + REPORT_NUMBER),
        .uptime_us = get_u64(bytes + UPTIME_US),
        .trigger_number = get_u32(bytes + TRIGGER_NUMBER),
        .first_run_number = get_u32(bytes + FIRST_RUN_NUMBER),
        .glitches = get_u32(bytes + GLITCHES),
        .starts_refused = get_u32(bytes + STARTS_REFUSED),
        .strobes_missing = get_u32(bytes + STROBES_MISSING),
        .dropped = get_u32(bytes + DROPPED),
        .commands_refused = get_u32(bytes + COMMANDS_REFUSED),
        .reenumerations = get_u16(bytes + REENUMERATIONS),
        .settings_crc = get_u16(bytes + SETTINGS_CRC),
    };
    return report;
}

opms_wire_result_t opms_wire_read_status(const uint8_t *bytes, size_t size,
                                         opms_status_report_t *report)
{
    const opms_wire_result_t result = wire_open(bytes, size, OPMS_REPORT_STATUS);
    if (result != OPMS_WIRE_OK) {
        return result;
    }
    if (bytes[STATE] > OPMS_BOX_RUNNING || bytes[RESET_CAUSE] > OPMS_RESET_SOFTWARE) {
        return OPMS_WIRE_VALUE;
    }
    const opms_status_report_t got = decode_status(bytes);
    uint8_t again[OPMS_WIRE_SIZE];
    opms_wire_write_status(&got, again);
    if (got.boot_id == 0 || !wire_same(bytes, again)) {
        return OPMS_WIRE_VALUE;
    }
    if (report != NULL) {
        *report = got;
    }
    return OPMS_WIRE_OK;
}
