/* SPDX-License-Identifier: Apache-2.0 */
/* /dev/hidraw0: ioctls by umockdev, reports over the pseudo terminal that umockdev puts in the
 * node's place. A terminal is a stream, so the mock sends a report only when the one before it has
 * been read, and puts together what comes in pieces. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <termios.h>
#include <unistd.h>

#include <linux/hidraw.h>
#include <umockdev.h>

#include "mock_box.h"
#include "mock_device.h"

#define USB_PATH "/devices/pci0000:00/usb1/1-1"
#define HID_PATH USB_PATH "/1-1:1.0/0003:1209:0001.0001"
#define RAW_PATH HID_PATH "/hidraw/hidraw"

const bool mock_device_replugs = true;

static UMockdevTestbed *testbed;
static UMockdevIoctlBase *handler;
static pthread_t peer;
static unsigned node; /* /dev/hidrawN */
static char path[32];
static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER; /* of what follows */
static mock_box_t box;
static bool stopping;
static uint32_t faults;

static void describe(GString *text)
{
    uint32_t size = 0;
    const uint8_t *const descriptor = mock_box_descriptor(&size);
    g_string_append(text, "P: " USB_PATH "\nE: DEVTYPE=usb_device\n"
                          "E: SUBSYSTEM=usb\nA: idVendor=1209\nA: idProduct=0001\n"
                          "A: bcdDevice=0020\nA: manufacturer=OPMS\nA: product=Trigger box\n"
                          "A: serial=" MOCK_SERIAL "\n\n");
    g_string_append(text, "P: " USB_PATH "/1-1:1.0\nE: DEVTYPE=usb_interface\n"
                          "E: SUBSYSTEM=usb\nA: bInterfaceNumber=00\n\n");
    g_string_append(text, "P: " HID_PATH "\nE: SUBSYSTEM=hid\nE: HID_ID=0003:00001209:00000001\n"
                          "E: HID_NAME=OPMS Trigger box\nE: HID_UNIQ=" MOCK_SERIAL "\n"
                          "H: report_descriptor=");
    for (uint32_t i = 0; i < size; ++i) {
        g_string_append_printf(text, "%02X", descriptor[i]);
    }
    g_string_append_printf(text, "\n\nP: " RAW_PATH "%u\nN: hidraw%u\nE: SUBSYSTEM=hidraw\n"
                                 "E: DEVNAME=%s\nE: MAJOR=241\nE: MINOR=%u\nA: dev=241:%u\\n\n"
                                 "L: device=../../../0003:1209:0001.0001\n",
                           node, node, path, node, node);
}

/** A feature report comes (6) or goes (7), as the kernel's number of the request says. */
static int feature(UMockdevIoctlData *data, unsigned number, int size, int *error)
{
    uint8_t bytes[OPMS_WIRE_SIZE];
    pthread_mutex_lock(&mutex);
    int result = size;
    if (number == 6) {
        faults += !mock_box_set(&box, data->data, (uint32_t)size);
    } else {
        const uint32_t got = mock_box_get(&box, data->data[0], bytes);
        result = got ? (int)got : -1;
        *error = got ? 0 : EPIPE;
        umockdev_ioctl_data_update(data, 0, bytes, (int)got);
    }
    pthread_mutex_unlock(&mutex);
    return result;
}

static gboolean on_ioctl(UMockdevIoctlBase *base, UMockdevIoctlClient *client, gpointer user)
{
    (void)base;
    (void)user;
    const gulong request = umockdev_ioctl_client_get_request(client);
    if (_IOC_TYPE(request) != 'H') {
        return FALSE;
    }
    const int size = (int)_IOC_SIZE(request);
    UMockdevIoctlData *const data = umockdev_ioctl_data_resolve(
        umockdev_ioctl_client_get_arg(client), 0, (gsize)size, NULL);
    uint32_t descriptor_size = 0;
    const uint8_t *const descriptor = mock_box_descriptor(&descriptor_size);
    int result = 0, error = 0;
    switch (_IOC_NR(request)) {
    case 1: umockdev_ioctl_data_update(data, 0, (guint8 *)&descriptor_size, 4); break;
    case 2:
        umockdev_ioctl_data_update(data, 0, (guint8 *)&descriptor_size, 4);
        umockdev_ioctl_data_update(data, 4, (guint8 *)descriptor, (int)descriptor_size);
        break;
    case 6:
    case 7: result = feature(data, _IOC_NR(request), size, &error); break;
    default: result = -1; error = EINVAL;
    }
    umockdev_ioctl_client_complete(client, result, error);
    return TRUE;
}

