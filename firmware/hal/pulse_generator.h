/* SPDX-License-Identifier: Apache-2.0 */
/* The pulse generator: PIO 0 makes preamble, run and sync output by itself (trigger.pio). */
#ifndef FIRMWARE_HAL_PULSE_GENERATOR_H
#define FIRMWARE_HAL_PULSE_GENERATOR_H

#include <stdbool.h>

#include <opms/wire.h>

/* Load the programs and drive TRIG and SYNC inactive. */
void pulse_generator_init(void);

/* Start the preamble, if there is one, and listen to START. The generator must be stopped. */
void pulse_generator_arm(const opms_settings_t *settings);

/* No further pulse begins from here on. */
void pulse_generator_stop(void);

/* Is TRIG low after pulse_generator_stop()? Then all machines are put to rest and it is true from
 * there on. */
bool pulse_generator_is_stopped(void);

#endif
