/* SPDX-License-Identifier: Apache-2.0 */
/* What the host asks for: commands and feature reports. Nothing is believed unread. */
#include "box_internal.h"

static opms_refusal_t refusal_of(opms_wire_result_t result)
{
    return (opms_refusal_t)((int)result + 1);
}

static opms_refusal_t add_ping(box_t *box, uint32_t ping_id, box_cycles_t now)
{
    if (box->pongs_in - box->pongs_out == BOX_PONGS)
        return OPMS_REFUSAL_BUSY;
    box->pongs[box->pongs_in++ % BOX_PONGS] = (box_pong_entry_t){ping_id, now};
    return OPMS_REFUSAL_NONE;
}

static opms_refusal_t carry_out(box_t *box, const opms_command_report_t *command, box_cycles_t now)
{
    switch (command->opcode) {
    case OPMS_COMMAND_PING:
        return add_ping(box, command->argument, now);
    case OPMS_COMMAND_ARM:
        return command->argument != 0 ? box_arm(box, command->argument, now)
                                      : OPMS_REFUSAL_VALUE;
    case OPMS_COMMAND_DISARM:
        box_disarm(box, now);
        return OPMS_REFUSAL_NONE;
    }
    return OPMS_REFUSAL_VALUE;
}

void box_command(box_t *box, const uint8_t *bytes, size_t size, box_cycles_t now)
{
    opms_command_report_t command = {0};
    opms_wire_result_t result = opms_wire_read_command(bytes, size, &command);
    opms_refusal_t refusal =
        result == OPMS_WIRE_OK ? carry_out(box, &command, now) : refusal_of(result);
    if (refusal != OPMS_REFUSAL_NONE)
        box_refuse(box, OPMS_REPORT_COMMAND, (uint32_t)command.opcode, refusal, now);
}

/* Flash work stalls execution, so it is for IDLE alone. */
static opms_refusal_t set_settings(box_t *box, const uint8_t *bytes, size_t size)
{
    opms_settings_t settings;
    opms_wire_result_t result = opms_wire_read_settings_set(bytes, size, &settings);
    if (result != OPMS_WIRE_OK)
        return refusal_of(result);
    if (opms_wire_check_settings(&settings) != NULL)
        return OPMS_REFUSAL_VALUE;
    if (box->state != OPMS_BOX_IDLE)
        return OPMS_REFUSAL_STATE;
    if (box->store_pending)
        return OPMS_REFUSAL_BUSY;
    box->to_store = settings;
    box->store_pending = true;
    box->actions |= BOX_DO_STORE_SETTINGS;
    return OPMS_REFUSAL_NONE;
}

void box_stored(box_t *box, bool kept, box_cycles_t now)
{
    if (!box->store_pending)
        return;
    box->store_pending = false;
    box->last_set = kept ? OPMS_REFUSAL_NONE : OPMS_REFUSAL_FLASH;
    if (!kept) {
        box_refuse(box, OPMS_REPORT_SETTINGS, 0, OPMS_REFUSAL_FLASH, now);
        return;
    }
    box->settings = box->to_store;
    box->settings_are_stored = true;
    box_push_event(box, OPMS_EVENT_SETTINGS_STORED, now, opms_wire_settings_crc(&box->settings),
                   0);
}

static opms_refusal_t select_history(box_t *box, const uint8_t *bytes, size_t size)
{
    opms_history_request_t request;
    opms_wire_result_t result = opms_wire_read_history_request(bytes, size, &request);
    if (result != OPMS_WIRE_OK)
        return refusal_of(result);
    box->selection = (box_selection_t){
        .token = request.token,
        .session_id = request.session_id,
        .next_number = request.first_number,
        .remaining = request.count,
    };
    return OPMS_REFUSAL_NONE;
}

static opms_refusal_t enter_bootloader(box_t *box, const uint8_t *bytes, size_t size)
{
    opms_wire_result_t result = opms_wire_read_bootloader(bytes, size);
    if (result != OPMS_WIRE_OK)
        return result == OPMS_WIRE_VALUE ? OPMS_REFUSAL_MAGIC : refusal_of(result);
    if (box->state != OPMS_BOX_IDLE)
        return OPMS_REFUSAL_STATE;
    if (box->store_pending)
        return OPMS_REFUSAL_BUSY;
    box->actions |= BOX_DO_BOOTLOADER;
    return OPMS_REFUSAL_NONE;
}

void box_set_feature(box_t *box, const uint8_t *bytes, size_t size, box_cycles_t now)
{
    uint8_t id = size != 0 ? bytes[0] : 0;
    opms_refusal_t refusal;
    if (id == OPMS_REPORT_SETTINGS) {
        refusal = set_settings(box, bytes, size);
        /* While one is being written it is that one's outcome that is waited for. */
        if (refusal != OPMS_REFUSAL_BUSY)
            box->last_set = refusal;
    } else if (id == OPMS_REPORT_HISTORY) {
        refusal = select_history(box, bytes, size);
    } else if (id == OPMS_REPORT_BOOTLOADER) {
        refusal = enter_bootloader(box, bytes, size);
    } else {
        refusal = OPMS_REFUSAL_ID;
    }
    if (refusal != OPMS_REFUSAL_NONE)
        box_refuse(box, id, 0, refusal, now);
}

static void get_settings(const box_t *box, uint8_t *bytes)
{
    opms_settings_report_t report = {
        .settings = box->settings,
        .last_set = box->last_set,
        .pending = box->store_pending,
        .stored = box->settings_are_stored,
        .settings_crc = opms_wire_settings_crc(&box->settings),
    };
    opms_wire_write_settings(&report, bytes);
}

static void get_history(box_t *box, uint8_t *bytes)
{
    box_selection_t *selection = &box->selection;
    opms_history_report_t report = {
        .token = selection->token,
        .boot_id = box->identity.report.boot_id,
    };
    if (selection->token != 0 && selection->session_id == box->session_id) {
        report.session_id = selection->session_id;
        while (report.count < OPMS_HISTORY_PER_REPORT && selection->remaining != 0) {
            pulse_log_read(&box->log, selection->next_number++, &report.entries[report.count++]);
            selection->remaining--;
        }
        report.remaining = (uint16_t)selection->remaining;
    }
    opms_wire_write_history(&report, bytes);
}

bool box_get_feature(box_t *box, uint8_t id, uint8_t bytes[OPMS_WIRE_SIZE])
{
    switch (id) {
    case OPMS_REPORT_IDENTITY:
        opms_wire_write_identity(&box->identity.report, bytes);
        return true;
    case OPMS_REPORT_SETTINGS:
        get_settings(box, bytes);
        return true;
    case OPMS_REPORT_HISTORY:
        get_history(box, bytes);
        return true;
    default:
        return false;
    }
}
