/* SPDX-License-Identifier: Apache-2.0 */
/* Which box is flashed, what is refused before anything is erased, and what people are told. */
#include <algorithm>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <unity.h>

#include "firmware_bytes.hpp"
#include "flash_session.hpp"

using namespace opms::flash;

void setUp(void)
{
}

void tearDown(void)
{
}

/** A desk with boards on it. Time passes only by the session's sleeping. */
struct Desk {
    std::vector<std::string> boxes;
    std::vector<Place> bootloaders;
    Place enters_as{1, 9, "1.2"};        /**< where an entering box comes up */
    std::string returns_as = "00000000000000AA";
    int enter_ms = 300, return_ms = 700; /**< how long that takes; -1: for ever */
    std::function<void()> on_write = [] {};
    Fault reboot_fault = Fault::no_device; /**< no_device: none */
    int open_refusals = 0, version_refusals = 0; /**< times that there is no permission yet */

    int now_ms = 0, due_ms = -1;
    std::function<void()> due;
    std::vector<std::string> log;
    Bytes memory = Bytes(256 * 1024, 0xFF);

    void later(int after_ms, std::function<void()> what)
    {
        due_ms = after_ms < 0 ? -1 : now_ms + after_ms;
        due = std::move(what);
    }

    void sleep(int ms)
    {
        now_ms += ms;
        if (due_ms >= 0 && now_ms >= due_ms) {
            due_ms = -1;
            due();
        }
    }
};

class DeskBootloader : public Bootloader {
public:
    DeskBootloader(Desk &desk, Place place) : desk_(desk), place_(std::move(place)) {}

    void erase(std::uint32_t address, std::uint32_t size) override
    {
        std::fill_n(desk_.memory.begin() + (address - TEST_FLASH), size, 0xFF);
    }

    void write(std::uint32_t address, const std::uint8_t *bytes, std::uint32_t size) override
    {
        desk_.on_write();
        std::copy_n(bytes, size, desk_.memory.begin() + (address - TEST_FLASH));
    }

    void read(std::uint32_t address, std::uint8_t *bytes, std::uint32_t size) override
    {
        std::copy_n(desk_.memory.begin() + (address - TEST_FLASH), size, bytes);
    }

    void reboot() override
    {
        desk_.log.push_back("reboot " + place_.port);
        auto &all = desk_.bootloaders;
        all.erase(std::remove(all.begin(), all.end(), place_), all.end());
        Desk &desk = desk_; /* outlives this handle */
        desk.later(desk.return_ms, [&desk] { desk.boxes.push_back(desk.returns_as); });
        if (desk_.reboot_fault != Fault::no_device) {
            throw FlashError(desk_.reboot_fault, "reboot");
        }
    }

private:
    Desk &desk_;
    Place place_;
};

class DeskBootloaders : public Bootloaders {
public:
    explicit DeskBootloaders(Desk &desk) : desk_(desk) {}
    std::vector<Place> list() override { return desk_.bootloaders; }
    std::unique_ptr<Bootloader> open(const Place &place) override
    {
        if (desk_.open_refusals > 0) {
            --desk_.open_refusals;
            throw FlashError(Fault::permission, "not yet");
        }
        desk_.log.push_back("open " + place.port);
        return std::make_unique<DeskBootloader>(desk_, place);
    }

private:
    Desk &desk_;
};

class DeskBoxes : public Boxes {
public:
    explicit DeskBoxes(Desk &desk) : desk_(desk) {}
    std::vector<std::string> list() override { return desk_.boxes; }
    void enter_bootloader(const std::string &id) override
    {
        desk_.log.push_back("enter " + id);
        auto &all = desk_.boxes;
        all.erase(std::remove(all.begin(), all.end(), id), all.end());
        desk_.later(desk_.enter_ms, [this] { desk_.bootloaders.push_back(desk_.enters_as); });
    }
    BoxVersion version(const std::string &id) override
    {
        if (desk_.version_refusals > 0) {
            --desk_.version_refusals;
            throw FlashError(Fault::no_device, "not yet");
        }
        return {id, "1.2.3", "abc"};
    }

private:
    Desk &desk_;
};

static const Bytes firmware = make_firmware(2 * 4096, 4);

static BoxVersion flash_on(Desk &desk, const SessionOptions &options = {})
{
    const Bytes file = make_uf2(firmware);
    DeskBootloaders bootloaders(desk);
    DeskBoxes boxes(desk);
    const SessionHooks hooks = {[](const std::string &) {}, [](std::size_t, std::size_t) {},
                                [&desk](int ms) { desk.sleep(ms); }};
    return flash_session(uf2_parse(file.data(), file.size()), options, bootloaders, boxes, hooks);
}

