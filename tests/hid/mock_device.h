/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A mocked device that hidapi finds: by mock_hidraw.c, or by mock_usb.c. Run the program by
 * umockdev-wrapper. */
#ifndef OPMS_TESTS_MOCK_DEVICE_H
#define OPMS_TESTS_MOCK_DEVICE_H

#include <stdbool.h>
#include <stdint.h>

/** Plug the device in, at another node than the last time, as a kernel does.
 * @return Whether that worked. */
bool mock_device_plug(uint32_t boot_id);
/** Can a device that somebody has open be pulled out and put back? */
extern const bool mock_device_replugs;
/** How hidapi names the place where it is now. */
const char *mock_device_path(void);
/** Pull it out. */
void mock_device_unplug(void);
/** Faults that the mock noticed, such as output reports that do not read. */
uint32_t mock_device_faults(void);

#endif
