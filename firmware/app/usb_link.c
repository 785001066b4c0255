/* SPDX-License-Identifier: Apache-2.0 */
#include "usb_link.h"

#include "cycle_clock.h"
#include "hardware/structs/usb.h"
#include "tusb.h"
#include "usb_requests.h"

/* A host polls for reports only while some program has the box open, and no poll is no defect. One
 * that keeps asking for other things has it open: a report that is not taken between two requests
 * this far apart is wedged. */
#define WEDGED_AFTER (2 * BOX_CYCLES_PER_S)
/* Frames that start every ms show that it does. */
#define BUS_IS_ALIVE_FOR (200 * BOX_CYCLES_PER_MS)
/* Long enough for a hub, which looks at its ports every 256 ms at most, to see it. */
#define OFF_THE_BUS_FOR (300 * BOX_CYCLES_PER_MS)

static box_t *box;

static struct {
    bool waits;               /* a report has been handed over and not been taken */
    bool host_asked;          /* for something since then, */
    box_cycles_t asked_at;    /* first at this time, */
    bool wedged;              /* and still long after */
    uint32_t frame;
    box_cycles_t frame_seen;
    bool off_the_bus;
    box_cycles_t back_at;
} endpoint;

/* Does the host show that it is there, without taking the report? */
static void note_host(box_cycles_t now)
{
    bool waited = endpoint.waits;
    bool asked = usb_requests_take_asked();
    endpoint.waits = tud_ready() && !tud_hid_ready();
    if (!waited || !endpoint.waits) {
        endpoint.host_asked = false;
        endpoint.wedged = false;
    } else if (asked && !endpoint.host_asked) {
        endpoint.host_asked = true;
        endpoint.asked_at = now;
    } else if (asked && now - endpoint.asked_at >= WEDGED_AFTER) {
        endpoint.wedged = true;
    }
}

static void send_next(box_cycles_t now)
{
    uint8_t bytes[OPMS_WIRE_SIZE];
    if (tud_hid_ready() && box_next_report(box, now, bytes))
        tud_hid_report(0, bytes, sizeof bytes);
}

static bool is_bus_alive(box_cycles_t now)
{
    uint32_t frame = usb_hw->sof_rd & USB_SOF_RD_BITS;
    if (frame != endpoint.frame) {
        endpoint.frame = frame;
        endpoint.frame_seen = now;
    }
    return now - endpoint.frame_seen < BUS_IS_ALIVE_FOR;
}

/* Enumerating anew gives the endpoint a fresh start. Pulses go on, and are told later. */
static void heal_endpoint(box_cycles_t now)
{
    bool alive = is_bus_alive(now);
    if (endpoint.off_the_bus) {
        if (now < endpoint.back_at)
            return;
        endpoint.off_the_bus = false;
        endpoint.waits = false;
        tud_connect();
    } else if (endpoint.wedged && alive) {
        endpoint.wedged = false;
        endpoint.off_the_bus = true;
        endpoint.back_at = now + OFF_THE_BUS_FOR;
        tud_disconnect();
        box_endpoint_healed(box, now);
    }
}

void usb_link_init(box_t *of)
{
    box = of;
    usb_requests_init(of);
    tusb_init();
}

void usb_link_work(void)
{
    tud_task();
    box_cycles_t now = cycle_clock_now();
    note_host(now);
    send_next(now);
    heal_endpoint(now);
}

bool usb_link_has_work(void)
{
    return tud_task_event_ready() || (tud_hid_ready() && box_has_report(box));
}
