/* SPDX-License-Identifier: Apache-2.0 */
#include "cycle_clock.h"

#include "hardware/irq.h"
#include "hardware/timer.h"

#define ALARM 0U

box_cycles_t cycle_clock_now(void)
{
    return time_us_64() * OPMS_BOX_CYCLES_PER_US;
}

/* Waking up is all that it is for. */
static void on_alarm(void)
{
    hw_clear_bits(&timer_hw->intr, 1U << ALARM);
}

void cycle_clock_init(void)
{
    irq_set_exclusive_handler(TIMER_IRQ_0 + ALARM, on_alarm);
    hw_set_bits(&timer_hw->inte, 1U << ALARM);
    irq_set_enabled(TIMER_IRQ_0 + ALARM, true);
}

void cycle_clock_wake_in_us(uint32_t us)
{
    timer_hw->alarm[ALARM] = timer_hw->timerawl + us;
}
