/* SPDX-License-Identifier: Apache-2.0 */
#include "mock_usb.hpp"

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>

namespace {

std::string hex(const Bytes &bytes)
{
    std::string text;
    for (const std::uint8_t byte : bytes) {
        char digits[3];
        g_snprintf(digits, sizeof digits, "%02X", byte);
        text += digits;
    }
    return text;
}

std::string three_digits(int number)
{
    char text[8];
    g_snprintf(text, sizeof text, "%03d", number % 1000);
    return text;
}

UMockdevIoctlData *resolve(UMockdevIoctlData *data, gsize offset, gsize size)
{
    return umockdev_ioctl_data_resolve(data, offset, size, nullptr);
}

template <class T> void put(UMockdevIoctlData *data, gsize offset, const T &value)
{
    umockdev_ioctl_data_update(data, offset,
                               reinterpret_cast<guint8 *>(const_cast<T *>(&value)), sizeof value);
}

}  // namespace

MockUsb::MockUsb(UMockdevTestbed *testbed, PicobootModel &model, int port, int device_number)
    : testbed_(testbed), model_(model), handler_(umockdev_ioctl_base_new()),
      path_("/devices/pci0000:00/usb1/1-" + std::to_string(port)),
      node_("/dev/bus/usb/001/" + three_digits(device_number))
{
    const std::string number = std::to_string(device_number);
    const std::string bytes = hex(PicobootModel::descriptors());
    const std::string text =
        "P: " + path_ + "\nN: " + node_.substr(5) + "=" + bytes +
        "\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\nE: DEVNAME=" + node_ +
        "\nE: BUSNUM=001\nE: DEVNUM=" + three_digits(device_number) +
        "\nE: MAJOR=189\nE: MINOR=" + std::to_string(device_number - 1) +
        "\nA: idVendor=2e8a\\n\nA: idProduct=0003\\n\nA: busnum=1\\n\nA: devnum=" + number +
        "\\n\nA: speed=12\\n\nA: bConfigurationValue=1\\n\nA: bNumConfigurations=1\\n\n"
        "H: descriptors=" + bytes + "\n";
    GError *error = nullptr;
    g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(on_ioctl), this);
    if (!umockdev_testbed_add_from_string(testbed_, text.c_str(), &error) ||
        !umockdev_testbed_attach_ioctl(testbed_, node_.c_str(), handler_, &error)) {
        throw std::runtime_error(error->message);
    }
}

MockUsb::~MockUsb()
{
    unplug();
    for (Urb &urb : urbs_) {
        release(urb);
    }
    g_object_unref(handler_);
}

void MockUsb::unplug()
{
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!plugged_) {
            return;
        }
        plugged_ = false;
    }
    umockdev_testbed_detach_ioctl(testbed_, node_.c_str(), nullptr);
    umockdev_testbed_remove_device(testbed_, ("/sys" + path_).c_str());
}

gboolean MockUsb::on_ioctl(UMockdevIoctlBase *, UMockdevIoctlClient *client, gpointer self)
{
    auto *const usb = static_cast<MockUsb *>(self);
    const std::lock_guard<std::mutex> lock(usb->mutex_);
    const unsigned long request = umockdev_ioctl_client_get_request(client);
    const bool reaps = request == USBDEVFS_REAPURB || request == USBDEVFS_REAPURBNDELAY;
    int result = -ENODEV;
    if (usb->there()) {
        result = usb->handle(request, client);
    } else if (reaps && !usb->urbs_.empty()) {
        /* As the kernel does: what was under way ends, and only then the file says ENODEV. */
        for (Urb &urb : usb->urbs_) {
            urb.done = true;
            urb.status = -ESHUTDOWN;
            urb.length = 0;
        }
        result = usb->reap(client);
    }
    umockdev_ioctl_client_complete(client, result < 0 ? -1 : result, result < 0 ? -result : 0);
    return TRUE;
}

