/* SPDX-License-Identifier: Apache-2.0 */
/* From a running box to the same box with new firmware: hidapi and libusb, both unmodified. */
#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include <unity.h>

#include "box_flash_hid.hpp"
#include "firmware_bytes.hpp"
#include "mock_running_box.hpp"
#include "mock_usb.hpp"
#include "picoboot_usb.hpp"

using namespace opms::flash;

static const std::string SERIAL = "E66178C1A3551E2B";

static UMockdevTestbed *testbed;

void setUp(void)
{
    testbed = umockdev_testbed_new();
}

void tearDown(void)
{
    g_object_unref(testbed);
}

/** One board: a box, then a bootloader, then a box again, as its flash says. It changes while the
 * session sleeps. */
struct Board {
    PicobootModel model{64 * 1024};
    std::unique_ptr<MockRunningBox> box;
    std::unique_ptr<MockUsb> bootloader;

    void live()
    {
        if (box && box->has_left()) {
            box.reset();
            bootloader = std::make_unique<MockUsb>(testbed, model, 2, 5);
        } else if (bootloader && model.rebooting && rom_would_boot(model.flash.bytes)) {
            bootloader.reset();
            box = std::make_unique<MockRunningBox>(testbed, 3, SERIAL, 9);
        }
    }
};

static void test_a_running_box_becomes_the_same_box_with_new_firmware(void)
{
    const Bytes firmware = make_firmware(2 * 4096, 8);
    const Bytes file = make_uf2(firmware);
    Board board;
    board.box = std::make_unique<MockRunningBox>(testbed, 1, SERIAL, 8);
    HidBoxes boxes;
    UsbBootloaders bootloaders;
    TEST_ASSERT_EQUAL_STRING("0.2.8", boxes.version(SERIAL).firmware.c_str());
    const SessionHooks hooks = {[](const std::string &) {}, [](std::size_t, std::size_t) {},
                                [&](int ms) {
                                    std::this_thread::sleep_for(std::chrono::milliseconds(ms));
                                    board.live();
                                }};

    const BoxVersion version =
        flash_session(uf2_parse(file.data(), file.size()), {}, bootloaders, boxes, hooks);

    TEST_ASSERT_EQUAL_STRING(SERIAL.c_str(), version.unique_id.c_str());
    TEST_ASSERT_EQUAL_STRING("0.2.9", version.firmware.c_str());
    TEST_ASSERT_EQUAL_STRING("0123456789abcdef0123", version.git_hash.c_str());
    TEST_ASSERT_EQUAL_STRING("", board.model.complaints.c_str());
    TEST_ASSERT_TRUE(
        std::equal(firmware.begin(), firmware.end(), board.model.flash.bytes.begin()));
}

static void test_a_box_that_is_not_there_cannot_be_asked(void)
{
    HidBoxes boxes;
    TEST_ASSERT_EQUAL(0, boxes.list().size());
    try {
        boxes.enter_bootloader(SERIAL);
        TEST_FAIL();
    } catch (const FlashError &error) {
        TEST_ASSERT_TRUE(error.fault() == Fault::no_device);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_running_box_becomes_the_same_box_with_new_firmware);
    RUN_TEST(test_a_box_that_is_not_there_cannot_be_asked);
    return UNITY_END();
}
