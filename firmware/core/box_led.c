/* SPDX-License-Identifier: Apache-2.0 */
/* The status LED: what a person sees without a host. */
#include "box.h"

static bool blinks(box_cycles_t now, uint32_t period_ms, uint32_t lit_ms)
{
    return now % (period_ms * BOX_CYCLES_PER_MS) < lit_ms * BOX_CYCLES_PER_MS;
}

static bool flashes_with_pulse(const box_t *box, box_cycles_t now)
{
    if (!pulse_log_holds(&box->log, box->log.last))
        return false;
    box_cycles_t pulse = pulse_log_time(&box->log, box->log.last);
    /* At most half of the period, so that single pulses are seen at every rate people can see. */
    box_cycles_t lit = 30 * BOX_CYCLES_PER_MS;
    box_cycles_t half = (box_cycles_t)box->settings.period_us * OPMS_BOX_CYCLES_PER_US / 2;
    return now < pulse + (half < lit ? half : lit);
}

bool box_led(const box_t *box, box_cycles_t now)
{
    switch (box->state) {
    case OPMS_BOX_IDLE:
        return blinks(now, 2000, 100);
    case OPMS_BOX_ARMED:
    case OPMS_BOX_PREAMBLE:
        return blinks(now, 200, 100);
    case OPMS_BOX_WAITING:
        return true;
    case OPMS_BOX_RUNNING:
        return flashes_with_pulse(box, now);
    }
    return false;
}
