/* SPDX-License-Identifier: Apache-2.0 */
#include "mock_running_box.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include <linux/hidraw.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

namespace {

/** Usage page 0xFF4F, usage 1, and feature reports 0x20 and 0x23 of 63 bytes. */
const std::uint8_t DESCRIPTOR[] = {0x06, 0x4F, 0xFF, 0x09, 0x01, 0xA1, 0x01, 0x15, 0x00, 0x26,
                                   0xFF, 0x00, 0x75, 0x08, 0x95, 0x3F, 0x85, 0x20, 0x09, 0x01,
                                   0xB1, 0x02, 0x85, 0x23, 0x09, 0x01, 0xB1, 0x02, 0xC0};

std::string descriptor_hex()
{
    std::string text;
    for (const std::uint8_t byte : DESCRIPTOR) {
        char digits[3];
        g_snprintf(digits, sizeof digits, "%02X", byte);
        text += digits;
    }
    return text;
}

}  // namespace

MockRunningBox::MockRunningBox(UMockdevTestbed *testbed, int node, const std::string &serial,
                               std::uint8_t firmware_patch)
    : testbed_(testbed), handler_(umockdev_ioctl_base_new()),
      usb_path_("/devices/pci0000:00/usb1/1-" + std::to_string(node)),
      hid_path_(usb_path_ + "/1-1:1.0/0003:1209:0001.0001"),
      raw_path_(hid_path_ + "/hidraw/hidraw" + std::to_string(node)),
      node_("/dev/hidraw" + std::to_string(node))
{
    identity_.firmware_version[1] = 2;
    identity_.firmware_version[2] = firmware_patch;
    identity_.boot_id = 77;
    identity_.clock_hz = OPMS_BOX_CLOCK_HZ;
    identity_.capabilities = OPMS_CAPABILITY_BOOTLOADER;
    identity_.start_cycles = OPMS_BOX_START_CYCLES;
    identity_.ring_entries = OPMS_BOX_RING_ENTRIES;
    identity_.history_entries = OPMS_BOX_HISTORY_ENTRIES;
    std::strcpy(identity_.git_hash, "0123456789abcdef0123");
    for (std::size_t i = 0; i < 8; ++i) {
        identity_.unique_id[i] =
            static_cast<std::uint8_t>(std::stoul(serial.substr(2 * i, 2), nullptr, 16));
    }
    const std::string number = std::to_string(node);
    const std::string text =
        "P: " + usb_path_ + "\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\nA: idVendor=1209\n"
        "A: idProduct=0001\nA: bcdDevice=0020\nA: product=Trigger box\nA: serial=" + serial +
        "\n\nP: " + usb_path_ + "/1-1:1.0\nE: DEVTYPE=usb_interface\nE: SUBSYSTEM=usb\n"
        "A: bInterfaceNumber=00\n\nP: " + hid_path_ + "\nE: SUBSYSTEM=hid\n"
        "E: HID_ID=0003:00001209:00000001\nE: HID_NAME=OPMS Trigger box\nE: HID_UNIQ=" + serial +
        "\nH: report_descriptor=" + descriptor_hex() + "\n\nP: " + raw_path_ + "\nN: hidraw" +
        number + "\nE: SUBSYSTEM=hidraw\nE: DEVNAME=" + node_ + "\nE: MAJOR=241\nE: MINOR=" +
        number + "\nA: dev=241:" + number + "\\n\nL: device=../../../0003:1209:0001.0001\n";
    GError *error = nullptr;
    g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(on_ioctl), this);
    if (!umockdev_testbed_add_from_string(testbed, text.c_str(), &error) ||
        !umockdev_testbed_attach_ioctl(testbed, node_.c_str(), handler_, &error)) {
        throw std::runtime_error(error->message);
    }
    terminal_ = umockdev_testbed_get_dev_fd(testbed, node_.c_str());
    termios settings;
    if (tcgetattr(terminal_, &settings) == 0) {
        cfmakeraw(&settings);
        tcsetattr(terminal_, TCSANOW, &settings);
    }
}

MockRunningBox::~MockRunningBox()
{
    leave();
    umockdev_testbed_detach_ioctl(testbed_, node_.c_str(), nullptr);
    for (const std::string &path : {raw_path_, hid_path_, usb_path_ + "/1-1:1.0", usb_path_}) {
        umockdev_testbed_remove_device(testbed_, ("/sys" + path).c_str());
    }
    g_object_unref(handler_);
}

/** Off the bus: who reads the node sees its end. umockdev's note of the terminal must go, too, as
 * the system may give the same one to the next device. */
void MockRunningBox::leave()
{
    if (left_.exchange(true)) {
        return;
    }
    std::string name = ptsname(terminal_);
    std::replace(name.begin(), name.end(), '/', '_');
    gchar *const root = umockdev_testbed_get_root_dir(testbed_);
    unlink((std::string(root) + "/dev/.ptymap/" + name).c_str());
    g_free(root);
    close(terminal_);
}

gboolean MockRunningBox::on_ioctl(UMockdevIoctlBase *, UMockdevIoctlClient *client, gpointer self)
{
    const unsigned long request = umockdev_ioctl_client_get_request(client);
    UMockdevIoctlData *data = umockdev_ioctl_data_resolve(
        umockdev_ioctl_client_get_arg(client), 0, _IOC_SIZE(request), nullptr);
    const int result = static_cast<MockRunningBox *>(self)->handle(request, data);
    umockdev_ioctl_client_complete(client, result < 0 ? -1 : result, result < 0 ? -result : 0);
    return TRUE;
}

int MockRunningBox::handle(unsigned long request, UMockdevIoctlData *data)
{
    if (left_ || _IOC_TYPE(request) != 'H') {
        return left_ ? -ENODEV : -ENOTTY;
    }
    hidraw_report_descriptor descriptor{};
    descriptor.size = sizeof DESCRIPTOR;
    std::memcpy(descriptor.value, DESCRIPTOR, sizeof DESCRIPTOR);
    std::uint8_t report[OPMS_WIRE_SIZE];
    const std::size_t size = _IOC_SIZE(request);
    switch (_IOC_NR(request)) {
    case 1: /* size of the descriptor */
        umockdev_ioctl_data_update(data, 0, reinterpret_cast<guint8 *>(&descriptor.size), 4);
        return 0;
    case 2: /* the descriptor */
        umockdev_ioctl_data_update(data, 0, reinterpret_cast<guint8 *>(&descriptor),
                                   4 + sizeof DESCRIPTOR);
        return 0;
    case 6: return set_feature(data->data, size);
    case 7: /* get a feature report */
        if (data->data[0] != OPMS_REPORT_IDENTITY || size < sizeof report) {
            return -EPIPE;
        }
        opms_wire_write_identity(&identity_, report);
        umockdev_ioctl_data_update(data, 0, report, sizeof report);
        return sizeof report;
    default: return -EINVAL;
    }
}

int MockRunningBox::set_feature(const std::uint8_t *bytes, std::size_t size)
{
    if (opms_wire_read_bootloader(bytes, size) != OPMS_WIRE_OK) {
        return -EPIPE;
    }
    leave();
    return static_cast<int>(size);
}
