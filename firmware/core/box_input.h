/* SPDX-License-Identifier: Apache-2.0 */
/* What the hardware tells the box's logic.
 *
 * Inputs come in the order in which hardware recorded them: a pulse at its edge, START when its
 * debounce has passed, a glitch and an exposure at their end. ARMED and STOPPED stand where the
 * pulse generator began and ended to listen, so a START between them is one that it acted on. */
#ifndef FIRMWARE_CORE_BOX_INPUT_H
#define FIRMWARE_CORE_BOX_INPUT_H

#include "box_time.h"

typedef enum box_input_kind {
    BOX_INPUT_ARMED,   /* the pulse generator is set up and runs */
    BOX_INPUT_STOPPED, /* TRIG is low and stays so; every pulse was told before */
    BOX_INPUT_PULSE,   /* TRIG rose */
    BOX_INPUT_START,   /* START rose and stayed high for the debounce */
    BOX_INPUT_GLITCH,  /* START rose and fell before the debounce had passed */
    BOX_INPUT_STROBE   /* an exposure ended */
} box_input_kind_t;

typedef struct box_input {
    box_input_kind_t kind;
    box_cycles_t time;      /* of the (rising) edge */
    uint32_t number;        /* PULSE: hardware's count of edges since arming, from 1 */
    uint32_t length_cycles; /* GLITCH, STROBE: how long the line was active */
} box_input_t;

#endif
