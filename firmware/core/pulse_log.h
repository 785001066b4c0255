/* SPDX-License-Identifier: Apache-2.0 */
/* The last pulses of the session, by number: queue of the reports and memory of HISTORY in one. */
#ifndef FIRMWARE_CORE_PULSE_LOG_H
#define FIRMWARE_CORE_PULSE_LOG_H

#include <stdbool.h>

#include "box_time.h"

/* 16 bytes a pulse: 128 KiB of the chip's 264 for the whole log. */
typedef struct pulse_entry {
    uint64_t time_and_flags; /* flags in the upper 8 bits */
    uint32_t strobe_delay_cycles;
    uint32_t strobe_length_cycles;
} pulse_entry_t;

typedef struct pulse_log {
    uint32_t last;  /* number of the newest pulse, 0 if there is none */
    uint32_t first; /* number of the oldest pulse that is held; last + 1 if there is none */
    pulse_entry_t entries[OPMS_BOX_HISTORY_ENTRIES];
} pulse_log_t;

/* Forget everything; the next pulse should be number 1. */
void pulse_log_clear(pulse_log_t *log);

/* Add a pulse; `number` is greater than the last. @return numbers that were skipped, i.e. lost. */
uint32_t pulse_log_add(pulse_log_t *log, uint32_t number, box_cycles_t time, uint8_t flags);

/* Is the pulse held? A number that was skipped lies in the range but is not. */
bool pulse_log_holds(const pulse_log_t *log, uint32_t number);

/* Time and flags of a pulse that is held. */
box_cycles_t pulse_log_time(const pulse_log_t *log, uint32_t number);
uint8_t pulse_log_flags(const pulse_log_t *log, uint32_t number);
void pulse_log_set_flags(pulse_log_t *log, uint32_t number, uint8_t flags);

/* Note the exposure of a pulse that is held. */
void pulse_log_set_strobe(pulse_log_t *log, uint32_t number, uint32_t delay_cycles,
                          uint32_t length_cycles);

/* The newest pulse at or before a time; 0 if none is held. */
uint32_t pulse_log_before(const pulse_log_t *log, box_cycles_t time);

/* Whole us from pulse `number - 1 - back` to `number - back`; 0 if one is not held or it is more
 * than three bytes can say. */
uint32_t pulse_log_gap_us(const pulse_log_t *log, uint32_t number, uint32_t back);

/* The entry as HISTORY returns it; NOT_HELD where it is not. */
void pulse_log_read(const pulse_log_t *log, uint32_t number, opms_history_entry_t *entry);

#endif
