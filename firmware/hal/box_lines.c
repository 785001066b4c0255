/* SPDX-License-Identifier: Apache-2.0 */
#include "box_lines.h"

#include "board_pins.h"
#include "hardware/gpio.h"

static void init_input(uint pin)
{
    gpio_init(pin);
    gpio_set_dir(pin, GPIO_IN);
    gpio_set_input_enabled(pin, true);
    gpio_set_input_hysteresis_enabled(pin, true);
    gpio_pull_down(pin);
}

void box_lines_init(void)
{
    init_input(PIN_START);
    init_input(PIN_STROBE);
    /* The outputs are driven by PIO 0 and stay inputs until its machines take them over. TRIG is
     * read back, too: the tagger counts edges of the pad. */
    init_input(PIN_TRIG);
    init_input(PIN_SYNC);
    gpio_init(PIN_LED);
    gpio_set_dir(PIN_LED, GPIO_OUT);
}

void box_lines_set_polarity(const opms_settings_t *settings)
{
    gpio_set_inover(PIN_START, settings->start_falling_edge ? GPIO_OVERRIDE_INVERT
                                                            : GPIO_OVERRIDE_NORMAL);
    gpio_set_inover(PIN_STROBE, settings->strobe_active_low ? GPIO_OVERRIDE_INVERT
                                                            : GPIO_OVERRIDE_NORMAL);
    /* An inactive line is never driven: an unplugged START or STROBE rests on its pull. */
    gpio_set_pulls(PIN_START, settings->start_falling_edge, !settings->start_falling_edge);
    gpio_set_pulls(PIN_STROBE, settings->strobe_active_low, !settings->strobe_active_low);
    gpio_set_outover(PIN_TRIG, settings->trig_active_low ? GPIO_OVERRIDE_INVERT
                                                         : GPIO_OVERRIDE_NORMAL);
    gpio_set_inover(PIN_TRIG, settings->trig_active_low ? GPIO_OVERRIDE_INVERT
                                                        : GPIO_OVERRIDE_NORMAL);
}

void box_lines_set_led(bool lit)
{
    gpio_put(PIN_LED, lit);
}