static std::string fails(Desk &desk, Fault fault, const SessionOptions &options = {})
{
    try {
        flash_on(desk, options);
    } catch (const FlashError &error) {
        TEST_ASSERT_EQUAL_INT(static_cast<int>(fault), static_cast<int>(error.fault()));
        return error.what();
    }
    TEST_FAIL_MESSAGE("it went through");
    return "";
}

static void assert_says(const std::string &text, const char *word)
{
    TEST_ASSERT_MESSAGE(text.find(word) != std::string::npos, text.c_str());
}

static void assert_log(const Desk &desk, const std::vector<std::string> &wanted)
{
    TEST_ASSERT_EQUAL(wanted.size(), desk.log.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        TEST_ASSERT_EQUAL_STRING(wanted[i].c_str(), desk.log[i].c_str());
    }
}

static void assert_written(const Desk &desk)
{
    TEST_ASSERT_TRUE(std::equal(firmware.begin(), firmware.end(), desk.memory.begin()));
}

static void test_the_only_box_is_flashed_and_tells_its_new_version(void)
{
    Desk desk;
    desk.boxes = {"00000000000000AA"};

    const BoxVersion version = flash_on(desk);

    TEST_ASSERT_EQUAL_STRING("00000000000000AA", version.unique_id.c_str());
    TEST_ASSERT_EQUAL_STRING("1.2.3", version.firmware.c_str());
    assert_log(desk, {"enter 00000000000000AA", "open 1.2", "reboot 1.2"});
    assert_written(desk);
}

static void test_the_only_bootloader_is_flashed(void)
{
    Desk desk;
    desk.bootloaders = {{1, 4, "3"}};
    flash_on(desk);
    assert_log(desk, {"open 3", "reboot 3"});
    assert_written(desk);
}

static void test_the_box_that_was_named_is_flashed_among_others(void)
{
    Desk desk;
    desk.boxes = {"00000000000000AB", "00000000000000AA", "00000000000000AC"};
    desk.bootloaders = {{1, 4, "3"}};
    SessionOptions options;
    options.box_id = "00000000000000aa"; /* whatever the case */

    const BoxVersion version = flash_on(desk, options);

    TEST_ASSERT_EQUAL_STRING("00000000000000AA", version.unique_id.c_str());
    assert_log(desk, {"enter 00000000000000AA", "open 1.2", "reboot 1.2"});
}

static void test_running_boxes_are_left_alone_when_told_so(void)
{
    Desk desk;
    desk.boxes = {"00000000000000AB"};
    desk.bootloaders = {{1, 4, "3"}};
    SessionOptions options;
    options.may_enter = false;

    const BoxVersion version = flash_on(desk, options);

    TEST_ASSERT_EQUAL_STRING("00000000000000AA", version.unique_id.c_str());
    assert_log(desk, {"open 3", "reboot 3"});
}

static void test_several_are_refused_and_listed(void)
{
    Desk desk;
    desk.boxes = {"00000000000000AA"};
    desk.bootloaders = {{1, 4, "3"}};
    const std::string text = fails(desk, Fault::several);
    assert_says(text, "box hid:00000000000000AA");
    assert_says(text, "bootloader on bus 1, port 3");
    assert_says(text, "--box hid:ID");
    assert_log(desk, {});
}

static void test_two_bootloaders_are_refused_and_listed(void)
{
    Desk desk;
    desk.bootloaders = {{1, 4, "3"}, {2, 5, "1.1"}};
    SessionOptions options;
    options.may_enter = false;
    const std::string text = fails(desk, Fault::several, options);
    assert_says(text, "unplug all but one");
    assert_says(text, "bootloader on bus 2, port 1.1");
    assert_log(desk, {});
}

static void test_nothing_to_flash_is_said_with_a_remedy(void)
{
    Desk desk;
    assert_says(fails(desk, Fault::no_device), "BOOTSEL");
    SessionOptions options;
    options.box_id = "00000000000000AA";
    assert_says(fails(desk, Fault::no_device, options), "What is there: nothing");
    desk.boxes = {"00000000000000AB"};
    assert_says(fails(desk, Fault::no_device, options), "box hid:00000000000000AB");
}

static void test_a_box_that_does_not_come_up_as_a_bootloader_is_reported(void)
{
    Desk desk;
    desk.boxes = {"00000000000000AA"};
    desk.enter_ms = -1;
    assert_says(fails(desk, Fault::gone), "BOOTSEL");
    TEST_ASSERT_INT_WITHIN(SESSION_POLL_MS, SESSION_ENTER_MS, desk.now_ms);
}

