/* SPDX-License-Identifier: Apache-2.0 */
/* The box as a USB device: USBDEVFS requests by umockdev, as libusb makes them. Requests (URBs) are
 * kept until they are due; interrupt IN is due when the box has an input report. */
#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>

#include <linux/usbdevice_fs.h>
#include <umockdev.h>

#include "mock_box.h"
#include "mock_device.h"

#define USB_PATH "/devices/pci0000:00/usb1/1-1"

enum { URBS_MAX = 64, ENDPOINT_IN = 0x81, DIRECTION_IN = 0x80, SETUP_SIZE = 8, TRANSFER_MAX = 512 };

/* The mocked node is always ready, so libusb's event thread spins; where devices come and go under
 * it, umockdev 0.17 drops a client that is in use, one time in four. */
const bool mock_device_replugs = false;

static const uint8_t device_descriptor[18] = {18, 1,    0,    2, 0, 0, 0,    64, 0x09,
                                              0x12, 1, 0, 0x20, 0, 1, 2, 3, 1};
static const char *const strings[] = {"", "OPMS", "Trigger box", MOCK_SERIAL};

/** A request that libusb has submitted. */
typedef struct urb {
    gulong address;          /* in libusb's memory */
    UMockdevIoctlData *data; /* struct usbdevfs_urb */
    UMockdevIoctlData *buffer;
    uint8_t endpoint, type;
    bool discarded;
} urb_t;

static UMockdevTestbed *testbed;
static UMockdevIoctlBase *handler;
static unsigned number = 1; /* of the device on its bus */
static char node[40];
static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER; /* of what follows */
static mock_box_t box;
static urb_t urbs[URBS_MAX];
static size_t urb_count;
static bool plugged;
static uint32_t faults;

static size_t configuration(uint8_t *bytes)
{
    uint32_t report_size = 0;
    mock_box_descriptor(&report_size);
    const uint8_t all[] = {9, 2, 41, 0, 1, 1, 0, 0x80, 50,
                           9, 4, 0, 0, 2, 3, 0, 0, 0,
                           9, 0x21, 0x11, 1, 0, 1, 0x22, (uint8_t)report_size,
                           (uint8_t)(report_size >> 8),
                           7, 5, ENDPOINT_IN, 3, 64, 0, 1,
                           7, 5, 0x02, 3, 64, 0, 1};
    memcpy(bytes, all, sizeof all);
    return sizeof all;
}

static int string_descriptor(uint8_t index, uint8_t *bytes)
{
    if (index == 0) {
        memcpy(bytes, "\4\3\t\4", 4);
        return 4;
    }
    if (index >= sizeof strings / sizeof *strings) {
        return -EPIPE;
    }
    int size = 2;
    for (const char *at = strings[index]; *at; ++at) {
        bytes[size++] = (uint8_t)*at;
        bytes[size++] = 0;
    }
    bytes[0] = (uint8_t)size;
    bytes[1] = 3;
    return size;
}

static int descriptor(uint8_t kind, uint8_t index, uint8_t *bytes)
{
    uint32_t size = 0;
    switch (kind) {
    case 1: memcpy(bytes, device_descriptor, sizeof device_descriptor); return 18;
    case 2: return (int)configuration(bytes);
    case 3: return string_descriptor(index, bytes);
    case 0x22:
        memcpy(bytes, mock_box_descriptor(&size), TRANSFER_MAX < size ? TRANSFER_MAX : size);
        return (int)size;
    default: return -EPIPE;
    }
}

/** A control request: 8 bytes of setup, then data. @return Bytes of the answer, or an error. */
static int control(const uint8_t *setup, const uint8_t *data, size_t size, uint8_t *answer)
{
    const uint8_t kind = setup[0], request = setup[1];
    if ((kind & DIRECTION_IN) && request == 6) {
        return descriptor(setup[3], setup[2], answer);
    }
    if (kind == 0xA1 && request == 1) { /* GET_REPORT */
        const uint32_t got = mock_box_get(&box, setup[2], answer);
        return got ? (int)got : -EPIPE;
    }
    if (kind == 0x21 && request == 9) { /* SET_REPORT */
        faults += !mock_box_set(&box, data, (uint32_t)size);
        return (int)size;
    }
    return kind & DIRECTION_IN ? -EPIPE : (int)size;
}

