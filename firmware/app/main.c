/* SPDX-License-Identifier: Apache-2.0 */
/* Where the box's logic meets its hardware: edges in, actions out, reports to the host, sleep. */
#include "box.h"
#include "cycle_clock.h"
#include "box_flash.h"
#include "box_lines.h"
#include "box_reset.h"
#include "build_version.h"
#include "edge_order.h"
#include "edge_tagger.h"
#include "hardware/clocks.h"
#include "hardware/sync.h"
#include "pulse_generator.h"
#include "usb_descriptors.h"
#include "usb_link.h"

#include <opms/version.h>

#include <string.h>

#define HARDWARE_VERSION 1

/* The loop turns at least so often: LED, time-outs, watchdog. */
#define TICK_US 50000U
/* And while the end of the last pulse is waited for: */
#define STOPPING_TICK_US 500U

_Static_assert(SYS_CLK_HZ == OPMS_BOX_CLOCK_HZ, "PIO counts cycles of 8 ns");

static box_t box;
static edge_order_t order;
static bool stopping;

static void identify(box_identity_t *identity)
{
    opms_identity_report_t *report = &identity->report;
    *identity = (box_identity_t){.reset_cause = box_reset_cause()};
    report->hardware_version = HARDWARE_VERSION;
    report->firmware_version[0] = OPMS_VERSION_MAJOR;
    report->firmware_version[1] = OPMS_VERSION_MINOR;
    report->firmware_version[2] = OPMS_VERSION_PATCH;
    report->firmware_modified = BUILD_MODIFIED;
    report->capabilities = OPMS_CAPABILITY_STROBE | OPMS_CAPABILITY_SYNC |
                           OPMS_CAPABILITY_HISTORY | OPMS_CAPABILITY_BOOTLOADER;
    box_unique_id(report->unique_id);
    memcpy(report->git_hash, BUILD_GIT_HASH, sizeof BUILD_GIT_HASH);
    report->boot_id = box_new_boot_id();
    report->clock_hz = OPMS_BOX_CLOCK_HZ;
    report->start_cycles = OPMS_BOX_START_CYCLES;
    report->ring_entries = OPMS_BOX_RING_ENTRIES;
    report->history_entries = OPMS_BOX_HISTORY_ENTRIES;
}

static const edge_source_t edge_source = {edge_tagger_peek_pulse, edge_tagger_drop_pulse,
                                          edge_tagger_peek_level, edge_tagger_drop_level};

static void take_edges(void)
{
    box_input_t input;
    edge_tagger_look();
    box_cycles_t now = cycle_clock_now();
    while (edge_order_next(&order, now, &input))
        box_input(&box, &input);
}

/* What noise did to the taggers is mended where no pulse can be lost by it. */
static void mend_taggers(void)
{
    if (!edge_tagger_is_outrun() || box_state(&box) != OPMS_BOX_IDLE || stopping)
        return;
    edge_tagger_restart();
    edge_order_init(&order, &edge_source, box_settings(&box));
}

static void arm(void)
{
    take_edges();
    edge_order_armed(&order, box_settings(&box), cycle_clock_now());
    pulse_generator_arm(box_settings(&box));
    take_edges();
}

static void stop(void)
{
    pulse_generator_stop();
    stopping = true;
}

static void finish_stop(void)
{
    if (!stopping || !pulse_generator_is_stopped())
        return;
    stopping = false;
    take_edges();
    edge_order_stopped(&order, cycle_clock_now());
    take_edges();
}

static void store_settings(void)
{
    box_reset_feed_watchdog();
    bool kept = settings_store_save(&box_flash, box_settings_to_store(&box));
    box_stored(&box, kept, cycle_clock_now());
    if (!kept)
        return;
    take_edges();
    box_lines_set_polarity(box_settings(&box));
    busy_wait_at_least_cycles(OPMS_BOX_CYCLES_PER_US);
    edge_tagger_look();
    edge_order_set_lines(&order, box_settings(&box));
}

static void act(uint32_t actions)
{
    if ((actions & BOX_DO_ARM) != 0)
        arm();
    if ((actions & BOX_DO_STOP) != 0)
        stop();
    if ((actions & BOX_DO_STORE_SETTINGS) != 0)
        store_settings();
    if ((actions & BOX_DO_BOOTLOADER) != 0)
        box_reset_to_bootloader();
}

static void sleep_until_work(void)
{
    cycle_clock_wake_in_us(stopping ? STOPPING_TICK_US : TICK_US);
    /* With interrupts off, what comes between the question and WFI still wakes it. */
    uint32_t status = save_and_disable_interrupts();
    if (!usb_link_has_work() && !edge_tagger_has_news())
        __wfi();
    restore_interrupts(status);
}

static void start_up(void)
{
    box_identity_t identity;
    opms_settings_t settings;
    identify(&identity);
    bool stored = settings_store_load(&box_flash, &settings);
    box_init(&box, &identity, stored ? &settings : NULL);
    box_lines_init();
    box_lines_set_polarity(box_settings(&box));
    pulse_generator_init();
    edge_tagger_init();
    edge_order_init(&order, &edge_source, box_settings(&box));
    cycle_clock_init();
    usb_descriptors_set_serial(identity.report.unique_id);
    usb_link_init(&box);
    box_reset_start_watchdog();
}

int main(void)
{
    start_up();
    for (;;) {
        box_reset_feed_watchdog();
        usb_link_work();
        act(box_take_actions(&box));
        take_edges();
        mend_taggers();
        finish_stop();
        box_cycles_t now = cycle_clock_now();
        box_tick(&box, now);
        box_lines_set_led(box_led(&box, now));
        sleep_until_work();
    }
}

/* What the SDK calls where it cannot go on: the watchdog ends it, and the host is told why. */
void box_panic(const char *format, ...)
{
    (void)format;
    for (;;)
        tight_loop_contents();
}
