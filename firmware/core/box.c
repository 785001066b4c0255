/* SPDX-License-Identifier: Apache-2.0 */
/* States of the box: IDLE -> ARMED -> PREAMBLE -> WAITING -> RUNNING -> IDLE. */
#include "box.h"

#include <string.h>

#include "box_internal.h"

#define STATUS_PERIOD BOX_CYCLES_PER_S

void box_init(box_t *box, const box_identity_t *identity, const opms_settings_t *settings)
{
    memset(box, 0, sizeof *box);
    box->identity = *identity;
    box->settings_are_stored = settings != NULL;
    if (settings != NULL)
        box->settings = *settings;
    else
        opms_wire_default_settings(&box->settings);
    pulse_log_clear(&box->log);
    box->status_due = true;
}

uint32_t box_preamble_gaps(const opms_settings_t *settings)
{
    uint32_t gaps = 0;
    while (gaps < OPMS_BOX_PREAMBLE_MAX && settings->preamble_gap_ms[gaps] != 0)
        gaps++;
    return gaps;
}

static uint32_t preamble_pulses(const box_t *box)
{
    uint32_t gaps = box_preamble_gaps(&box->settings);
    return gaps == 0 ? 0 : gaps + 1;
}

/* Pulses of the last session that no report told are lost to the host now. */
static void forget_session(box_t *box)
{
    for (; box_next_trigger(box); box->reported++)
        box->dropped++;
    pulse_log_clear(&box->log);
    box->reported = 0;
    box->first_run_number = 0;
    box->start_edge = 0;
    box->start_seen = false;
    box->is_held = false;
    box->preamble_cut = false;
    box->stop_asked = false;
    box->timed_out = false;
    box->strobe_number = 0;
    box->strobe_checked = 0;
    box->strobe_missing_news = false;
}

opms_refusal_t box_arm(box_t *box, uint32_t session_id, box_cycles_t now)
{
    if (box->state != OPMS_BOX_IDLE)
        return OPMS_REFUSAL_STATE;
    if (box->store_pending || (box->actions & BOX_DO_BOOTLOADER) != 0)
        return OPMS_REFUSAL_BUSY;
    forget_session(box);
    box->session_id = session_id;
    box->state = OPMS_BOX_ARMED;
    box->actions |= BOX_DO_ARM;
    box_push_event(box, OPMS_EVENT_ARMED, now, session_id, 0);
    return OPMS_REFUSAL_NONE;
}

static void to_idle(box_t *box, box_cycles_t now)
{
    /* A START that came too late for its pulse began no run. */
    bool still_waiting = box->state == OPMS_BOX_WAITING;
    opms_event_kind_t kind =
        box->timed_out && still_waiting ? OPMS_EVENT_WAIT_TIMEOUT : OPMS_EVENT_STOP;
    box->state = OPMS_BOX_IDLE;
    box->stop_asked = false;
    box->timed_out = false;
    box->start_seen = false;
    box_push_event(box, kind, now, box->log.last, 0);
}

void box_disarm(box_t *box, box_cycles_t now)
{
    if ((box->actions & BOX_DO_ARM) != 0)
        box->actions &= ~(uint32_t)BOX_DO_ARM; /* the hardware never heard of it */
    else if (box->state != OPMS_BOX_IDLE) {
        if (!box->stop_asked)
            box->actions |= BOX_DO_STOP;
        box->stop_asked = true;
        return;
    }
    to_idle(box, now);
}

static void enter_waiting(box_t *box, box_cycles_t time)
{
    box->state = OPMS_BOX_WAITING;
    box->waiting_since = time;
    box_push_event(box, OPMS_EVENT_WAITING, time, box->log.last, 0);
}

static void on_armed(box_t *box, const box_input_t *input)
{
    if (box->state != OPMS_BOX_ARMED)
        return;
    if (preamble_pulses(box) == 0)
        enter_waiting(box, input->time);
    else
        box->state = OPMS_BOX_PREAMBLE;
}

static void on_start(box_t *box, const box_input_t *input)
{
    bool listening = box->state == OPMS_BOX_PREAMBLE || box->state == OPMS_BOX_WAITING;
    if (!listening || box->start_seen) {
        opms_box_state_t seen_in = box->start_seen ? OPMS_BOX_RUNNING : box->state;
        box->starts_refused++;
        box_push_event(box, OPMS_EVENT_START_REFUSED, input->time, (uint32_t)seen_in, 0);
        return;
    }
    box->start_seen = true;
    box->start_edge = input->time;
    box->preamble_cut = box->state == OPMS_BOX_PREAMBLE;
}

