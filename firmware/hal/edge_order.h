/* SPDX-License-Identifier: Apache-2.0 */
/* From edges to inputs of the box's logic, in their order. No hardware here: edges come through
 * edge_source_t.
 *
 * Which pulse is the run's first is read off the pulses themselves: the one that the preamble does
 * not explain. So what is told always agrees with what the generator did, also where START is
 * noisy, and START's edge is known to the cycle. */
#ifndef FIRMWARE_HAL_EDGE_ORDER_H
#define FIRMWARE_HAL_EDGE_ORDER_H

#include "box_input.h"
#include "edge_tagger.h"

/* The calls of edge_tagger.h. */
typedef struct edge_source {
    bool (*peek_pulse)(edge_pulse_t *pulse);
    void (*drop_pulse)(void);
    bool (*peek_level)(edge_line_t line, edge_level_t *edge);
    void (*drop_level)(edge_line_t line);
} edge_source_t;

/* A line that is, or was, high. */
typedef struct edge_high {
    bool seen;   /* there is one that has not been told to its end */
    bool told;   /* nothing more is to be said of it */
    bool fallen;
    box_cycles_t rise, fall;
} edge_high_t;

typedef struct edge_order {
    const edge_source_t *source;
    uint32_t debounce_cycles;
    edge_high_t start, strobe;
    edge_pulse_t pulses[2]; /* the next ones */
    uint32_t pulses_held;

    bool listening;   /* armed, and the run's first pulse has not come */
    uint32_t last_number;  /* hardware's count of the last pulse */
    uint32_t armed_number; /* and of the last before arming */
    uint32_t preamble_pulses;
    box_cycles_t preamble_at[OPMS_BOX_PREAMBLE_MAX + 1]; /* since its first pulse */
    box_cycles_t first_pulse;
    bool start_told;       /* of the run's first pulse, which comes next */
    box_cycles_t start_edge;

    bool armed_due, stopped_due;
    box_cycles_t armed_at, stopped_at;
} edge_order_t;

void edge_order_init(edge_order_t *order, const edge_source_t *source,
                     const opms_settings_t *settings);

/* Lines changed their polarity: forget edges in sight. Call it before anything is armed. */
void edge_order_set_lines(edge_order_t *order, const opms_settings_t *settings);

/* The generator begins to listen, or TRIG has come to rest. */
void edge_order_armed(edge_order_t *order, const opms_settings_t *settings, box_cycles_t now);
void edge_order_stopped(edge_order_t *order, box_cycles_t now);

/* The next input. @return false if there is none by now. */
bool edge_order_next(edge_order_t *order, box_cycles_t now, box_input_t *input);

#endif
