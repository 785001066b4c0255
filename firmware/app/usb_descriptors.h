/* SPDX-License-Identifier: Apache-2.0 */
/* What the box says of itself when it enumerates. */
#ifndef FIRMWARE_APP_USB_DESCRIPTORS_H
#define FIRMWARE_APP_USB_DESCRIPTORS_H

#include <stdint.h>

/* Call it before USB starts: the serial number is the hex of this id. */
void usb_descriptors_set_serial(const uint8_t unique_id[8]);

#endif
