/* SPDX-License-Identifier: Apache-2.0 */
/* The box's clock: the microsecond timer, which the same crystal drives as the 125 MHz of PIO. */
#ifndef FIRMWARE_HAL_CYCLE_CLOCK_H
#define FIRMWARE_HAL_CYCLE_CLOCK_H

#include "box_time.h"

/* Now, to the microsecond. */
box_cycles_t cycle_clock_now(void);

/* Start the alarm that ends the main loop's sleep. */
void cycle_clock_init(void);

/* Set the alarm anew. */
void cycle_clock_wake_in_us(uint32_t us);

#endif
