/* SPDX-License-Identifier: Apache-2.0 */
/* Why the box started, who it is, and how it starts again. */
#ifndef FIRMWARE_HAL_BOX_RESET_H
#define FIRMWARE_HAL_BOX_RESET_H

#include <opms/wire.h>

/* Call it before box_reset_start_watchdog(). */
opms_reset_cause_t box_reset_cause(void);

/* The unique id of the board's flash. */
void box_unique_id(uint8_t id[8]);

/* A number of this boot, never 0: noise of the ring oscillator, mixed with the unique id and with
 * a count that lives through resets, so that two boots differ even if the noise should not. */
uint32_t box_new_boot_id(void);

/* From here on the program must call box_reset_feed_watchdog() every 8 s. A bite resets the chip,
 * and with it PIO: TRIG goes to its pull. */
void box_reset_start_watchdog(void);
void box_reset_feed_watchdog(void);

/* Leave for the ROM's bootloader; does not return. */
void box_reset_to_bootloader(void);

#endif
