/* SPDX-License-Identifier: Apache-2.0 */
#include "usb_descriptors.h"

#include <opms/version.h>
#include <opms/wire.h>

#include "tusb.h"

#define ENDPOINT_IN 0x81
#define ENDPOINT_OUT 0x01
#define POLL_MS 1
#define MAX_CURRENT_MA 100

enum { STRING_LANGUAGE, STRING_MANUFACTURER, STRING_PRODUCT, STRING_SERIAL, STRINGS };

/* A report of 63 bytes behind its id, which is the first byte of the 64 that are sent. */
#define REPORT(id, main_item)                                                               \
    HID_REPORT_ID(id) HID_USAGE(OPMS_USB_USAGE), HID_REPORT_COUNT(OPMS_WIRE_SIZE - 1),      \
        main_item(HID_DATA | HID_VARIABLE | HID_ABSOLUTE)

static const uint8_t report_descriptor[] = {
    HID_USAGE_PAGE_N(OPMS_USB_USAGE_PAGE, 2),
    HID_USAGE(OPMS_USB_USAGE),
    HID_COLLECTION(HID_COLLECTION_APPLICATION),
    HID_LOGICAL_MIN(0),
    HID_LOGICAL_MAX_N(0xFF, 2),
    HID_REPORT_SIZE(8),
    REPORT(OPMS_REPORT_TRIGGER, HID_INPUT),
    REPORT(OPMS_REPORT_PONG, HID_INPUT),
    REPORT(OPMS_REPORT_STATUS, HID_INPUT),
    REPORT(OPMS_REPORT_EVENT, HID_INPUT),
    REPORT(OPMS_REPORT_COMMAND, HID_OUTPUT),
    REPORT(OPMS_REPORT_IDENTITY, HID_FEATURE),
    REPORT(OPMS_REPORT_SETTINGS, HID_FEATURE),
    REPORT(OPMS_REPORT_HISTORY, HID_FEATURE),
    REPORT(OPMS_REPORT_BOOTLOADER, HID_FEATURE),
    HID_COLLECTION_END,
};

static const tusb_desc_device_t device_descriptor = {
    .bLength = sizeof(tusb_desc_device_t),
    .bDescriptorType = TUSB_DESC_DEVICE,
    .bcdUSB = 0x0200,
    .bMaxPacketSize0 = CFG_TUD_ENDPOINT0_SIZE,
    .idVendor = OPMS_USB_VENDOR_ID,
    .idProduct = OPMS_USB_PRODUCT_ID,
    .bcdDevice = OPMS_VERSION_MAJOR << 8 | OPMS_VERSION_MINOR << 4 | OPMS_VERSION_PATCH,
    .iManufacturer = STRING_MANUFACTURER,
    .iProduct = STRING_PRODUCT,
    .iSerialNumber = STRING_SERIAL,
    .bNumConfigurations = 1,
};

static const uint8_t configuration_descriptor[] = {
    TUD_CONFIG_DESCRIPTOR(1, 1, 0, TUD_CONFIG_DESC_LEN + TUD_HID_INOUT_DESC_LEN, 0,
                          MAX_CURRENT_MA),
    TUD_HID_INOUT_DESCRIPTOR(0, 0, HID_ITF_PROTOCOL_NONE, sizeof report_descriptor, ENDPOINT_OUT,
                             ENDPOINT_IN, OPMS_WIRE_SIZE, POLL_MS),
};

static char serial[17];

void usb_descriptors_set_serial(const uint8_t unique_id[8])
{
    static const char digits[] = "0123456789abcdef";
    for (int i = 0; i < 8; i++) {
        serial[2 * i] = digits[unique_id[i] >> 4];
        serial[2 * i + 1] = digits[unique_id[i] & 15];
    }
}

uint8_t const *tud_descriptor_device_cb(void)
{
    return (const uint8_t *)&device_descriptor;
}

uint8_t const *tud_descriptor_configuration_cb(uint8_t index)
{
    return index == 0 ? configuration_descriptor : NULL;
}

uint8_t const *tud_hid_descriptor_report_cb(uint8_t instance)
{
    (void)instance;
    return report_descriptor;
}

static const char *string_of(uint8_t index)
{
    switch (index) {
    case STRING_MANUFACTURER:
        return "OPMS";
    case STRING_PRODUCT:
        return "OPMS trigger box";
    case STRING_SERIAL:
        return serial;
    default:
        return NULL;
    }
}

uint16_t const *tud_descriptor_string_cb(uint8_t index, uint16_t language)
{
    (void)language;
    static uint16_t descriptor[1 + 31];
    uint16_t length = 0;
    if (index == STRING_LANGUAGE) {
        descriptor[++length] = 0x0409; /* English */
    } else {
        const char *text = string_of(index);
        if (text == NULL)
            return NULL; /* stalls */
        while (text[length] != '\0' && length < 31) {
            descriptor[1 + length] = (uint8_t)text[length];
            length++;
        }
    }
    descriptor[0] = (uint16_t)(TUSB_DESC_STRING << 8 | (2 * length + 2));
    return descriptor;
}