/** Send the next input report, once the other end has read the one before it. */
static void send_input(int master, int slave)
{
    uint8_t bytes[OPMS_WIRE_SIZE];
    /* What was written lies in the kernel until a worker takes it over to the reader's side. poll()
     * waits for that worker; FIONREAD does not, and says "all read" too early on a busy machine. */
    struct pollfd unread = {slave, POLLIN, 0};
    if (poll(&unread, 1, 0) != 0 || !mock_box_next_input(&box, bytes)) {
        return;
    }
    faults += write(master, bytes, sizeof bytes) != (ssize_t)sizeof bytes;
}

static void *run_peer(void *argument)
{
    const int master = *(const int *)argument;
    const int slave =
        (int)syscall(SYS_openat, AT_FDCWD, ptsname(master), O_RDWR | O_NOCTTY, 0);
    uint8_t bytes[OPMS_WIRE_SIZE];
    size_t have = 0;
    for (bool go_on = slave >= 0; go_on;) {
        struct pollfd input = {master, POLLIN, 0};
        const bool readable = poll(&input, 1, 1) > 0 && (input.revents & POLLIN);
        const ssize_t got = readable ? read(master, bytes + have, sizeof bytes - have) : 0;
        have += got > 0 ? (size_t)got : 0;
        pthread_mutex_lock(&mutex);
        if (have == sizeof bytes) {
            faults += !mock_box_output(&box, bytes, sizeof bytes);
            have = 0;
        }
        send_input(master, slave);
        go_on = !stopping;
        pthread_mutex_unlock(&mutex);
    }
    close(slave);
    close(master); /* the other end sees that as the device's end */
    return NULL;
}

const char *mock_device_path(void)
{
    return path;
}

bool mock_device_plug(uint32_t boot_id)
{
    static int master;
    ++node;
    snprintf(path, sizeof path, "/dev/hidraw%u", node);
    GError *error = NULL;
    if (!testbed) {
        testbed = umockdev_testbed_new();
    }
    GString *const text = g_string_new("");
    describe(text);
    const bool added = umockdev_testbed_add_from_string(testbed, text->str, &error);
    g_string_free(text, TRUE);
    handler = umockdev_ioctl_base_new();
    g_signal_connect(handler, "handle-ioctl", G_CALLBACK(on_ioctl), NULL);
    if (!added || !umockdev_testbed_attach_ioctl(testbed, path, handler, &error)) {
        g_printerr("mock: %s\n", error ? error->message : "cannot add the device");
        return false;
    }
    master = dup(umockdev_testbed_get_dev_fd(testbed, path));
    struct termios raw;
    if (master < 0 || tcgetattr(master, &raw) != 0) {
        return false;
    }
    cfmakeraw(&raw);
    tcsetattr(master, TCSANOW, &raw);
    mock_box_init(&box, boot_id);
    stopping = false;
    return pthread_create(&peer, NULL, run_peer, &master) == 0;
}

/** umockdev keeps a note of each terminal, and fails where the system gives the same one again. */
static void forget_terminal(int master)
{
    char name[64], note[300];
    snprintf(name, sizeof name, "%s", ptsname(master));
    for (char *at = name; *at; ++at) {
        *at = *at == '/' ? '_' : *at;
    }
    gchar *const root = umockdev_testbed_get_root_dir(testbed);
    snprintf(note, sizeof note, "%s/dev/.ptymap/%s", root, name);
    unlink(note);
    g_free(root);
}

void mock_device_unplug(void)
{
    pthread_mutex_lock(&mutex);
    stopping = true;
    pthread_mutex_unlock(&mutex);
    pthread_join(peer, NULL);
    forget_terminal(umockdev_testbed_get_dev_fd(testbed, path));
    close(umockdev_testbed_get_dev_fd(testbed, path));
    umockdev_testbed_detach_ioctl(testbed, path, NULL);
    g_clear_object(&handler);
    char raw[sizeof "/sys" RAW_PATH + 10];
    snprintf(raw, sizeof raw, "/sys" RAW_PATH "%u", node);
    umockdev_testbed_remove_device(testbed, raw);
    umockdev_testbed_remove_device(testbed, "/sys" HID_PATH);
    umockdev_testbed_remove_device(testbed, "/sys" USB_PATH "/1-1:1.0");
    umockdev_testbed_remove_device(testbed, "/sys" USB_PATH);
}

uint32_t mock_device_faults(void)
{
    pthread_mutex_lock(&mutex);
    const uint32_t count = faults;
    pthread_mutex_unlock(&mutex);
    return count;
}
