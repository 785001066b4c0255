/* SPDX-License-Identifier: Apache-2.0 */
/* UF2 files: what is taken, and what is refused with which words. */
#include <algorithm>
#include <cstring>
#include <functional>
#include <string>

#include <unity.h>

#include "firmware_bytes.hpp"
#include "firmware_check.hpp"
#include "uf2_file.hpp"

using namespace opms::flash;

void setUp(void)
{
}

void tearDown(void)
{
}

static const Bytes firmware = make_firmware(3 * 4096 + 700, 1);

static std::string refusal(const Bytes &file)
{
    try {
        uf2_parse(file.data(), file.size());
    } catch (const FileError &error) {
        return error.what();
    }
    return "taken";
}

static void assert_refused(const Bytes &file, const char *word)
{
    const std::string text = refusal(file);
    TEST_ASSERT_MESSAGE(text.find(word) != std::string::npos, (text + " | " + word).c_str());
}

/** The good file with block @p block changed. */
static Bytes changed(std::size_t block, std::size_t at, std::uint32_t value)
{
    Bytes file = make_uf2(firmware);
    set_u32(file, block * 512 + at, value);
    return file;
}

static void swap_blocks(Bytes &file, std::size_t a, std::size_t b)
{
    std::swap_ranges(file.begin() + static_cast<std::ptrdiff_t>(a * 512),
                     file.begin() + static_cast<std::ptrdiff_t>(a * 512 + 512),
                     file.begin() + static_cast<std::ptrdiff_t>(b * 512));
}

static void assert_image_is_firmware(const Image &image)
{
    TEST_ASSERT_EQUAL(4, image.sectors.size());
    TEST_ASSERT_EQUAL(51 * 256, image.payload_bytes);
    for (std::size_t i = 0; i < 51 * 256; ++i) {
        const Sector &sector = image.sectors[i / 4096];
        TEST_ASSERT_EQUAL_HEX32(TEST_FLASH + i / 4096 * 4096, sector.address);
        TEST_ASSERT_EQUAL_HEX8(i < firmware.size() ? firmware[i] : 0, sector.bytes[i % 4096]);
    }
}

static void test_every_byte_of_a_firmware_lands_at_its_address(void)
{
    const Bytes file = make_uf2(firmware);
    const Image image = uf2_parse(file.data(), file.size());
    assert_image_is_firmware(image);
}

static void test_what_the_file_leaves_open_stays_erased(void)
{
    const Bytes file = make_uf2(firmware);
    const Image image = uf2_parse(file.data(), file.size());
    for (std::size_t i = 3 * 256; i < 4096; ++i) {
        TEST_ASSERT_EQUAL_HEX8(0xFF, image.sectors[3].bytes[i]);
    }
}

static void test_blocks_may_come_in_any_order(void)
{
    Bytes file = make_uf2(firmware);
    swap_blocks(file, 0, 50);
    swap_blocks(file, 7, 31);
    assert_image_is_firmware(uf2_parse(file.data(), file.size()));
}

static void test_sectors_between_two_parts_are_left_alone(void)
{
    const Bytes page(256, 0x5A);
    Bytes file = make_block(TEST_FLASH, page, 0, 2);
    const Bytes far = make_block(TEST_FLASH + 0x1FFF00, page, 1, 2);
    file.insert(file.end(), far.begin(), far.end());

    const Image image = uf2_parse(file.data(), file.size());

    TEST_ASSERT_EQUAL(2, image.sectors.size());
    TEST_ASSERT_EQUAL_HEX32(TEST_FLASH + 0x1FF000, image.sectors[1].address);
    TEST_ASSERT_EQUAL_HEX8(0x5A, image.sectors[1].bytes[4095]);
    TEST_ASSERT_EQUAL_HEX8(0xFF, image.sectors[1].bytes[4095 - 256]);
}

static void test_a_block_that_is_not_for_the_flash_is_counted_and_skipped(void)
{
    const Bytes file = changed(50, 8, 0x2001);
    const Image image = uf2_parse(file.data(), file.size());
    TEST_ASSERT_EQUAL(50 * 256, image.payload_bytes);
}

