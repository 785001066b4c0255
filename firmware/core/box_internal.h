/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by the files of the box's logic. */
#ifndef FIRMWARE_CORE_BOX_INTERNAL_H
#define FIRMWARE_CORE_BOX_INTERNAL_H

#include "box.h"

/* Queue an event. Where the queue is full it is lost, and the gap in the event numbers says so. */
void box_push_event(box_t *box, opms_event_kind_t kind, box_cycles_t time, uint32_t argument,
                    uint32_t detail);

/* Count a refusal and tell it. `opcode` is 0 for all but commands. */
void box_refuse(box_t *box, uint8_t report_id, uint32_t opcode, opms_refusal_t refusal,
                box_cycles_t now);

/* The two commands that change the state. */
opms_refusal_t box_arm(box_t *box, uint32_t session_id, box_cycles_t now);
void box_disarm(box_t *box, box_cycles_t now);

/* Is there a pulse that no TRIGGER told? It is number reported + 1 then. */
bool box_next_trigger(box_t *box);

/* An exposure ended: which pulse was it of? */
void box_note_strobe(box_t *box, box_cycles_t rise, uint32_t length_cycles);

/* A pulse came: is the exposure of an earlier one overdue? */
void box_check_strobes(box_t *box, uint32_t newest, box_cycles_t now);

#endif