static void finish(urb_t *urb, int status, int size, const uint8_t *bytes)
{
    if (bytes && size > 0) {
        const size_t offset = urb->type == USBDEVFS_URB_TYPE_CONTROL ? SETUP_SIZE : 0;
        umockdev_ioctl_data_update(urb->buffer, offset, (guint8 *)bytes, size);
    }
    umockdev_ioctl_data_update(urb->data, G_STRUCT_OFFSET(struct usbdevfs_urb, status),
                               (guint8 *)&status, sizeof status);
    umockdev_ioctl_data_update(urb->data, G_STRUCT_OFFSET(struct usbdevfs_urb, actual_length),
                               (guint8 *)&size, sizeof size);
}

static void finish_control(urb_t *urb)
{
    uint8_t answer[TRANSFER_MAX];
    const uint8_t *const setup = urb->buffer->data;
    const int length = (int)urb->buffer->data_len - SETUP_SIZE;
    const int got = control(setup, setup + SETUP_SIZE, (size_t)length, answer);
    const int size = got > length ? length : got;
    finish(urb, size < 0 ? size : 0, size < 0 ? 0 : size,
           setup[0] & DIRECTION_IN ? answer : NULL);
}

/** Carry out a request if it is due. @return Whether it is done. */
static bool is_finished(urb_t *urb)
{
    uint8_t bytes[OPMS_WIRE_SIZE];
    if (!plugged || urb->discarded) {
        finish(urb, plugged ? -ENOENT : -ENODEV, 0, NULL);
    } else if (urb->type == USBDEVFS_URB_TYPE_CONTROL) {
        finish_control(urb);
    } else if (urb->endpoint & DIRECTION_IN) {
        if (!mock_box_next_input(&box, bytes)) {
            return false;
        }
        finish(urb, 0, sizeof bytes, bytes);
    } else {
        faults += !mock_box_output(&box, urb->buffer->data, (uint32_t)urb->buffer->data_len);
        finish(urb, 0, (int)urb->buffer->data_len, NULL);
    }
    return true;
}

static int submit(UMockdevIoctlClient *client)
{
    UMockdevIoctlData *const data =
        umockdev_ioctl_data_resolve(umockdev_ioctl_client_get_arg(client), 0,
                                    sizeof(struct usbdevfs_urb), NULL);
    const struct usbdevfs_urb *const wanted = (const struct usbdevfs_urb *)(void *)data->data;
    if (!plugged || urb_count == URBS_MAX) {
        return -ENODEV;
    }
    urb_t *const urb = &urbs[urb_count++];
    *urb = (urb_t){.address = data->client_addr,
                   .data = g_object_ref(data),
                   .endpoint = wanted->endpoint,
                   .type = wanted->type};
    urb->buffer = umockdev_ioctl_data_resolve(data, G_STRUCT_OFFSET(struct usbdevfs_urb, buffer),
                                              (gsize)wanted->buffer_length, NULL);
    if (urb->buffer) {
        g_object_ref(urb->buffer);
    }
    return 0;
}

static int discard(UMockdevIoctlClient *client)
{
    const gulong address = *(gulong *)(void *)umockdev_ioctl_client_get_arg(client)->data;
    for (size_t i = 0; i < urb_count; ++i) {
        if (urbs[i].address == address) {
            urbs[i].discarded = true;
            return 0;
        }
    }
    return -EINVAL;
}

static int reap(UMockdevIoctlClient *client)
{
    for (size_t i = 0; i < urb_count; ++i) {
        if (is_finished(&urbs[i])) {
            const urb_t urb = urbs[i];
            memmove(&urbs[i], &urbs[i + 1], (--urb_count - i) * sizeof urb);
            UMockdevIoctlData *const place = umockdev_ioctl_data_resolve(
                umockdev_ioctl_client_get_arg(client), 0, sizeof(void *), NULL);
            umockdev_ioctl_data_set_ptr(place, 0, urb.data);
            return 0;
        }
    }
    return plugged ? -EAGAIN : -ENODEV;
}

