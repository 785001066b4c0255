/* SPDX-License-Identifier: Apache-2.0 */
/* The box's logic on a bench: the tests play its hardware and its host.
 *
 * Requests go in as bytes and reports come out as bytes, through the readers and writers of
 * opms/wire.h: a report that does not read fails the test. */
#ifndef TESTS_FIRMWARE_BENCH_H
#define TESTS_FIRMWARE_BENCH_H

#include "box.h"

enum { SESSION = 0x5E551043, BOOT = 0x0B007B01 };

/* Reports as they came, by kind; drained from the box by bench_drain(). */
typedef struct bench_reports {
    opms_trigger_report_t triggers[16384];
    opms_event_report_t events[1024];
    opms_pong_report_t pongs[1024];
    opms_status_report_t statuses[1024];
    uint8_t order[20000]; /* ids in the order in which they came */
    uint32_t trigger_count, event_count, pong_count, status_count, order_count;
} bench_reports_t;

extern box_t box;
extern box_cycles_t now; /* passes only where a test lets it */
extern uint32_t pulses;  /* that left since arming: hardware's count */
extern bench_reports_t reports;

/* Times in cycles. */
#define US(us) ((box_cycles_t)(us)*OPMS_BOX_CYCLES_PER_US)
#define MS(ms) US((box_cycles_t)(ms)*1000)

/* Power on. @param settings  as if the flash held them; NULL for nothing in flash. */
void bench_power_on(const opms_settings_t *settings);

/* Let time pass in steps of 50 ms, as the main loop does. */
void bench_pass(box_cycles_t cycles);

/* What the hardware tells, at `now`. */
void bench_pulse(void);
void bench_pulse_number(uint32_t number);
void bench_armed(void);
void bench_stopped(void);
void bench_glitch(uint32_t length_cycles);
/* Edges that lie back by `ago` cycles. */
void bench_start_edge(box_cycles_t ago);
void bench_strobe(box_cycles_t ago, uint32_t length_cycles);

/* What the host sends. */
void bench_command(opms_command_opcode_t opcode, uint32_t argument);
void bench_set_settings(const opms_settings_t *settings);
void bench_bootloader(void);
void bench_select(uint16_t token, uint32_t session_id, uint32_t first, uint16_t count);
opms_settings_report_t bench_get_settings(void);
opms_history_report_t bench_get_history(void);

/* Bring the box from IDLE into a state: default preamble, run of one pulse. Drains. */
void bench_bring_to(opms_box_state_t state);

/* Arm without a preamble, wait for START, and let the run's first pulse leave. */
void bench_run(void);

/* One more pulse of the run, a period after the last. */
void bench_next_pulse(void);

/* Stop by command, as the hardware carries it out. */
void bench_stop(void);

/* Take all reports that wait; those of before are forgotten. */
void bench_drain(void);

/* The next report, decoded into `reports`. @return its id, 0 if there is none. */
uint8_t bench_take_report(void);

/* The one event of this kind among those drained; fails if it is not exactly one. */
const opms_event_report_t *bench_the_event(opms_event_kind_t kind);

#endif
