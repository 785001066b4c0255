/* SPDX-License-Identifier: Apache-2.0 */
/* Reports of the box. */
#include "base/fail.h"
#include "pair/emit.h"
#include "pair/intake.h"
#include "pair/settle.h"

#define CYCLE_NS 8
#define REPORTS_PER_STROBE 2 /* an exposure that is not told two reports later never was */

/** A number of the box, unwrapped next to the newest one. */
static int64_t unwrap_number(const opms_pairer_t *pairer, uint32_t raw)
{
    pair_unwrap_t near = {.bits = 32, .started = 1, .last = pairer->triggers.next};
    return pair_unwrap(&near, raw);
}

/** A time for a trigger that is held; two times for one trigger are no time at all. */
static void learn_time(opms_pairer_t *pairer, int64_t number, int64_t box_ns,
                       pair_source_t source)
{
    pair_trigger_t *trigger = pair_ring_at(&pairer->triggers, number);
    if (!trigger || trigger->contradicted) {
        return;
    }
    if (box_ns >= PAIR_TIME_LIMIT_NS) {
        ++pairer->counters.reports_contradicting;
        return;
    }
    const int was_known = trigger->source != PAIR_SOURCE_NONE;
    if (!pair_ring_set_time(&pairer->triggers, number, box_ns, source)) {
        ++pairer->counters.reports_contradicting;
        if (was_known && trigger->state == OPMS_TRIGGER_NONE) {
            trigger->source = PAIR_SOURCE_NONE;
            trigger->contradicted = 1;
        }
    } else if (!was_known && source == PAIR_SOURCE_GAP) {
        ++pairer->counters.gaps_filled;
    } else if (!was_known && source == PAIR_SOURCE_HISTORY) {
        ++pairer->counters.history_used;
    }
}

static void learn_strobe(opms_pairer_t *pairer, int64_t number, uint32_t delay_cycles,
                         uint32_t length_cycles)
{
    pair_trigger_t *trigger = pair_ring_at(&pairer->triggers, number);
    if (trigger) {
        trigger->strobe = PAIR_STROBE_SEEN;
        trigger->strobe_delay_ns = (int64_t)delay_cycles * CYCLE_NS;
        trigger->strobe_length_ns = (int64_t)length_cycles * CYCLE_NS;
    }
}

static void learn_no_strobe(opms_pairer_t *pairer, int64_t number)
{
    pair_trigger_t *trigger = pair_ring_at(&pairer->triggers, number);
    if (trigger && trigger->strobe == PAIR_STROBE_UNKNOWN &&
        pairer->options.camera.has_strobe) {
        trigger->strobe = PAIR_STROBE_ABSENT;
    }
}

/** The last completed exposure is told, and with it that none followed since. */
static void learn_last_strobe(opms_pairer_t *pairer, const opms_trigger_report_t *report,
                              int64_t number)
{
    if (!(report->flags & OPMS_TRIGGER_STROBE)) {
        return;
    }
    const int64_t of = unwrap_number(pairer, report->strobe_for_trigger);
    if (of > number) {
        ++pairer->counters.reports_contradicting;
        return;
    }
    learn_strobe(pairer, of, report->strobe_delay_cycles, report->strobe_length_cycles);
    const int64_t held = pairer->triggers.next - pairer->triggers.mask;
    for (int64_t n = number - REPORTS_PER_STROBE; n > of && n >= held; --n) {
        const pair_trigger_t *trigger = pair_ring_at(&pairer->triggers, n);
        if (!trigger || trigger->strobe != PAIR_STROBE_UNKNOWN) {
            break;
        }
        learn_no_strobe(pairer, n);
    }
}

static void learn_run(opms_pairer_t *pairer, uint32_t first_run_number, opms_box_time_t edge)
{
    const int64_t edge_ns = opms_box_time_ns(edge);
    if (first_run_number != 0 && edge_ns > 0 && edge_ns < PAIR_TIME_LIMIT_NS) {
        pairer->start_edge_box_ns = edge_ns;
    }
}

static void learn_flags(opms_pairer_t *pairer, int64_t number, uint16_t flags)
{
    pair_trigger_t *trigger = pair_ring_at(&pairer->triggers, number);
    if (trigger && (flags & OPMS_TRIGGER_PREAMBLE)) {
        trigger->preamble = 1;
    }
}

static void take_trigger(opms_pairer_t *pairer, const opms_trigger_report_t *report)
{
    const int64_t number = unwrap_number(pairer, report->trigger_number);
    const int64_t box_ns = opms_box_time_ns(report->time);
    if (!pair_extend_triggers(pairer, number)) {
        ++pairer->counters.reports_contradicting;
        return;
    }
    const pair_trigger_t *trigger = pair_ring_at(&pairer->triggers, number);
    if (trigger && trigger->source == PAIR_SOURCE_REPORT) {
        ++pairer->counters.reports_repeated;
    } else if (!trigger || trigger->state != OPMS_TRIGGER_NONE) {
        ++pairer->counters.reports_late;
    }
    learn_run(pairer, report->first_run_number, report->start_edge);
    learn_flags(pairer, number, report->flags);
    learn_time(pairer, number, box_ns, PAIR_SOURCE_REPORT);
    opms_box_time_t before = {report->time.us, 0}; /* gaps are of whole microseconds */
    for (int i = 0; i < 2 && report->gap_us[i] > 0; ++i) {
        before.us -= report->gap_us[i];
        learn_time(pairer, number - 1 - i, opms_box_time_ns(before), PAIR_SOURCE_GAP);
    }
    learn_last_strobe(pairer, report, number);
}

