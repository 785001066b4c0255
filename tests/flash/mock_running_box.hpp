/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A running trigger box of this process, as far as flashing needs one: hidapi finds it, it tells
 * its identity, and it leaves the bus when it is told to become a bootloader. */
#ifndef TESTS_FLASH_MOCK_RUNNING_BOX_HPP
#define TESTS_FLASH_MOCK_RUNNING_BOX_HPP

#include <atomic>
#include <cstdint>
#include <string>

#include <opms/wire.h>
#include <umockdev.h>

class MockRunningBox {
public:
    /** @param node N of /dev/hidrawN; another one each time, as with a real kernel.
     * @param serial 16 hex digits. */
    MockRunningBox(UMockdevTestbed *testbed, int node, const std::string &serial,
                   std::uint8_t firmware_patch);
    ~MockRunningBox();
    MockRunningBox(const MockRunningBox &) = delete;
    MockRunningBox &operator=(const MockRunningBox &) = delete;

    /** It was told to become a bootloader, with the magic word. */
    bool has_left() const { return left_; }

private:
    static gboolean on_ioctl(UMockdevIoctlBase *base, UMockdevIoctlClient *client, gpointer self);
    int handle(unsigned long request, UMockdevIoctlData *data);
    int set_feature(const std::uint8_t *bytes, std::size_t size);
    void leave();

    UMockdevTestbed *testbed_;
    UMockdevIoctlBase *handler_;
    std::string usb_path_, hid_path_, raw_path_, node_;
    opms_identity_report_t identity_{};
    int terminal_;
    std::atomic<bool> left_{false};
};

#endif
