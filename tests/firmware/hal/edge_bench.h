/* SPDX-License-Identifier: Apache-2.0 */
/* Lines as hal/edge_order.h sees them: the tests write down edges with their true times, and the
 * bench quantises them as the taggers do. */
#ifndef TESTS_FIRMWARE_EDGE_BENCH_H
#define TESTS_FIRMWARE_EDGE_BENCH_H

#include "edge_order.h"

enum { EDGE_BENCH_MOST = 4096 };

extern edge_order_t order;
extern opms_settings_t settings;

/* Inputs as they were told. */
extern box_input_t told[EDGE_BENCH_MOST];
extern uint32_t told_count;

/* Nothing is known of any line; `settings` are the defaults. */
void edge_bench_init(void);

/* A pulse left; its number follows by itself. */
void edge_bench_pulse(box_cycles_t time);
/* So many pulses were lost: overrun. */
void edge_bench_lose_pulses(uint32_t count);
/* A line was high. Times are seen one cycle late or not, by their parity. */
void edge_bench_high(edge_line_t line, box_cycles_t rise, box_cycles_t fall);
void edge_bench_rise(edge_line_t line, box_cycles_t rise);
void edge_bench_fall(edge_line_t line, box_cycles_t fall);

/* Let the order tell all that it can at a time. */
void edge_bench_tell(box_cycles_t now);

/* The kinds that were told, by letters: Armed Stopped Pulse sTart Glitch Exposure. */
const char *edge_bench_kinds(void);

/* The only input of a kind; fails the test otherwise. */
const box_input_t *edge_bench_the(box_input_kind_t kind);

#endif
