/* SPDX-License-Identifier: Apache-2.0 */
/* Time inside the firmware: cycles of 8 ns since start-up. 56 bits are used (18 years), so that a
 * pulse and its flags fit 8 bytes of the pulse log. */
#ifndef FIRMWARE_CORE_BOX_TIME_H
#define FIRMWARE_CORE_BOX_TIME_H

#include <stdint.h>

#include <opms/wire.h>

typedef uint64_t box_cycles_t;

#define BOX_CYCLES_PER_MS ((box_cycles_t)1000 * OPMS_BOX_CYCLES_PER_US)
#define BOX_CYCLES_PER_S ((box_cycles_t)OPMS_BOX_CLOCK_HZ)

/* The same instant as it stands in a report. */
static inline opms_box_time_t box_time_of(box_cycles_t cycles)
{
    opms_box_time_t time;
    time.us = cycles / OPMS_BOX_CYCLES_PER_US;
    time.cycles = (uint8_t)(cycles - time.us * OPMS_BOX_CYCLES_PER_US);
    return time;
}

#endif
