/* SPDX-License-Identifier: Apache-2.0 */
/* The box's logic on the USB: reports out of it and into it. */
#ifndef FIRMWARE_APP_USB_LINK_H
#define FIRMWARE_APP_USB_LINK_H

#include "box.h"

/* Start USB. Requests of the host go to `box`, from within usb_link_work(). */
void usb_link_init(box_t *box);

/* Do all that USB has to do by now, and hand over the next report when the last was taken. */
void usb_link_work(void);

/* Is there work right now? For deciding to sleep, with interrupts off. */
bool usb_link_has_work(void);

#endif
