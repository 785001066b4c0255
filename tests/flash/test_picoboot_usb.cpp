/* SPDX-License-Identifier: Apache-2.0 */
/* libusb, unmodified, against a mocked Pico that waits as a bootloader. */
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>

#include <sys/prctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <unity.h>

#include "firmware_bytes.hpp"
#include "mock_usb.hpp"
#include "picoboot_usb.hpp"

using namespace opms::flash;

constexpr std::size_t FLASH_SIZE = 128 * 1024;

static UMockdevTestbed *testbed;
static const Bytes old_firmware = make_firmware(5 * 4096, 5);
static const Bytes firmware = make_firmware(3 * 4096 + 256, 6);

void setUp(void)
{
    testbed = umockdev_testbed_new();
}

void tearDown(void)
{
    g_object_unref(testbed);
}

/** Boxes as the model makes them: one runs after a reboot with a firmware that the ROM starts. */
class ModelBoxes : public Boxes {
public:
    explicit ModelBoxes(const PicobootModel &model) : model_(model) {}
    std::vector<std::string> list() override
    {
        const bool runs = model_.rebooting && rom_would_boot(model_.flash.bytes);
        return runs ? std::vector<std::string>{"E6614103E7000000"} : std::vector<std::string>{};
    }
    void enter_bootloader(const std::string &) override {}
    BoxVersion version(const std::string &id) override { return {id, "9.8.7", ""}; }

private:
    const PicobootModel &model_;
};

static BoxVersion flash_model(PicobootModel &model)
{
    const Bytes file = make_uf2(firmware);
    UsbBootloaders bootloaders;
    ModelBoxes boxes(model);
    const SessionHooks hooks = {[](const std::string &) {}, [](std::size_t, std::size_t) {},
                                [](int) {}};
    return flash_session(uf2_parse(file.data(), file.size()), {}, bootloaders, boxes, hooks);
}

static std::string fails(PicobootModel &model, Fault fault)
{
    try {
        flash_model(model);
    } catch (const FlashError &error) {
        if (error.fault() != fault) {
            TEST_FAIL_MESSAGE(error.what());
        }
        return error.what();
    }
    TEST_FAIL_MESSAGE("it went through");
    return "";
}

static void assert_says(const std::string &text, const char *word)
{
    TEST_ASSERT_MESSAGE(text.find(word) != std::string::npos, text.c_str());
}

static bool holds(const PicobootModel &model, const Bytes &bytes)
{
    return std::equal(bytes.begin(), bytes.end(), model.flash.bytes.begin());
}

static std::unique_ptr<PicobootModel> new_model(void)
{
    auto model = std::make_unique<PicobootModel>(FLASH_SIZE);
    std::copy(old_firmware.begin(), old_firmware.end(), model->flash.bytes.begin());
    return model;
}

static void test_a_bootloader_is_found_at_its_port(void)
{
    const auto model = new_model();
    UsbBootloaders bootloaders;
    TEST_ASSERT_EQUAL(0, bootloaders.list().size());
    MockUsb usb(testbed, *model, 3, 7);
    const std::vector<Place> places = bootloaders.list();
    TEST_ASSERT_EQUAL(1, places.size());
    TEST_ASSERT_EQUAL_STRING("bus 1, port 3", places[0].name().c_str());
    TEST_ASSERT_EQUAL(7, places[0].address);
    usb.unplug();
    TEST_ASSERT_EQUAL(0, bootloaders.list().size());
}

static void test_a_firmware_is_written_verified_and_started(void)
{
    const auto model = new_model();
    MockUsb usb(testbed, *model, 1, 2);

    const BoxVersion version = flash_model(*model);

    TEST_ASSERT_EQUAL_STRING("", model->complaints.c_str());
    TEST_ASSERT_EQUAL_STRING("9.8.7", version.firmware.c_str());
    TEST_ASSERT_TRUE(holds(*model, firmware));
    TEST_ASSERT_TRUE(model->rebooting);
    /* Untouched: the old firmware's last sector. */
    TEST_ASSERT_TRUE(std::equal(old_firmware.begin() + 4 * 4096, old_firmware.end(),
                                model->flash.bytes.begin() + 4 * 4096));
}

