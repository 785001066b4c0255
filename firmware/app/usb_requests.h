/* SPDX-License-Identifier: Apache-2.0 */
/* What the host asks for, and TinyUSB hands on; called from within tud_task(). */
#ifndef FIRMWARE_APP_USB_REQUESTS_H
#define FIRMWARE_APP_USB_REQUESTS_H

#include "box.h"

/* Requests go to `box` from here on. */
void usb_requests_init(box_t *box);

/* Has a program on the host asked for anything since the last call? What the host's own driver
 * asks at each enumeration does not count. */
bool usb_requests_take_asked(void);

#endif
