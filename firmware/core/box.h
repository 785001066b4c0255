/* SPDX-License-Identifier: Apache-2.0 */
/* The box's logic: (state, input, now) -> state, actions, reports. No hardware, no clock of its
 * own, no allocation; one context calls all of it.
 *
 *     while (hal_next_input(&input))       box_input(&box, &input);
 *     for each report from the host        box_command() or box_set_feature(), box_get_feature()
 *     box_tick(&box, now);
 *     hal_do(box_take_actions(&box));
 *     if (endpoint is free && box_next_report(&box, now, bytes))  send(bytes);
 */
#ifndef FIRMWARE_CORE_BOX_H
#define FIRMWARE_CORE_BOX_H

#include <stdbool.h>
#include <stddef.h>

#include "box_input.h"
#include "pulse_log.h"

#define BOX_EVENTS 32 /* events that wait for the host */
#define BOX_PONGS 4   /* pings that wait for their answer */

/* What is to be done to the hardware, in this order where several are set. */
enum {
    BOX_DO_ARM = 1U << 0,            /* set up the generator from box_settings() and start it */
    BOX_DO_STOP = 1U << 1,           /* stop it; a pulse that has begun ends as usual */
    BOX_DO_STORE_SETTINGS = 1U << 2, /* box_settings_to_store() to flash, then box_stored() */
    BOX_DO_BOOTLOADER = 1U << 3      /* leave for the bootloader */
};

/* What stays the same from start-up on. */
typedef struct box_identity {
    opms_identity_report_t report; /* boot_id not 0 */
    opms_reset_cause_t reset_cause;
} box_identity_t;

typedef struct box_pong_entry {
    uint32_t ping_id;
    box_cycles_t received;
} box_pong_entry_t;

/* HISTORY's selection. */
typedef struct box_selection {
    uint16_t token;
    uint32_t session_id;
    uint32_t next_number;
    uint32_t remaining;
} box_selection_t;

/* All of the box. Static, zeroed by box_init(); read through the calls below. */
typedef struct box {
    box_identity_t identity;
    opms_settings_t settings;  /* in force */
    opms_settings_t to_store;
    bool settings_are_stored;  /* those in force came from flash or went there */
    bool store_pending;
    opms_refusal_t last_set;

    opms_box_state_t state;
    uint32_t actions;
    uint32_t session_id;
    bool stop_asked;           /* STOPPED is on its way */
    bool timed_out;            /* and this is why */
    bool start_seen;           /* START passed its debounce; the run's first pulse is next */
    bool preamble_cut;
    box_cycles_t start_edge;
    bool is_held;              /* a pulse that may be the run's first waits for its successor */
    box_input_t held;
    box_cycles_t waiting_since;
    uint32_t first_run_number;

    pulse_log_t log;
    uint32_t reported;         /* number of the last pulse that went out as a TRIGGER */
    uint32_t triggers_in_row;  /* TRIGGER reports sent while others wait */
    uint32_t strobe_number;    /* pulse of the last exposure, 0 if none */
    uint32_t strobe_checked;   /* pulses up to this one have an exposure or were told missing */
    bool strobe_missing_news;  /* since the last TRIGGER */
    box_selection_t selection;

    opms_event_report_t events[BOX_EVENTS]; /* report_number is filled in when it is sent */
    uint32_t events_in, events_out;         /* free-running */
    uint32_t event_number;
    box_pong_entry_t pongs[BOX_PONGS];
    uint32_t pongs_in, pongs_out;   /* free-running */
    bool status_due;
    box_cycles_t status_last;

    uint32_t report_number;
    uint32_t glitches, starts_refused, strobes_missing, dropped, commands_refused;
    uint16_t reenumerations;
} box_t;

/* Start-up. @param settings  those of the flash, or NULL: the defaults. */
void box_init(box_t *box, const box_identity_t *identity, const opms_settings_t *settings);

/* Tell what the hardware recorded. */
void box_input(box_t *box, const box_input_t *input);

/* Let time pass; call it at least ten times a second. */
void box_tick(box_t *box, box_cycles_t now);

/* Carry out an output report, or refuse it with an EVENT. */
void box_command(box_t *box, const uint8_t *bytes, size_t size, box_cycles_t now);

/* Carry out a SET of a feature report, or refuse it with an EVENT. */
void box_set_feature(box_t *box, const uint8_t *bytes, size_t size, box_cycles_t now);

/* Answer a GET of a feature report. @return false where the id cannot be read: to be stalled. */
bool box_get_feature(box_t *box, uint8_t id, uint8_t bytes[OPMS_WIRE_SIZE]);

/* Actions that wait, each told once; see BOX_DO_... */
uint32_t box_take_actions(box_t *box);

/* What became of BOX_DO_STORE_SETTINGS. */
void box_stored(box_t *box, bool kept, box_cycles_t now);

/* The IN endpoint was found wedged and the box enumerates again. */
void box_endpoint_healed(box_t *box, box_cycles_t now);

/* The next input report. @return false if there is none. */
bool box_next_report(box_t *box, box_cycles_t now, uint8_t bytes[OPMS_WIRE_SIZE]);

/* Would box_next_report() give one? */
bool box_has_report(const box_t *box);

static inline opms_box_state_t box_state(const box_t *box)
{
    return box->state;
}

static inline const opms_settings_t *box_settings(const box_t *box)
{
    return &box->settings;
}

static inline const opms_settings_t *box_settings_to_store(const box_t *box)
{
    return &box->to_store;
}

/* Gaps of the preamble; it has one pulse more, or none at all. */
uint32_t box_preamble_gaps(const opms_settings_t *settings);

/* Should the status LED be lit? IDLE: a blink every 2 s; ARMED and PREAMBLE: fast; WAITING:
 * steady; RUNNING: a flash with each pulse. */
bool box_led(const box_t *box, box_cycles_t now);

#endif
