/* SPDX-License-Identifier: Apache-2.0 */
#include "wire_bytes.h"
#include "wire_frame.h"

enum {
    BOOT = 4,
    REPORT_NUMBER = 8,
    PING_ID = 12,
    RECEIVED_US = 16,
    SENT_US = 24,
    RECEIVED_CYCLES = 32,
    SENT_CYCLES = 33
};

void opms_wire_write_pong(const opms_pong_report_t *report, uint8_t *bytes)
{
    wire_begin(bytes, OPMS_REPORT_PONG);
    put_u32(bytes + BOOT, report->boot_id);
    put_u32(bytes + REPORT_NUMBER, report->report_number);
    put_u32(bytes + PING_ID, report->ping_id);
    put_time(bytes + RECEIVED_US, bytes + RECEIVED_CYCLES, report->received);
    put_time(bytes + SENT_US, bytes + SENT_CYCLES, report->sent);
    wire_seal(bytes);
}

opms_wire_result_t opms_wire_read_pong(const uint8_t *bytes, size_t size,
                                       opms_pong_report_t *report)
{
    const opms_wire_result_t result = wire_open(bytes, size, OPMS_REPORT_PONG);
    if (result != OPMS_WIRE_OK) {
        return result;
    }
    const opms_pong_report_t got = {
        .boot_id = get_u32(bytes + BOOT),
        .report_number = get_u32(bytes + REPORT_NUMBER),
        .ping_id = get_u32(bytes + PING_ID),
        .received = get_time(bytes + RECEIVED_US, bytes + RECEIVED_CYCLES),
        .sent = get_time(bytes + SENT_US, bytes + SENT_CYCLES),
    };
    uint8_t again[OPMS_WIRE_SIZE];
    opms_wire_write_pong(&got, again);
    if (got.boot_id == 0 || !is_time(got.received) || !is_time(got.sent) ||
        !wire_same(bytes, again)) {
        return OPMS_WIRE_VALUE;
    }
    if (report != NULL) {
        *report = got;
    }
    return OPMS_WIRE_OK;
}
