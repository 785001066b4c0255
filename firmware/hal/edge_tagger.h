/* SPDX-License-Identifier: Apache-2.0 */
/* Number and time of every edge, made by PIO 1 (tagger.pio) and kept by DMA in rings, whatever the
 * CPU does meanwhile: 1,024 pulses, and as many STARTs and exposures.
 *
 * Times are those of the edge at the pad, exact to the cycle for pulses and to two for the others.
 * They share one clock; from cycle_clock_now() it differs by a constant, less than 1 us. */
#ifndef FIRMWARE_HAL_EDGE_TAGGER_H
#define FIRMWARE_HAL_EDGE_TAGGER_H

#include <stdbool.h>

#include "box_time.h"

typedef enum edge_line { EDGE_LINE_START, EDGE_LINE_STROBE, EDGE_LINES } edge_line_t;

typedef struct edge_pulse {
    uint32_t number; /* of all edges since start-up, wraps */
    box_cycles_t time;
} edge_pulse_t;

typedef struct edge_level {
    bool rise; /* else fall */
    box_cycles_t time;
} edge_level_t;

void edge_tagger_init(void);

/* Look at what the rings hold by now; the calls below see nothing later. Edges of START and STROBE
 * are looked at before those of TRIG: what is seen of them has its pulse in sight, too. */
void edge_tagger_look(void);

/* The oldest pulse in sight. @return false if there is none. */
bool edge_tagger_peek_pulse(edge_pulse_t *pulse);
void edge_tagger_drop_pulse(void);

/* The oldest edge of a line in sight. @return false if there is none. */
bool edge_tagger_peek_level(edge_line_t line, edge_level_t *edge);
void edge_tagger_drop_level(edge_line_t line);

/* Did noise on START or STROBE, of tens of MHz, outrun the DMA? The line's clock is late since: its
 * edges are not told any more, until edge_tagger_restart(). Pulses are not concerned. */
bool edge_tagger_is_outrun(void);

/* Start anew, numbers included: for IDLE, when all in sight has been dropped. */
void edge_tagger_restart(void);

/* Has anything come since the last look? For deciding to sleep, with interrupts off. */
bool edge_tagger_has_news(void);

#endif