static void test_other_files_are_told_from_uf2(void)
{
    assert_refused({}, "is empty");
    assert_refused({0x7F, 'E', 'L', 'F'}, "no UF2 file");
    assert_refused(Bytes(512, 0), "no UF2 file");
    assert_refused(changed(0, 4, 0), "no UF2 file");
}

static void test_damaged_blocks_are_refused(void)
{
    assert_refused(changed(3, 0, 0), "block 4 has wrong magic");
    assert_refused(changed(3, 4, 0), "block 4 has wrong magic");
    assert_refused(changed(3, 508, 0), "block 4 has wrong magic");
}

static void test_a_file_that_was_cut_short_is_refused(void)
{
    Bytes file = make_uf2(firmware);
    file.resize(file.size() - 100);
    assert_refused(file, "ends within a block");
    file.resize(20 * 512);
    assert_refused(file, "has 20 of 51 blocks");
}

static void test_two_files_in_one_are_refused(void)
{
    Bytes file = make_uf2(firmware);
    const Bytes again = file;
    file.insert(file.end(), again.begin(), again.end());
    assert_refused(file, "has 102 blocks and says 51");
}

static void test_a_file_for_another_microcontroller_is_refused(void)
{
    assert_refused(changed(0, 28, 0xE48BFF59), "family 0xE48BFF59"); /* RP2350 */
    assert_refused(changed(5, 28, 0xADA52840), "block 6 is for another");
    assert_refused(changed(0, 8, 0), "does not say for which");
    assert_refused(changed(0, 8, 0x3000), "a part of another file");
}

static void test_wrong_numbers_are_refused(void)
{
    assert_refused(changed(9, 20, 8), "number 8, which an earlier block has");
    assert_refused(changed(9, 20, 51), "numbered 51 of 51");
    assert_refused(changed(9, 20, 0xFFFFFFFF), "numbered 4294967295 of 51");
    assert_refused(changed(9, 24, 52), "52 blocks, the first one said 51");
    assert_refused(changed(0, 24, 0), "has 51 blocks and says 0");
    assert_refused(changed(0, 24, 0xFFFFFFFF), "has 51 of 4294967295");
}

static void test_wrong_places_are_refused(void)
{
    assert_refused(changed(2, 12, 0x10000280), "no multiple of 256");
    assert_refused(changed(2, 12, 0x10000300), "as an earlier block is");
    assert_refused(changed(2, 12, 0x10200000), "outside of the 2 MiB");
    assert_refused(changed(2, 12, 0x101FFF80), "outside of the 2 MiB");
    assert_refused(changed(2, 12, 0x0FFFFF00), "outside of the 2 MiB");
    assert_refused(changed(2, 12, 0xFFFFFF00), "outside of the 2 MiB");
    assert_refused(changed(2, 12, 0x20000000), "is for RAM");
    assert_refused(changed(2, 16, 476), "holds 476 bytes");
    assert_refused(changed(2, 16, 0), "holds 0 bytes");
}

static void test_the_last_page_of_the_flash_can_be_written(void)
{
    const Bytes file = changed(2, 12, 0x101FFF00);
    TEST_ASSERT_EQUAL_STRING("taken", refusal(file).c_str());
}

static void test_a_file_larger_than_the_flash_is_refused(void)
{
    assert_refused(make_uf2(Bytes(2 * 1024 * 1024 + 1)), "too large");
    TEST_ASSERT_EQUAL_STRING("taken", refusal(make_uf2(Bytes(2 * 1024 * 1024))).c_str());
}

static void test_files_on_disk_are_named_in_errors(void)
{
    write_file("test_uf2_good.uf2", make_uf2(firmware));
    assert_image_is_firmware(uf2_read("test_uf2_good.uf2"));
    for (const char *name : {"test_uf2_missing.uf2", "."}) {
        try {
            uf2_read(name);
            TEST_FAIL_MESSAGE(name);
        } catch (const FileError &error) {
            TEST_ASSERT_EQUAL_STRING_LEN(name, error.what(), std::strlen(name));
            TEST_ASSERT_NOT_NULL(std::strstr(error.what(), "cannot be read"));
        }
    }
}