static void test_an_unplug_half_way_says_that_the_same_command_helps(void)
{
    Desk desk;
    desk.bootloaders = {{1, 4, "3"}};
    int writes = 0;
    desk.on_write = [&] {
        if (++writes == 2) {
            throw FlashError(Fault::gone, "WRITE at 0x10001000: No such device");
        }
    };
    const std::string text = fails(desk, Fault::gone);
    assert_says(text, "No such device");
    assert_says(text, "still comes up as a bootloader");
    assert_says(text, "RPI-RP2");
    assert_says(text, "run the same command again");

    desk.on_write = [] {};
    flash_on(desk);
    assert_written(desk);
}

static void test_other_faults_while_writing_are_passed_on(void)
{
    Desk desk;
    desk.bootloaders = {{1, 4, "3"}};
    desk.on_write = [] { throw FlashError(Fault::refused, "bad address"); };
    TEST_ASSERT_EQUAL_STRING("bad address", fails(desk, Fault::refused).c_str());
}

static void test_a_bootloader_that_is_gone_at_its_reboot_has_obeyed(void)
{
    Desk desk;
    desk.bootloaders = {{1, 4, "3"}};
    desk.reboot_fault = Fault::gone;
    TEST_ASSERT_EQUAL_STRING("1.2.3", flash_on(desk).firmware.c_str());
    desk = Desk();
    desk.bootloaders = {{1, 4, "3"}};
    desk.reboot_fault = Fault::refused;
    fails(desk, Fault::refused);
}

static void test_a_box_that_does_not_come_back_is_reported(void)
{
    Desk desk;
    desk.bootloaders = {{1, 4, "3"}};
    desk.boxes = {"00000000000000AB"}; /* another one, there before */
    desk.return_ms = -1;
    SessionOptions options;
    options.may_enter = false;
    assert_says(fails(desk, Fault::no_return, options), "written and verified");
    assert_written(desk);
}

static void test_permissions_that_come_a_little_late_are_waited_for(void)
{
    Desk desk;
    desk.boxes = {"00000000000000AA"};
    desk.open_refusals = 5;
    desk.version_refusals = 5;
    TEST_ASSERT_EQUAL_STRING("1.2.3", flash_on(desk).firmware.c_str());
}

static void test_permissions_that_never_come_end_the_session(void)
{
    Desk desk;
    desk.boxes = {"00000000000000AA"};
    desk.open_refusals = 1000;
    TEST_ASSERT_EQUAL_STRING("not yet", fails(desk, Fault::permission).c_str());
    desk = Desk();
    desk.bootloaders = {{1, 4, "3"}}; /* was there before: no reason to wait */
    desk.open_refusals = 1000;
    fails(desk, Fault::permission);
    TEST_ASSERT_EQUAL(0, desk.now_ms);
    desk = Desk();
    desk.bootloaders = {{1, 4, "3"}};
    desk.version_refusals = 1000;
    assert_says(fails(desk, Fault::no_return), "written and verified");
}

static void test_without_sight_of_boxes_none_is_waited_for(void)
{
    Desk desk;
    desk.bootloaders = {{1, 4, "3"}};
    desk.return_ms = -1;
    SessionOptions options;
    options.sees_boxes = false;
    TEST_ASSERT_EQUAL_STRING("", flash_on(desk, options).unique_id.c_str());
    TEST_ASSERT_EQUAL(0, desk.now_ms);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_only_box_is_flashed_and_tells_its_new_version);
    RUN_TEST(test_the_only_bootloader_is_flashed);
    RUN_TEST(test_the_box_that_was_named_is_flashed_among_others);
    RUN_TEST(test_running_boxes_are_left_alone_when_told_so);
    RUN_TEST(test_several_are_refused_and_listed);
    RUN_TEST(test_two_bootloaders_are_refused_and_listed);
    RUN_TEST(test_nothing_to_flash_is_said_with_a_remedy);
    RUN_TEST(test_a_box_that_does_not_come_up_as_a_bootloader_is_reported);
    RUN_TEST(test_an_unplug_half_way_says_that_the_same_command_helps);
    RUN_TEST(test_other_faults_while_writing_are_passed_on);
    RUN_TEST(test_a_bootloader_that_is_gone_at_its_reboot_has_obeyed);
    RUN_TEST(test_a_box_that_does_not_come_back_is_reported);
    RUN_TEST(test_permissions_that_come_a_little_late_are_waited_for);
    RUN_TEST(test_permissions_that_never_come_end_the_session);
    RUN_TEST(test_without_sight_of_boxes_none_is_waited_for);
    return UNITY_END();
}
