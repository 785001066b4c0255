/* SPDX-License-Identifier: Apache-2.0 */
/* TinyUSB's HID class runs underneath. It answers every GET of a report, known or not, and gives
 * away a SET without its id; so the two requests are answered here, and all else is left to it. */
#include "usb_link.h"

#include "cycle_clock.h"
#include "hardware/structs/usb.h"
#include "tusb.h"

#include "class/hid/hid_device.h"
#include "device/usbd_pvt.h"

/* A report that is not taken for this long, though the host keeps the bus alive, is wedged. */
#define WEDGED_AFTER (2 * BOX_CYCLES_PER_S)
/* Frames that start every ms show that it does. */
#define BUS_IS_ALIVE_FOR (200 * BOX_CYCLES_PER_MS)
/* Long enough for a hub, which looks at its ports every 256 ms at most, to see it. */
#define OFF_THE_BUS_FOR (300 * BOX_CYCLES_PER_MS)

static box_t *box;
static uint8_t get_bytes[OPMS_WIRE_SIZE];
static uint8_t set_bytes[OPMS_WIRE_SIZE];

static struct {
    bool waits;               /* a report has been handed over and not been taken */
    box_cycles_t waits_since;
    uint32_t frame;
    box_cycles_t frame_seen;
    bool off_the_bus;
    box_cycles_t back_at;
} endpoint;

/* --- requests of the host --------------------------------------------------------------------- */

static uint8_t report_type(tusb_control_request_t const *request)
{
    return (uint8_t)(request->wValue >> 8);
}

static uint8_t report_id(tusb_control_request_t const *request)
{
    return (uint8_t)request->wValue;
}

static bool answer_get(uint8_t port, uint8_t stage, tusb_control_request_t const *request)
{
    if (stage != CONTROL_STAGE_SETUP)
        return true;
    if (report_type(request) != HID_REPORT_TYPE_FEATURE ||
        !box_get_feature(box, report_id(request), get_bytes))
        return false;
    return tud_control_xfer(port, request, get_bytes, sizeof get_bytes);
}

static void carry_out_set(tusb_control_request_t const *request)
{
    if (report_type(request) == HID_REPORT_TYPE_OUTPUT)
        box_command(box, set_bytes, request->wLength, cycle_clock_now());
    else
        box_set_feature(box, set_bytes, request->wLength, cycle_clock_now());
}

static bool answer_set(uint8_t port, uint8_t stage, tusb_control_request_t const *request)
{
    switch (stage) {
    case CONTROL_STAGE_SETUP:
        if (request->wLength > sizeof set_bytes || report_type(request) == HID_REPORT_TYPE_INPUT)
            return false;
        set_bytes[0] = 0;
        return tud_control_xfer(port, request, set_bytes, request->wLength);
    case CONTROL_STAGE_DATA:
        return set_bytes[0] == report_id(request);
    default:
        carry_out_set(request);
        return true;
    }
}

static bool answer_control(uint8_t port, uint8_t stage, tusb_control_request_t const *request)
{
    if (request->bmRequestType_bit.recipient == TUSB_REQ_RCPT_INTERFACE &&
        request->bmRequestType_bit.type == TUSB_REQ_TYPE_CLASS) {
        if (request->bRequest == HID_REQ_CONTROL_GET_REPORT)
            return answer_get(port, stage, request);
        if (request->bRequest == HID_REQ_CONTROL_SET_REPORT)
            return answer_set(port, stage, request);
    }
    return hidd_control_xfer_cb(port, stage, request);
}

/* TinyUSB asks for drivers of the application's own and tries them first. */
usbd_class_driver_t const *usbd_app_driver_get_cb(uint8_t *count)
{
    static const usbd_class_driver_t driver = {
        .name = "box",
        .init = hidd_init,
        .deinit = hidd_deinit,
        .reset = hidd_reset,
        .open = hidd_open,
        .control_xfer_cb = answer_control,
        .xfer_cb = hidd_xfer_cb,
    };
    *count = 1;
    return &driver;
}

/* From the OUT endpoint; the report's id is its first byte. */
void tud_hid_set_report_cb(uint8_t instance, uint8_t id, hid_report_type_t type,
                           uint8_t const *bytes, uint16_t size)
{
    (void)instance;
    (void)id;
    (void)type;
    box_command(box, bytes, size, cycle_clock_now());
}

/* TinyUSB wants it; answer_get() is in its place. */
uint16_t tud_hid_get_report_cb(uint8_t instance, uint8_t id, hid_report_type_t type,
                               uint8_t *bytes, uint16_t size)
{
    (void)instance;
    (void)id;
    (void)type;
    (void)bytes;
    (void)size;
    return 0;
}

/* --- reports to the host ---------------------------------------------------------------------- */

static void send_next(box_cycles_t now)
{
    uint8_t bytes[OPMS_WIRE_SIZE];
    if (!tud_hid_ready()) {
        endpoint.waits_since = endpoint.waits ? endpoint.waits_since : now;
        endpoint.waits = tud_ready();
        return;
    }
    endpoint.waits = false;
    if (box_next_report(box, now, bytes))
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
    } else if (endpoint.waits && alive && now - endpoint.waits_since >= WEDGED_AFTER) {
        endpoint.off_the_bus = true;
        endpoint.back_at = now + OFF_THE_BUS_FOR;
        tud_disconnect();
        box_endpoint_healed(box, now);
    }
}

void usb_link_init(box_t *of)
{
    box = of;
    tusb_init();
}

void usb_link_work(void)
{
    tud_task();
    box_cycles_t now = cycle_clock_now();
    send_next(now);
    heal_endpoint(now);
}

bool usb_link_has_work(void)
{
    return tud_task_event_ready() || (tud_hid_ready() && box_has_report(box));
}
