/* SPDX-License-Identifier: Apache-2.0 */
/* PICOBOOT's packets, byte by byte as the RP2040 datasheet lays them out. */
#include <algorithm>
#include <string>

#include <unity.h>

#include "firmware_bytes.hpp"
#include "picoboot_protocol.hpp"

using namespace opms::flash;

void setUp(void)
{
}

void tearDown(void)
{
}

static void assert_bytes(const Command &command, const Bytes &wanted)
{
    const auto bytes = command_bytes(command, 0x01020304);
    TEST_ASSERT_EQUAL(32, wanted.size());
    TEST_ASSERT_EQUAL_HEX8_ARRAY(wanted.data(), bytes.data(), 32);
}

static void test_each_command_has_the_bytes_of_the_datasheet(void)
{
    assert_bytes(command_exclusive_access(),
                 {0x0B, 0xD1, 0x1F, 0x43, 4, 3, 2, 1, 0x01, 1, 0, 0, 0, 0, 0, 0,
                  1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    assert_bytes(command_exit_xip(),
                 {0x0B, 0xD1, 0x1F, 0x43, 4, 3, 2, 1, 0x06, 0, 0, 0, 0, 0, 0, 0,
                  0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    assert_bytes(command_flash_erase(0x10002000, 0x1000),
                 {0x0B, 0xD1, 0x1F, 0x43, 4, 3, 2, 1, 0x03, 8, 0, 0, 0, 0, 0, 0,
                  0, 0x20, 0, 0x10, 0, 0x10, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    assert_bytes(command_write(0x10002100, 0x0F00),
                 {0x0B, 0xD1, 0x1F, 0x43, 4, 3, 2, 1, 0x05, 8, 0, 0, 0, 0x0F, 0, 0,
                  0, 0x21, 0, 0x10, 0, 0x0F, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    assert_bytes(command_read(0x10002100, 0x0F00),
                 {0x0B, 0xD1, 0x1F, 0x43, 4, 3, 2, 1, 0x84, 8, 0, 0, 0, 0x0F, 0, 0,
                  0, 0x21, 0, 0x10, 0, 0x0F, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    assert_bytes(command_reboot(500),
                 {0x0B, 0xD1, 0x1F, 0x43, 4, 3, 2, 1, 0x02, 12, 0, 0, 0, 0, 0, 0,
                  0, 0, 0, 0, 0, 0, 0, 0, 0xF4, 1, 0, 0, 0, 0, 0, 0});
}

static void test_only_a_read_brings_data_to_the_host(void)
{
    TEST_ASSERT_TRUE(command_read(0, 1).is_in());
    TEST_ASSERT_FALSE(command_write(0, 1).is_in());
    TEST_ASSERT_FALSE(command_flash_erase(0, 1).is_in());
}

static void test_a_status_is_read_at_its_offsets(void)
{
    const std::array<std::uint8_t, 16> bytes = {4, 3, 2, 1, 5, 0, 0, 0, 0x84, 1};
    const CommandStatus status = status_parse(bytes);
    TEST_ASSERT_EQUAL_HEX32(0x01020304, status.token);
    TEST_ASSERT_EQUAL(5, status.code);
    TEST_ASSERT_EQUAL_HEX8(0x84, status.command_id);
    TEST_ASSERT_TRUE(status.in_progress);
}

static void test_status_codes_have_names_for_people(void)
{
    TEST_ASSERT_EQUAL_STRING("no error", status_name(0).c_str());
    TEST_ASSERT_EQUAL_STRING("bad address", status_name(4).c_str());
    TEST_ASSERT_EQUAL_STRING("bad alignment", status_name(5).c_str());
    TEST_ASSERT_EQUAL_STRING("unknown error", status_name(8).c_str());
    TEST_ASSERT_EQUAL_STRING("status 9", status_name(9).c_str());
    TEST_ASSERT_EQUAL_STRING("status 4294967295", status_name(0xFFFFFFFF).c_str());
}

static void test_commands_have_names_for_people(void)
{
    TEST_ASSERT_EQUAL_STRING("WRITE at 0x10001000",
                             command_name(command_write(0x10001000, 256)).c_str());
    TEST_ASSERT_EQUAL_STRING("REBOOT", command_name(command_reboot(1)).c_str());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_each_command_has_the_bytes_of_the_datasheet);
    RUN_TEST(test_only_a_read_brings_data_to_the_host);
    RUN_TEST(test_a_status_is_read_at_its_offsets);
    RUN_TEST(test_status_codes_have_names_for_people);
    RUN_TEST(test_commands_have_names_for_people);
    return UNITY_END();
}