static void test_a_worn_flash_is_found_by_reading_back(void)
{
    const auto model = new_model();
    MockUsb usb(testbed, *model, 1, 2);
    model->flash.stick(4096 + 77, 0xFF);
    assert_says(fails(*model, Fault::verify), "0x1000104D");
    TEST_ASSERT_FALSE(rom_would_boot(model->flash.bytes));
    TEST_ASSERT_FALSE(model->rebooting);
}

static void test_a_stall_is_explained_and_the_next_run_succeeds(void)
{
    const auto model = new_model();
    MockUsb usb(testbed, *model, 1, 2);
    model->fail_command = 0x05;
    model->fail_code = 6;
    assert_says(fails(*model, Fault::refused), "refused WRITE at 0x10000100: interleaved write");

    model->fail_command = -1;
    flash_model(*model);
    TEST_ASSERT_TRUE(holds(*model, firmware));
}

static void test_each_command_that_is_refused_is_named(void)
{
    const struct {
        int command;
        const char *name;
    } cases[] = {{0x01, "EXCLUSIVE_ACCESS"},
                 {0x06, "EXIT_XIP"},
                 {0x03, "FLASH_ERASE at 0x10000000"},
                 {0x84, "READ at 0x10000100"},
                 {0x02, "REBOOT"}};
    for (const auto &c : cases) {
        const auto model = new_model();
        MockUsb usb(testbed, *model, 1, 2);
        model->fail_command = c.command;
        model->fail_code = 8;
        const std::string text = fails(*model, Fault::refused);
        assert_says(text, (std::string("refused ") + c.name + ": unknown error").c_str());
    }
}

static void test_an_unplug_half_way_is_told_and_the_second_run_recovers(void)
{
    const auto model = new_model();
    auto usb = std::make_unique<MockUsb>(testbed, *model, 1, 2);
    usb->transfers_left = 20;
    const std::string text = fails(*model, Fault::gone);
    assert_says(text, "still comes up as a bootloader");
    assert_says(text, "run the same command again");
    usb.reset();
    TEST_ASSERT_FALSE(rom_would_boot(model->flash.bytes));

    /* Plugged in again, it has another device number. */
    usb = std::make_unique<MockUsb>(testbed, *model, 1, 3);
    flash_model(*model);
    TEST_ASSERT_TRUE(holds(*model, firmware));
    TEST_ASSERT_EQUAL_STRING("", model->complaints.c_str());
}

static void test_a_power_cut_within_a_page_is_told_and_the_second_run_recovers(void)
{
    for (const long cut : {0L, 1L, 7L, 40L, 56L}) {
        const auto model = new_model();
        auto usb = std::make_unique<MockUsb>(testbed, *model, 1, 2);
        model->flash.operations_left = cut;
        fails(*model, Fault::gone);
        usb.reset();
        TEST_ASSERT_TRUE(!rom_would_boot(model->flash.bytes) || holds(*model, old_firmware));

        /* What is in RAM is gone with the power, the flash is not. */
        PicobootModel again(FLASH_SIZE);
        again.flash.bytes = model->flash.bytes;
        MockUsb replugged(testbed, again, 1, 3);
        flash_model(again);
        TEST_ASSERT_TRUE(holds(again, firmware));
    }
}

static void test_what_a_dead_run_has_left_is_reset(void)
{
    const auto model = new_model();
    MockUsb usb(testbed, *model, 1, 2);
    Bytes half(32);
    set_u32(half, 0, 0x431FD10B);
    half[8] = 0x06; /* whose end nobody has fetched */
    TEST_ASSERT_EQUAL(32, model->bulk_out(half));
    flash_model(*model);
    TEST_ASSERT_TRUE(holds(*model, firmware));
    TEST_ASSERT_EQUAL_STRING("", model->complaints.c_str());
}