opms_status_t opms_pairer_push_trigger(opms_pairer_t *pairer, const opms_trigger_report_t *report,
                                       int64_t arrival_host_ns, opms_error_t *err)
{
    OPMS_TRY(pair_check_input(pairer, report, "report", err));
    OPMS_TRY(pair_check_time(arrival_host_ns, "arrival_host_ns", err));
    ++pairer->counters.reports;
    pair_set_now(pairer, arrival_host_ns);
    if (pair_is_ours(pairer, report->boot_id, report->session_id)) {
        take_trigger(pairer, report);
    }
    pair_go_on(pairer, arrival_host_ns);
    return OPMS_OK;
}

static void take_history(opms_pairer_t *pairer, const opms_history_entry_t *entry)
{
    const int64_t number = unwrap_number(pairer, entry->number);
    if ((entry->flags & OPMS_TRIGGER_NOT_HELD) || !pair_extend_triggers(pairer, number)) {
        return;
    }
    learn_flags(pairer, number, entry->flags);
    learn_time(pairer, number, opms_box_time_ns(entry->time), PAIR_SOURCE_HISTORY);
    if (entry->flags & OPMS_TRIGGER_STROBE) {
        learn_strobe(pairer, number, entry->strobe_delay_cycles, entry->strobe_length_cycles);
    } else if (entry->flags & OPMS_TRIGGER_STROBE_MISSING) {
        learn_no_strobe(pairer, number);
    }
}

opms_status_t opms_pairer_push_history(opms_pairer_t *pairer, const opms_history_report_t *report,
                                       opms_error_t *err)
{
    OPMS_TRY(pair_check_input(pairer, report, "report", err));
    if (report->count > 0 && pair_is_ours(pairer, report->boot_id, report->session_id)) {
        for (uint32_t i = 0; i < report->count && i < OPMS_HISTORY_PER_REPORT; ++i) {
            take_history(pairer, &report->entries[i]);
        }
    }
    pair_go_on(pairer, pairer->now_host_ns);
    return OPMS_OK;
}

opms_status_t opms_pairer_push_event(opms_pairer_t *pairer, const opms_event_report_t *report,
                                     opms_error_t *err)
{
    OPMS_TRY(pair_check_input(pairer, report, "report", err));
    if (pair_is_ours(pairer, report->boot_id, report->session_id)) {
        if (report->kind == OPMS_EVENT_START) {
            learn_run(pairer, report->argument, report->time);
        } else if (report->kind == OPMS_EVENT_STROBE_MISSING) {
            learn_no_strobe(pairer, unwrap_number(pairer, report->argument));
        } else if (report->kind == OPMS_EVENT_STOP) {
            pairer->ended = 1;
            if (report->argument != 0) {
                pair_extend_triggers(pairer, unwrap_number(pairer, report->argument));
            }
        }
    }
    pair_go_on(pairer, pairer->now_host_ns);
    return OPMS_OK;
}

opms_status_t opms_pairer_push_status(opms_pairer_t *pairer, const opms_status_report_t *report,
                                      opms_error_t *err)
{
    OPMS_TRY(pair_check_input(pairer, report, "report", err));
    if (pair_is_ours(pairer, report->boot_id, report->session_id) && report->trigger_number != 0) {
        pair_extend_triggers(pairer, unwrap_number(pairer, report->trigger_number));
        if (report->state == OPMS_BOX_IDLE) {
            pairer->ended = 1;
        }
    }
    pair_go_on(pairer, pairer->now_host_ns);
    return OPMS_OK;
}

opms_status_t opms_pairer_push_pong(opms_pairer_t *pairer, int64_t sent_host_ns,
                                    const opms_pong_report_t *pong, int64_t arrived_host_ns,
                                    opms_error_t *err)
{
    OPMS_TRY(pair_check_input(pairer, pong, "pong", err));
    OPMS_TRY(pair_check_time(sent_host_ns, "sent_host_ns", err));
    OPMS_TRY(pair_check_time(arrived_host_ns, "arrived_host_ns", err));
    const opms_round_trip_t trip = {sent_host_ns, opms_box_time_ns(pong->received),
                                    opms_box_time_ns(pong->sent), arrived_host_ns};
    const int of_this_life = pairer->state == OPMS_PAIR_CLOSED || pong->boot_id == pairer->boot_id;
    if (!of_this_life) { /* the session keeps the clock that it was recorded with */
        pair_see_other_boot(pairer);
    } else if (trip.sent_box_ns < PAIR_TIME_LIMIT_NS) {
        if (pong->boot_id != pairer->clock_boot_id) {
            opms_clock_reset(pairer->clock);
            pairer->clock_boot_id = pong->boot_id;
        }
        opms_clock_push(pairer->clock, &trip, NULL);
    }
    pair_go_on(pairer, arrived_host_ns);
    return OPMS_OK;
}
