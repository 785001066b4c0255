/* SPDX-License-Identifier: Apache-2.0 */
/* TinyUSB's HID class answers every GET of a report, known or not, gives away a SET without its
 * id, and leaves out some of what chapter 9 of the standard asks for. Those requests are answered
 * here, as a class driver of our own around the HID class; all else is left to it. */
#include "usb_requests.h"

#include "cycle_clock.h"
#include "device/dcd.h"
#include "tusb.h"

#include "class/hid/hid_device.h"
#include "device/usbd_pvt.h"

static box_t *box;
static uint8_t get_bytes[OPMS_WIRE_SIZE];
static uint8_t set_bytes[OPMS_WIRE_SIZE];
static bool asked;

void usb_requests_init(box_t *of)
{
    box = of;
}

bool usb_requests_take_asked(void)
{
    bool was_asked = asked;
    asked = false;
    return was_asked;
}

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

static bool answer_class(uint8_t port, uint8_t stage, tusb_control_request_t const *request)
{
    switch (request->bRequest) {
    case HID_REQ_CONTROL_GET_REPORT:
        asked = true;
        return answer_get(port, stage, request);
    case HID_REQ_CONTROL_SET_REPORT:
        asked = true;
        return answer_set(port, stage, request);
    default:
        return hidd_control_xfer_cb(port, stage, request);
    }
}

/* What chapter 9 of the standard asks of an interface, and TinyUSB leaves out. */
static bool answer_standard(uint8_t port, uint8_t stage, tusb_control_request_t const *request)
{
    static uint8_t status[2] = {0, 0};
    if (request->bRequest == TUSB_REQ_GET_STATUS) {
        return stage != CONTROL_STAGE_SETUP ||
               tud_control_xfer(port, request, status, sizeof status);
    }
    if (request->bRequest == TUSB_REQ_SET_INTERFACE && request->wValue != 0) {
        /* There is no such alternate. To say so by `false` would be an acceptance here. */
        usbd_edpt_stall(port, 0x00);
        usbd_edpt_stall(port, 0x80);
        return true;
    }
    return hidd_control_xfer_cb(port, stage, request);
}

static bool answer_control(uint8_t port, uint8_t stage, tusb_control_request_t const *request)
{
    if (request->bmRequestType_bit.recipient != TUSB_REQ_RCPT_INTERFACE)
        return hidd_control_xfer_cb(port, stage, request);
    if (request->bmRequestType_bit.type == TUSB_REQ_TYPE_CLASS)
        return answer_class(port, stage, request);
    return answer_standard(port, stage, request);
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
    asked = true;
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

/* TinyUSB gives up the configuration in force before it finds that another one does not exist. So
 * the request is turned into one that it does not know, and stalls. */
void __real_dcd_event_handler(dcd_event_t const *event, bool in_isr);
void __wrap_dcd_event_handler(dcd_event_t const *event, bool in_isr);

void __wrap_dcd_event_handler(dcd_event_t const *event, bool in_isr)
{
    dcd_event_t changed = *event;
    tusb_control_request_t *request = &changed.setup_received;
    if (event->event_id == DCD_EVENT_SETUP_RECEIVED && request->bmRequestType == 0 &&
        request->bRequest == TUSB_REQ_SET_CONFIGURATION && request->wValue > 1)
        request->bRequest = UINT8_MAX;
    __real_dcd_event_handler(&changed, in_isr);
}