static void test_two_bootloaders_are_refused_and_untouched(void)
{
    const auto model = new_model(), other = new_model();
    MockUsb usb(testbed, *model, 1, 2), other_usb(testbed, *other, 2, 3);
    const std::string text = fails(*model, Fault::several);
    assert_says(text, "bus 1, port 1");
    assert_says(text, "bus 1, port 2");
    TEST_ASSERT_TRUE(holds(*model, old_firmware) && holds(*other, old_firmware));
    TEST_ASSERT_EQUAL(0, model->commands + other->commands);
}

static void test_an_interface_that_is_in_use_is_refused(void)
{
    const auto model = new_model();
    MockUsb usb(testbed, *model, 1, 2);
    usb.busy = true;
    assert_says(fails(*model, Fault::permission), "Another program uses it");
    TEST_ASSERT_TRUE(holds(*model, old_firmware));
}

/** Everybody may use the folders of the testbed and its sockets, but not the node. */
static void close_node(const std::string &node)
{
    gchar *const root = umockdev_testbed_get_root_dir(testbed);
    const std::string top = root;
    g_free(root);
    chmod(top.c_str(), 0777);
    for (const auto &entry : std::filesystem::recursive_directory_iterator(top)) {
        if ((entry.is_directory() || entry.is_socket()) && !entry.is_symlink()) {
            chmod(entry.path().c_str(), 0777);
        }
    }
    chmod((top + node).c_str(), 0);
}

/** While it lives, this process is not root. */
class Nobody {
public:
    Nobody() : root_(geteuid() == 0), done_(!root_ || seteuid(65534) == 0) {}
    ~Nobody()
    {
        if (root_ && seteuid(0) != 0) {
            std::abort();
        }
        prctl(PR_SET_DUMPABLE, 1UL, 0UL, 0UL, 0UL); /* the leak check looks into the process */
    }
    Nobody(const Nobody &) = delete;
    Nobody &operator=(const Nobody &) = delete;
    bool done() const { return done_; }

private:
    bool root_, done_;
};

static std::string open_as_nobody(void)
{
    const Nobody nobody;
    if (!nobody.done()) {
        return "cannot become another user here";
    }
    try {
        UsbBootloaders().open({1, 2, "1"});
    } catch (const FlashError &error) {
        return (error.fault() == Fault::permission ? "" : "another fault: ") +
               std::string(error.what());
    }
    return "opened";
}

static void test_a_missing_permission_names_the_udev_rule(void)
{
    const auto model = new_model();
    MockUsb usb(testbed, *model, 1, 2);
    close_node(usb.node());
    const std::string text = open_as_nobody();
    TEST_ASSERT_EQUAL_STRING_LEN("opening the bootloader", text.c_str(), 22);
    assert_says(text, "70-opms-box.rules");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_bootloader_is_found_at_its_port);
    RUN_TEST(test_a_firmware_is_written_verified_and_started);
    RUN_TEST(test_a_worn_flash_is_found_by_reading_back);
    RUN_TEST(test_a_stall_is_explained_and_the_next_run_succeeds);
    RUN_TEST(test_each_command_that_is_refused_is_named);
    RUN_TEST(test_an_unplug_half_way_is_told_and_the_second_run_recovers);
    RUN_TEST(test_a_power_cut_within_a_page_is_told_and_the_second_run_recovers);
    RUN_TEST(test_what_a_dead_run_has_left_is_reset);
    RUN_TEST(test_two_bootloaders_are_refused_and_untouched);
    RUN_TEST(test_an_interface_that_is_in_use_is_refused);
    RUN_TEST(test_a_missing_permission_names_the_udev_rule);
    return UNITY_END();
}