int MockUsb::handle(unsigned long request, UMockdevIoctlClient *client)
{
    UMockdevIoctlData *const argument = umockdev_ioctl_client_get_arg(client);
    switch (request) {
    case USBDEVFS_GET_CAPABILITIES:
        put(resolve(argument, 0, 4), 0,
            std::uint32_t{USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_NO_PACKET_SIZE_LIM});
        return 0;
    case USBDEVFS_CLAIMINTERFACE: return busy ? -EBUSY : 0;
    case USBDEVFS_RELEASEINTERFACE: return 0;
    case USBDEVFS_CLEAR_HALT: {
        unsigned endpoint = 0;
        std::memcpy(&endpoint, resolve(argument, 0, 4)->data, 4);
        model_.clear_halt(static_cast<std::uint8_t>(endpoint));
        return 0;
    }
    case USBDEVFS_SUBMITURB: return submit(client);
    case USBDEVFS_DISCARDURB: return discard(client);
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY: return reap(client);
    default: return -ENOTTY;
    }
}

int MockUsb::submit(UMockdevIoctlClient *client)
{
    UMockdevIoctlData *data =
        resolve(umockdev_ioctl_client_get_arg(client), 0, sizeof(usbdevfs_urb));
    usbdevfs_urb urb;
    std::memcpy(&urb, data->data, sizeof urb);
    g_object_ref(data);
    Urb mine{data, nullptr, data->client_addr, 0, 0, false, {}, 0};
    if (urb.buffer_length > 0) {
        mine.buffer = resolve(data, G_STRUCT_OFFSET(usbdevfs_urb, buffer),
                              static_cast<gsize>(urb.buffer_length));
        g_object_ref(mine.buffer);
    }
    if (transfers_left > 0) {
        --transfers_left;
    }
    carry_out(mine);
    urbs_.push_back(mine);
    return 0;
}

void MockUsb::finish(Urb &urb, int result)
{
    urb.done = result != PicobootModel::NOTHING_YET;
    urb.status = result == PicobootModel::STALL ? -EPIPE : 0;
    urb.length = result > 0 ? result : 0;
}

void MockUsb::carry_out(Urb &urb)
{
    usbdevfs_urb raw;
    std::memcpy(&raw, urb.urb->data, sizeof raw);
    const auto size = static_cast<std::size_t>(raw.buffer_length);
    if (raw.type == USBDEVFS_URB_TYPE_CONTROL) {
        carry_out_control(urb);
    } else if (raw.endpoint == PicobootModel::ENDPOINT_OUT) {
        const guint8 *const bytes = urb.buffer ? urb.buffer->data : nullptr;
        finish(urb, model_.bulk_out(Bytes(bytes, bytes + size)));
    } else if (raw.endpoint == PicobootModel::ENDPOINT_IN) {
        const int result = model_.bulk_in(size, urb.in);
        finish(urb, result == 0 ? static_cast<int>(urb.in.size()) : result);
    } else {
        finish(urb, PicobootModel::STALL);
    }
}

void MockUsb::carry_out_control(Urb &urb)
{
    const Bytes setup(urb.buffer->data, urb.buffer->data + 8);
    finish(urb, model_.control(setup, urb.in));
    urb.in_offset = 8; /* the host's buffer begins with the setup packet */
}

int MockUsb::reap(UMockdevIoctlClient *client)
{
    for (auto at = urbs_.begin(); at != urbs_.end(); ++at) {
        if (!at->done) {
            continue;
        }
        Urb urb = *at;
        urbs_.erase(at);
        if (!urb.in.empty() && urb.status == 0) {
            umockdev_ioctl_data_update(urb.buffer, urb.in_offset, urb.in.data(),
                                       static_cast<gint>(urb.in.size()));
        }
        put(urb.urb, G_STRUCT_OFFSET(usbdevfs_urb, status), urb.status);
        put(urb.urb, G_STRUCT_OFFSET(usbdevfs_urb, actual_length), urb.length);
        UMockdevIoctlData *const out =
            resolve(umockdev_ioctl_client_get_arg(client), 0, sizeof(void *));
        umockdev_ioctl_data_set_ptr(out, 0, urb.urb);
        release(urb);
        return 0;
    }
    return -EAGAIN;
}

int MockUsb::discard(UMockdevIoctlClient *client)
{
    unsigned long address = 0;
    std::memcpy(&address, umockdev_ioctl_client_get_arg(client)->data, sizeof address);
    for (Urb &urb : urbs_) {
        if (urb.address == address && !urb.done) {
            urb.done = true;
            urb.status = -ENOENT;
            return 0;
        }
    }
    return -EINVAL;
}

void MockUsb::release(Urb &urb)
{
    g_object_unref(urb.urb);
    if (urb.buffer) {
        g_object_unref(urb.buffer);
    }
}
