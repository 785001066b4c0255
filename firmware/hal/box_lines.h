/* SPDX-License-Identifier: Apache-2.0 */
/* Pads of the box's lines. Polarity is turned over here, so that PIO and all software see every
 * line as active high. */
#ifndef FIRMWARE_HAL_BOX_LINES_H
#define FIRMWARE_HAL_BOX_LINES_H

#include <stdbool.h>

#include <opms/wire.h>

/* Pads as they stay: pulls, functions, the LED. Call box_lines_set_polarity() next. */
void box_lines_init(void);

/* The taggers may see edges while this changes something: call edge_tagger_discard() after it. */
void box_lines_set_polarity(const opms_settings_t *settings);

void box_lines_set_led(bool lit);

#endif