/* START takes effect at the debounce's end: pulses of the preamble may still leave before it. The
 * last of them may rise so shortly before the run's first that time stamps do not tell them apart:
 * then the later one is the run's. So a pulse that may be the first is held until it is known that
 * no other follows at once. */
#define AT_ONCE 16 /* cycles */

static bool may_be_first_of_run(const box_t *box, box_cycles_t pulse)
{
    return box->start_seen && box->first_run_number == 0 &&
           pulse >= box->start_edge + box->settings.debounce_cycles;
}

static void enter_running(box_t *box, uint32_t number)
{
    if (box->preamble_cut)
        box_push_event(box, OPMS_EVENT_PREAMBLE_CUT, box->start_edge, number - 1, 0);
    box->state = OPMS_BOX_RUNNING;
    box->first_run_number = number;
    box_push_event(box, OPMS_EVENT_START, box->start_edge, number, 0);
}

static uint8_t flags_of_pulse(const box_t *box)
{
    if (box->first_run_number == 0)
        return OPMS_TRIGGER_PREAMBLE;
    return box->preamble_cut ? OPMS_TRIGGER_RUN | OPMS_TRIGGER_PREAMBLE_CUT : OPMS_TRIGGER_RUN;
}

static void log_pulse(box_t *box, const box_input_t *input)
{
    box->dropped += pulse_log_add(&box->log, input->number, input->time, flags_of_pulse(box));
    box_check_strobes(box, input->number, input->time);
    if (box->state == OPMS_BOX_PREAMBLE && !box->start_seen &&
        input->number >= preamble_pulses(box))
        enter_waiting(box, input->time);
}

static void release_held(box_t *box)
{
    if (!box->is_held)
        return;
    box->is_held = false;
    enter_running(box, box->held.number);
    log_pulse(box, &box->held);
}

static void on_pulse(box_t *box, const box_input_t *input)
{
    if (box->is_held) {
        box->is_held = false;
        if (input->time - box->held.time > AT_ONCE)
            enter_running(box, box->held.number);
        log_pulse(box, &box->held);
    }
    if (input->number - box->log.last - 1 >= UINT32_MAX / 2)
        return; /* not after the last: hardware's count never does that */
    box->is_held = may_be_first_of_run(box, input->time);
    box->held = *input;
    if (!box->is_held)
        log_pulse(box, input);
}

void box_input(box_t *box, const box_input_t *input)
{
    if (input->kind != BOX_INPUT_PULSE)
        release_held(box);
    switch (input->kind) {
    case BOX_INPUT_ARMED:
        on_armed(box, input);
        break;
    case BOX_INPUT_STOPPED:
        if (box->state != OPMS_BOX_IDLE)
            to_idle(box, input->time);
        break;
    case BOX_INPUT_PULSE:
        on_pulse(box, input);
        break;
    case BOX_INPUT_START:
        on_start(box, input);
        break;
    case BOX_INPUT_GLITCH:
        box->glitches++;
        box_push_event(box, OPMS_EVENT_GLITCH, input->time, input->length_cycles, 0);
        break;
    case BOX_INPUT_STROBE:
        box_note_strobe(box, input->time, input->length_cycles);
        break;
    }
}

static void check_wait(box_t *box, box_cycles_t now)
{
    box_cycles_t limit = box->settings.wait_timeout_s * BOX_CYCLES_PER_S;
    if (limit == 0 || box->state != OPMS_BOX_WAITING || box->stop_asked || box->start_seen)
        return;
    /* An input may carry a time after a `now` that was read before it. */
    if (now < box->waiting_since || now - box->waiting_since < limit)
        return;
    box->timed_out = true;
    box_disarm(box, now);
}

void box_tick(box_t *box, box_cycles_t now)
{
    if (now - box->status_last >= STATUS_PERIOD) {
        box->status_last = now - (now - box->status_last) % STATUS_PERIOD;
        box->status_due = true;
    }
    if (box->is_held && now > box->held.time + AT_ONCE)
        release_held(box);
    check_wait(box, now);
}

uint32_t box_take_actions(box_t *box)
{
    uint32_t actions = box->actions;
    box->actions = 0;
    return actions;
}

void box_endpoint_healed(box_t *box, box_cycles_t now)
{
    box->reenumerations++;
    box_push_event(box, OPMS_EVENT_ENDPOINT_HEALED, now, box->reenumerations, 0);
}
