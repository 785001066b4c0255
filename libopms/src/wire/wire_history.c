/* SPDX-License-Identifier: Apache-2.0 */
#include "wire_bytes.h"
#include "wire_flags.h"
#include "wire_frame.h"

enum { TOKEN = 2 };

/* The request. */
enum { ASKED_SESSION = 4, ASKED_FIRST = 8, ASKED_COUNT = 12 };

/* The answer. */
enum {
    BOOT = 4,
    SESSION = 8,
    FIRST_NUMBER = 12,
    REMAINING = 16,
    COUNT = 18,
    ENTRIES = 20,
    ENTRY_SIZE = 20
};

enum { ENTRY_US = 0, ENTRY_DELAY = 8, ENTRY_LENGTH = 12, ENTRY_CYCLES = 16, ENTRY_FLAGS = 18 };

void opms_wire_write_history_request(const opms_history_request_t *request, uint8_t *bytes)
{
    wire_begin(bytes, OPMS_REPORT_HISTORY);
    put_u16(bytes + TOKEN, request->token);
    put_u32(bytes + ASKED_SESSION, request->session_id);
    put_u32(bytes + ASKED_FIRST, request->first_number);
    put_u16(bytes + ASKED_COUNT, request->count);
    wire_seal(bytes);
}

opms_wire_result_t opms_wire_read_history_request(const uint8_t *bytes, size_t size,
                                                  opms_history_request_t *request)
{
    const opms_wire_result_t result = wire_open(bytes, size, OPMS_REPORT_HISTORY);
    if (result != OPMS_WIRE_OK) {
        return result;
    }
    const opms_history_request_t got = {
        .token = get_u16(bytes + TOKEN),
        .session_id = get_u32(bytes + ASKED_SESSION),
        .first_number = get_u32(bytes + ASKED_FIRST),
        .count = get_u16(bytes + ASKED_COUNT),
    };
    uint8_t again[OPMS_WIRE_SIZE];
    opms_wire_write_history_request(&got, again);
    if (got.token == 0 || got.session_id == 0 || got.first_number == 0 || got.count == 0 ||
        got.count > OPMS_BOX_HISTORY_ENTRIES || !wire_same(bytes, again)) {
        return OPMS_WIRE_VALUE;
    }
    if (request != NULL) {
        *request = got;
    }
    return OPMS_WIRE_OK;
}

static void put_entry(uint8_t *at, const opms_history_entry_t *entry)
{
    put_time(at + ENTRY_US, at + ENTRY_CYCLES, entry->time);
    put_u32(at + ENTRY_DELAY, entry->strobe_delay_cycles);
    put_u32(at + ENTRY_LENGTH, entry->strobe_length_cycles);
    put_u16(at + ENTRY_FLAGS, entry->flags);
}

void opms_wire_write_history(const opms_history_report_t *report, uint8_t *bytes)
{
    wire_begin(bytes, OPMS_REPORT_HISTORY);
    put_u16(bytes + TOKEN, report->token);
    put_u32(bytes + BOOT, report->boot_id);
    put_u32(bytes + SESSION, report->session_id);
    put_u32(bytes + FIRST_NUMBER, report->count > 0 ? report->entries[0].number : 0);
    put_u16(bytes + REMAINING, report->remaining);
    /* Too large a count must not reach beyond the entries; no reader takes it. */
    bytes[COUNT] = (uint8_t)(report->count < UINT8_MAX ? report->count : UINT8_MAX);
    for (uint32_t i = 0; i < report->count && i < OPMS_HISTORY_PER_REPORT; i++) {
        put_entry(bytes + ENTRIES + i * ENTRY_SIZE, &report->entries[i]);
    }
    wire_seal(bytes);
}

static opms_history_report_t decode_history(const uint8_t *bytes)
{
    opms_history_report_t report = {
        .token = get_u16(bytes + TOKEN),
        .boot_id = get_u32(bytes + BOOT),
        .session_id = get_u32(bytes + SESSION),
        .remaining = get_u16(bytes + REMAINING),
        .count = bytes[COUNT],
    };
    for (uint32_t i = 0; i < report.count; i++) {
        const uint8_t *at = bytes + ENTRIES + i * ENTRY_SIZE;
        const opms_history_entry_t entry = {
            .number = get_u32(bytes + FIRST_NUMBER) + i,
            .flags = get_u16(at + ENTRY_FLAGS),
            .time = get_time(at + ENTRY_US, at + ENTRY_CYCLES),
            .strobe_delay_cycles = get_u32(at + ENTRY_DELAY),
            .strobe_length_cycles = get_u32(at + ENTRY_LENGTH),
        };
        report.entries[i] = entry;
    }
    return report;
}

static bool is_entry(const opms_history_entry_t *entry)
{
    const bool no_strobe = entry->strobe_delay_cycles == 0 && entry->strobe_length_cycles == 0;
    if (entry->flags == OPMS_TRIGGER_NOT_HELD) {
        return no_strobe && entry->time.us == 0 && entry->time.cycles == 0;
    }
    return are_pulse_flags(entry->flags) && is_time(entry->time) &&
           (no_strobe || (entry->flags & OPMS_TRIGGER_STROBE) != 0);
}

static bool is_history(const opms_history_report_t *report)
{
    if (report->boot_id == 0 || (report->count == 0 && report->remaining != 0) ||
        report->remaining + report->count > OPMS_BOX_HISTORY_ENTRIES) {
        return false;
    }
    for (uint32_t i = 0; i < report->count; i++) {
        if (!is_entry(&report->entries[i])) {
            return false;
        }
    }
    return true;
}

opms_wire_result_t opms_wire_read_history(const uint8_t *bytes, size_t size,
                                          opms_history_report_t *report)
{
    const opms_wire_result_t result = wire_open(bytes, size, OPMS_REPORT_HISTORY);
    if (result != OPMS_WIRE_OK) {
        return result;
    }
    if (bytes[COUNT] > OPMS_HISTORY_PER_REPORT) {
        return OPMS_WIRE_VALUE;
    }
    const opms_history_report_t got = decode_history(bytes);
    uint8_t again[OPMS_WIRE_SIZE];
    opms_wire_write_history(&got, again);
    if (!is_history(&got) || !wire_same(bytes, again)) {
        return OPMS_WIRE_VALUE;
    }
    if (report != NULL) {
        *report = got;
    }
    return OPMS_WIRE_OK;
}