static std::string firmware_refusal(const std::function<void(Bytes &)> &change)
{
    Bytes bytes = firmware;
    change(bytes);
    const Bytes file = make_uf2(bytes);
    try {
        firmware_check(uf2_parse(file.data(), file.size()));
    } catch (const FileError &error) {
        return error.what();
    }
    return "taken";
}

static void test_the_checksum_is_the_one_of_the_datasheet(void)
{
    /* Its parameters are those of CRC-32/MPEG-2, whose check value is published. */
    const Bytes digits = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
    TEST_ASSERT_EQUAL_HEX32(0x0376E6E7, boot_crc32(digits.data(), digits.size()));
    TEST_ASSERT_EQUAL_HEX32(0x0376E6E7, long_division_crc(digits, digits.size()));
}

static void test_our_firmware_is_taken(void)
{
    TEST_ASSERT_EQUAL_STRING("taken", firmware_refusal([](Bytes &) {}).c_str());
}

static void assert_firmware_refused(const std::function<void(Bytes &)> &change, const char *word)
{
    const std::string text = firmware_refusal(change);
    TEST_ASSERT_MESSAGE(text.find(word) != std::string::npos, text.c_str());
}

static void test_a_program_that_would_not_start_is_refused(void)
{
    assert_firmware_refused([](Bytes &b) { b[17] ^= 1; }, "checksum");
    assert_firmware_refused([](Bytes &b) { b[253] ^= 0x80; }, "checksum");
    assert_firmware_refused([](Bytes &b) { set_u32(b, 256, 0x20042004); }, "stack");
    assert_firmware_refused([](Bytes &b) { set_u32(b, 256, 0x20000000); }, "stack");
    assert_firmware_refused([](Bytes &b) { set_u32(b, 260, 0x100001F6); }, "first instruction");
    assert_firmware_refused([](Bytes &b) { set_u32(b, 260, 0x10008001); }, "first instruction");
}

static void test_a_program_of_somebody_else_is_refused(void)
{
    assert_firmware_refused([](Bytes &b) { b[301] = 0; }, "not the firmware of the trigger box");
}

static void test_a_file_without_the_beginning_of_the_flash_is_refused(void)
{
    const Bytes block = make_block(TEST_FLASH + 4096, Bytes(256), 0, 1);
    try {
        firmware_check(uf2_parse(block.data(), block.size()));
        TEST_FAIL();
    } catch (const FileError &error) {
        TEST_ASSERT_NOT_NULL(std::strstr(error.what(), "beginning of the flash"));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_byte_of_a_firmware_lands_at_its_address);
    RUN_TEST(test_what_the_file_leaves_open_stays_erased);
    RUN_TEST(test_blocks_may_come_in_any_order);
    RUN_TEST(test_sectors_between_two_parts_are_left_alone);
    RUN_TEST(test_a_block_that_is_not_for_the_flash_is_counted_and_skipped);
    RUN_TEST(test_other_files_are_told_from_uf2);
    RUN_TEST(test_damaged_blocks_are_refused);
    RUN_TEST(test_a_file_that_was_cut_short_is_refused);
    RUN_TEST(test_two_files_in_one_are_refused);
    RUN_TEST(test_a_file_for_another_microcontroller_is_refused);
    RUN_TEST(test_wrong_numbers_are_refused);
    RUN_TEST(test_wrong_places_are_refused);
    RUN_TEST(test_the_last_page_of_the_flash_can_be_written);
    RUN_TEST(test_a_file_larger_than_the_flash_is_refused);
    RUN_TEST(test_files_on_disk_are_named_in_errors);
    RUN_TEST(test_the_checksum_is_the_one_of_the_datasheet);
    RUN_TEST(test_our_firmware_is_taken);
    RUN_TEST(test_a_program_that_would_not_start_is_refused);
    RUN_TEST(test_a_program_of_somebody_else_is_refused);
    RUN_TEST(test_a_file_without_the_beginning_of_the_flash_is_refused);
    return UNITY_END();
}
