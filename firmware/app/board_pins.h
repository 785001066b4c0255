/* SPDX-License-Identifier: Apache-2.0 */
/* Which pin of the Raspberry Pi Pico is which line, by the names of the schematic's nets. This is
 * the only place that says so. */
#ifndef FIRMWARE_APP_BOARD_PINS_H
#define FIRMWARE_APP_BOARD_PINS_H

#define PIN_START 2U  /* in: TTL rising edge starts the run; pulled down */
#define PIN_TRIG 3U   /* out: to the camera */
#define PIN_STROBE 4U /* in: the camera's exposure-active output; pulled down */
#define PIN_SYNC 5U   /* out: to other sensors */
#define PIN_LED 25U   /* out: the Pico's own LED */

#endif
