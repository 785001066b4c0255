/* SPDX-License-Identifier: Apache-2.0 */
#include "mock_box.h"

#include <string.h>

enum { PULSES = 20, PERIOD_US = 100000 };

/* One collection; every report has its id and 63 bytes (docs/wire.md). */
#define REPORT(id, kind) 0x85, (id), 0x09, (id), 0x75, 8, 0x95, 63, (kind), 0x02
static const uint8_t descriptor[] = {
    0x06, 0x4F, 0xFF, 0x09, 0x01, 0xA1, 0x01, 0x15, 0x00, 0x26, 0xFF, 0x00,
    REPORT(0x01, 0x81), REPORT(0x02, 0x81), REPORT(0x03, 0x81), REPORT(0x04, 0x81),
    REPORT(0x10, 0x91), REPORT(0x20, 0xB1), REPORT(0x21, 0xB1), REPORT(0x22, 0xB1),
    REPORT(0x23, 0xB1), 0xC0};

const uint8_t *mock_box_descriptor(uint32_t *size)
{
    *size = sizeof descriptor;
    return descriptor;
}

void mock_box_init(mock_box_t *box, uint32_t boot_id)
{
    memset(box, 0, sizeof *box);
    box->boot_id = boot_id;
    opms_wire_default_settings(&box->settings.settings);
    box->settings.stored = true;
    box->settings.settings_crc = opms_wire_settings_crc(&box->settings.settings);
}

static uint8_t *new_input(mock_box_t *box)
{
    return box->inputs[(box->first_input + box->input_count++) % MOCK_INPUTS_MAX];
}

bool mock_box_next_input(mock_box_t *box, uint8_t *bytes)
{
    if (box->input_count == 0) {
        return false;
    }
    memcpy(bytes, box->inputs[box->first_input], OPMS_WIRE_SIZE);
    box->first_input = (box->first_input + 1) % MOCK_INPUTS_MAX;
    --box->input_count;
    return true;
}

static void get_identity(const mock_box_t *box, uint8_t *bytes)
{
    opms_identity_report_t identity = {.hardware_version = 1,
                                       .firmware_version = {0, 2, 0},
                                       .capabilities = OPMS_CAPABILITY_HISTORY,
                                       .unique_id = {0xE6, 0x61, 0x78, 0xC1, 0xA3, 0x55, 0x1E,
                                                     0x2B},
                                       .git_hash = "0123456789abcdef0123",
                                       .boot_id = box->boot_id,
                                       .clock_hz = OPMS_BOX_CLOCK_HZ,
                                       .start_cycles = OPMS_BOX_START_CYCLES,
                                       .ring_entries = OPMS_BOX_RING_ENTRIES,
                                       .history_entries = OPMS_BOX_HISTORY_ENTRIES};
    opms_wire_write_identity(&identity, bytes);
}

static opms_history_entry_t entry_of(uint32_t number)
{
    const opms_history_entry_t held = {.number = number,
                                       .flags = OPMS_TRIGGER_RUN,
                                       .time = {(uint64_t)number * PERIOD_US, 7}};
    const opms_history_entry_t none = {.number = number, .flags = OPMS_TRIGGER_NOT_HELD};
    return number >= 1 && number <= PULSES ? held : none;
}

static void get_history(mock_box_t *box, uint8_t *bytes)
{
    opms_history_request_t *selection = &box->selection;
    opms_history_report_t report = {.token = selection->token,
                                    .boot_id = box->boot_id,
                                    .session_id = box->session_id};
    while (report.count < OPMS_HISTORY_PER_REPORT && selection->count > 0) {
        report.entries[report.count++] = entry_of(selection->first_number++);
        --selection->count;
    }
    report.remaining = selection->count;
    opms_wire_write_history(&report, bytes);
}

uint32_t mock_box_get(mock_box_t *box, uint8_t id, uint8_t *bytes)
{
    switch (id) {
    case OPMS_REPORT_IDENTITY: get_identity(box, bytes); break;
    case OPMS_REPORT_SETTINGS: opms_wire_write_settings(&box->settings, bytes); break;
    case OPMS_REPORT_HISTORY: get_history(box, bytes); break;
    default: return 0;
    }
    return OPMS_WIRE_SIZE;
}

bool mock_box_set(mock_box_t *box, const uint8_t *bytes, uint32_t size)
{
    if (opms_wire_read_history_request(bytes, size, &box->selection) == OPMS_WIRE_OK) {
        return true;
    }
    if (opms_wire_read_settings_set(bytes, size, &box->settings.settings) == OPMS_WIRE_OK) {
        box->settings.settings_crc = opms_wire_settings_crc(&box->settings.settings);
        return true;
    }
    return false;
}

static void add_trigger(mock_box_t *box, uint32_t number)
{
    opms_trigger_report_t trigger = {.flags = OPMS_TRIGGER_RUN,
                                     .boot_id = box->boot_id,
                                     .session_id = box->session_id,
                                     .report_number = ++box->report_number,
                                     .trigger_number = number,
                                     .time = {(uint64_t)number * PERIOD_US, 7},
                                     .start_edge = {PERIOD_US, 3},
                                     .first_run_number = 1};
    if (number != 5 && number != 6 && number != 13) {
        opms_wire_write_trigger(&trigger, new_input(box));
    }
}

static void arm(mock_box_t *box, uint32_t session_id)
{
    box->session_id = session_id;
    opms_event_report_t armed = {.kind = OPMS_EVENT_ARMED,
                                 .state = OPMS_BOX_ARMED,
                                 .boot_id = box->boot_id,
                                 .session_id = session_id,
                                 .report_number = ++box->report_number,
                                 .event_number = ++box->event_number,
                                 .argument = session_id};
    opms_wire_write_event(&armed, new_input(box));
    for (uint32_t number = 1; number <= PULSES; ++number) {
        add_trigger(box, number);
    }
}

bool mock_box_output(mock_box_t *box, const uint8_t *bytes, uint32_t size)
{
    opms_command_report_t command;
    if (opms_wire_read_command(bytes, size, &command) != OPMS_WIRE_OK) {
        return false;
    }
    if (command.opcode == OPMS_COMMAND_ARM) {
        arm(box, command.argument);
    } else if (command.opcode == OPMS_COMMAND_PING) {
        opms_pong_report_t pong = {.boot_id = box->boot_id,
                                   .report_number = ++box->report_number,
                                   .ping_id = command.argument};
        opms_wire_write_pong(&pong, new_input(box));
    }
    return true;
}