/** @return 0 or what the request yields, or a negative errno. */
static int serve(UMockdevIoctlClient *client, gulong request, bool *known)
{
    const uint32_t capabilities = USBDEVFS_CAP_BULK_CONTINUATION;
    switch (request) {
    case USBDEVFS_GET_CAPABILITIES:
        umockdev_ioctl_data_update(umockdev_ioctl_data_resolve(
                                       umockdev_ioctl_client_get_arg(client), 0, 4, NULL),
                                   0, (guint8 *)&capabilities, 4);
        return 0;
    case USBDEVFS_GETDRIVER: return -ENODATA;
    case USBDEVFS_SUBMITURB: return submit(client);
    case USBDEVFS_DISCARDURB: return discard(client);
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY: return reap(client);
    case USBDEVFS_CLAIMINTERFACE:
    case USBDEVFS_RELEASEINTERFACE:
    case USBDEVFS_SETCONFIGURATION:
    case USBDEVFS_IOCTL:
    case USBDEVFS_DISCONNECT_CLAIM:
    case USBDEVFS_CLEAR_HALT: return 0;
    default: *known = false; return 0;
    }
}

static gboolean on_ioctl(UMockdevIoctlBase *base, UMockdevIoctlClient *client, gpointer user)
{
    (void)base;
    (void)user;
    bool known = true;
    pthread_mutex_lock(&mutex);
    const int result = serve(client, umockdev_ioctl_client_get_request(client), &known);
    faults += !known;
    pthread_mutex_unlock(&mutex);
    if (known) {
        umockdev_ioctl_client_complete(client, result < 0 ? -1 : result,
                                       result < 0 ? -result : 0);
    }
    return known;
}

static void add_hex(GString *text, const uint8_t *bytes, size_t size)
{
    for (size_t i = 0; i < size; ++i) {
        g_string_append_printf(text, "%02X", bytes[i]);
    }
}

static void describe(GString *text)
{
    uint8_t all[18 + 64];
    memcpy(all, device_descriptor, 18);
    const size_t size = 18 + configuration(all + 18);
    g_string_append_printf(text, "P: " USB_PATH "\nN: bus/usb/001/%03u=", number);
    add_hex(text, all, size);
    g_string_append_printf(text, "\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\nE: DEVNAME=%s\n"
                                 "E: BUSNUM=001\nE: DEVNUM=%03u\nE: MAJOR=189\nE: MINOR=%u\n"
                                 "A: idVendor=1209\\n\nA: idProduct=0001\\n\nA: busnum=1\\n\n"
                                 "A: devnum=%u\\n\nA: speed=12\\n\nA: bConfigurationValue=1\\n\n"
                                 "A: bNumConfigurations=1\\n\nH: descriptors=",
                           node, number, number - 1, number);
    add_hex(text, all, size);
    g_string_append(text, "\n");
}

const char *mock_device_path(void)
{
    return "1-1:1.0";
}

bool mock_device_plug(uint32_t boot_id)
{
    GError *error = NULL;
    ++number;
    snprintf(node, sizeof node, "/dev/bus/usb/001/%03u", number);
    if (!testbed) {
        testbed = umockdev_testbed_new();
    }
    GString *const text = g_string_new("");
    describe(text);
    pthread_mutex_lock(&mutex);
    mock_box_init(&box, boot_id);
    plugged = true;
    pthread_mutex_unlock(&mutex);
    const bool added = umockdev_testbed_add_from_string(testbed, text->str, &error);
    g_string_free(text, TRUE);
    handler = umockdev_ioctl_base_new();
    g_signal_connect(handler, "handle-ioctl", G_CALLBACK(on_ioctl), NULL);
    if (!added || !umockdev_testbed_attach_ioctl(testbed, node, handler, &error)) {
        g_printerr("mock: %s\n", error ? error->message : "cannot add the device");
        return false;
    }
    umockdev_testbed_uevent(testbed, "/sys" USB_PATH, "add");
    return true;
}

/** The node stays as long as somebody has it open, as in a kernel; its requests end. */
void mock_device_unplug(void)
{
    pthread_mutex_lock(&mutex);
    plugged = false;
    pthread_mutex_unlock(&mutex);
    umockdev_testbed_uevent(testbed, "/sys" USB_PATH, "remove");
    umockdev_testbed_remove_device(testbed, "/sys" USB_PATH);
}

uint32_t mock_device_faults(void)
{
    pthread_mutex_lock(&mutex);
    const uint32_t count = faults;
    pthread_mutex_unlock(&mutex);
    return count;
}
