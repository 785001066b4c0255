/* SPDX-License-Identifier: Apache-2.0 */
/* Which input report goes out next, and what it says. */
#include "box_internal.h"

/* A report is late when it leaves more than 2 ms after its pulse. */
#define PROMPT (2 * BOX_CYCLES_PER_MS)

/* While a silent host's pulses are told again, every so many of them let another report through:
 * a ping must not wait for thousands. */
#define TRIGGERS_IN_ROW 8

/* Move on to the next pulse that is held; those that are not were counted when they were lost. */
bool box_next_trigger(box_t *box)
{
    if (box->reported + 1 - box->log.first > UINT32_MAX / 2) {
        /* The log was overrun while no one listened. */
        box->dropped += box->log.first - box->reported - 1;
        box->reported = box->log.first - 1;
    }
    while (box->reported != box->log.last && !pulse_log_holds(&box->log, box->reported + 1))
        box->reported++;
    return box->reported != box->log.last;
}

static void fill_strobe(const box_t *box, opms_trigger_report_t *report)
{
    if (box->strobe_number == 0 || !pulse_log_holds(&box->log, box->strobe_number))
        return;
    opms_history_entry_t entry;
    pulse_log_read(&box->log, box->strobe_number, &entry);
    report->flags |= OPMS_TRIGGER_STROBE;
    report->strobe_for_trigger = box->strobe_number;
    report->strobe_delay_cycles = entry.strobe_delay_cycles;
    report->strobe_length_cycles = entry.strobe_length_cycles;
}

static uint16_t clip16(uint32_t value)
{
    return value < UINT16_MAX ? (uint16_t)value : UINT16_MAX;
}

/* In a report the two flags of the strobe speak of earlier pulses: its own exposure is to come. */
#define FLAGS_OF_STROBE (OPMS_TRIGGER_STROBE | OPMS_TRIGGER_STROBE_MISSING)

static void write_trigger(box_t *box, box_cycles_t now, uint8_t *bytes)
{
    uint32_t number = ++box->reported;
    box_cycles_t time = pulse_log_time(&box->log, number);
    opms_trigger_report_t report = {
        .flags = (uint16_t)(pulse_log_flags(&box->log, number) & ~(unsigned)FLAGS_OF_STROBE),
        .boot_id = box->identity.report.boot_id,
        .session_id = box->session_id,
        .report_number = ++box->report_number,
        .trigger_number = number,
        .time = box_time_of(time),
        .gap_us = {pulse_log_gap_us(&box->log, number, 0), pulse_log_gap_us(&box->log, number, 1)},
        .dropped = clip16(box->dropped),
    };
    if ((report.flags & OPMS_TRIGGER_RUN) != 0) {
        report.start_edge = box_time_of(box->start_edge);
        report.first_run_number = box->first_run_number;
    }
    if (now > time && now - time > PROMPT)
        report.flags |= OPMS_TRIGGER_DELAYED;
    if (box->strobe_missing_news)
        report.flags |= OPMS_TRIGGER_STROBE_MISSING;
    box->strobe_missing_news = false;
    fill_strobe(box, &report);
    opms_wire_write_trigger(&report, bytes);
}

static void write_pong(box_t *box, box_cycles_t now, uint8_t *bytes)
{
    const box_pong_entry_t *pong = &box->pongs[box->pongs_out++ % BOX_PONGS];
    opms_pong_report_t report = {
        .boot_id = box->identity.report.boot_id,
        .report_number = ++box->report_number,
        .ping_id = pong->ping_id,
        .received = box_time_of(pong->received),
        .sent = box_time_of(now),
    };
    opms_wire_write_pong(&report, bytes);
}

static void write_event(box_t *box, uint8_t *bytes)
{
    opms_event_report_t report = box->events[box->events_out++ % BOX_EVENTS];
    report.report_number = ++box->report_number;
    opms_wire_write_event(&report, bytes);
}

static void write_status(box_t *box, box_cycles_t now, uint8_t *bytes)
{
    box->status_due = false;
    opms_status_report_t report = {
        .state = box->state,
        .reset_cause = box->identity.reset_cause,
        .boot_id = box->identity.report.boot_id,
        .session_id = box->session_id,
        .report_number = ++box->report_number,
        .uptime_us = now / OPMS_BOX_CYCLES_PER_US,
        .trigger_number = box->log.last,
        .first_run_number = box->first_run_number,
        .glitches = box->glitches,
        .starts_refused = box->starts_refused,
        .strobes_missing = box->strobes_missing,
        .dropped = box->dropped,
        .commands_refused = box->commands_refused,
        .reenumerations = box->reenumerations,
        .settings_crc = opms_wire_settings_crc(&box->settings),
    };
    opms_wire_write_status(&report, bytes);
}

static bool others_wait(const box_t *box)
{
    return box->pongs_in != box->pongs_out || box->events_in != box->events_out ||
           box->status_due;
}

bool box_has_report(const box_t *box)
{
    return box->is_held || box->reported != box->log.last || others_wait(box);
}

static void write_other(box_t *box, box_cycles_t now, uint8_t *bytes)
{
    if (box->pongs_in != box->pongs_out)
        write_pong(box, now, bytes);
    else if (box->events_in != box->events_out)
        write_event(box, bytes);
    else
        write_status(box, now, bytes);
}

bool box_next_report(box_t *box, box_cycles_t now, uint8_t bytes[OPMS_WIRE_SIZE])
{
    bool others = others_wait(box);
    if (box_next_trigger(box) && !(others && box->triggers_in_row >= TRIGGERS_IN_ROW)) {
        /* Only those that overtook count: else the next pulse would have to wait, once. */
        box->triggers_in_row = others ? box->triggers_in_row + 1 : 0;
        write_trigger(box, now, bytes);
        return true;
    }
    box->triggers_in_row = 0;
    if (others)
        write_other(box, now, bytes);
    return others;
}
