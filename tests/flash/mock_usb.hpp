/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Makes a PicobootModel a USB device of this process: umockdev shows it in /sys and /dev and hands
 * us the ioctls that libusb makes, unmodified. */
#ifndef TESTS_FLASH_MOCK_USB_HPP
#define TESTS_FLASH_MOCK_USB_HPP

#include <deque>
#include <mutex>
#include <string>

#include <umockdev.h>

#include "picoboot_model.hpp"

class MockUsb {
public:
    /** @param port 1 to 9 of a root hub on bus 1. */
    MockUsb(UMockdevTestbed *testbed, PicobootModel &model, int port, int device_number);
    ~MockUsb();
    MockUsb(const MockUsb &) = delete;
    MockUsb &operator=(const MockUsb &) = delete;

    /** Out of /sys and /dev; what is still open gets ENODEV. */
    void unplug();

    std::string node() const { return node_; }

    long transfers_left = -1; /**< then it is as if unplugged; -1: never */
    bool busy = false;        /**< another program has claimed the interface */

private:
    struct Urb {
        UMockdevIoctlData *urb, *buffer;
        unsigned long address;
        int status, length; /**< as reaped */
        bool done;
        Bytes in; /**< for the host's buffer, from @p in_offset on */
        std::size_t in_offset;
    };

    static gboolean on_ioctl(UMockdevIoctlBase *base, UMockdevIoctlClient *client, gpointer self);
    bool there() const { return plugged_ && transfers_left != 0 && model_.powered; }
    int handle(unsigned long request, UMockdevIoctlClient *client);
    int submit(UMockdevIoctlClient *client);
    int reap(UMockdevIoctlClient *client);
    int discard(UMockdevIoctlClient *client);
    void carry_out(Urb &urb);
    void carry_out_control(Urb &urb);
    void finish(Urb &urb, int result);
    static void release(Urb &urb);

    UMockdevTestbed *testbed_;
    PicobootModel &model_;
    UMockdevIoctlBase *handler_;
    std::string path_, node_;
    std::deque<Urb> urbs_;
    std::mutex mutex_;
    bool plugged_ = true;
};

#endif
