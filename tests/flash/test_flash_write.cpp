/* SPDX-License-Identifier: Apache-2.0 */
/* The order of writing: at every power cut the box is what it was, a bootloader, or new. */
#include <algorithm>
#include <cstring>

#include <unity.h>

#include "firmware_bytes.hpp"
#include "flash_error.hpp"
#include "flash_write.hpp"
#include "nor_flash.hpp"

using namespace opms::flash;

static const Bytes old_firmware = make_firmware(6 * 4096, 2);
static const Bytes new_firmware = make_firmware(4 * 4096 + 256, 3);
constexpr std::size_t CHIP_BYTES = 64 * 1024;

void setUp(void)
{
}

void tearDown(void)
{
}

/** The chip behind a cable that is as long as its power. */
class ChipTarget : public FlashTarget {
public:
    explicit ChipTarget(NorFlash &chip) : chip_(chip) {}

    void erase(std::uint32_t address, std::uint32_t size) override
    {
        for (std::uint32_t i = 0; i < size; i += 4096) {
            require(chip_.erase_sector(address - TEST_FLASH + i));
        }
    }

    void write(std::uint32_t address, const std::uint8_t *bytes, std::uint32_t size) override
    {
        for (std::uint32_t i = 0; i < size; i += 256) {
            require(chip_.program_page(address - TEST_FLASH + i, bytes + i));
        }
    }

    void read(std::uint32_t address, std::uint8_t *bytes, std::uint32_t size) override
    {
        std::copy_n(chip_.bytes.begin() + (address - TEST_FLASH), size, bytes);
    }

private:
    static void require(bool powered)
    {
        if (!powered) {
            throw FlashError(Fault::gone, "unplugged");
        }
    }

    NorFlash &chip_;
};

static Image new_image(void)
{
    const Bytes file = make_uf2(new_firmware);
    return uf2_parse(file.data(), file.size());
}

static void put_old_firmware(NorFlash &chip)
{
    std::copy(old_firmware.begin(), old_firmware.end(), chip.bytes.begin());
}

static bool holds(const NorFlash &chip, const Bytes &firmware)
{
    return std::equal(firmware.begin(), firmware.end(), chip.bytes.begin());
}

/** @return Whether it went through to the end. */
static bool try_write(NorFlash &chip, const Image &image)
{
    ChipTarget target(chip);
    try {
        flash_write(target, image, [](std::size_t, std::size_t) {});
        return true;
    } catch (const FlashError &error) {
        TEST_ASSERT_TRUE(error.fault() == Fault::gone);
        return false;
    }
}

static void test_the_flash_holds_the_firmware_afterwards(void)
{
    NorFlash chip(CHIP_BYTES);
    put_old_firmware(chip);

    TEST_ASSERT_TRUE(try_write(chip, new_image()));

    TEST_ASSERT_TRUE(holds(chip, new_firmware));
    TEST_ASSERT_TRUE(rom_would_boot(chip.bytes));
}

static void test_sectors_that_the_file_does_not_touch_keep_their_bytes(void)
{
    /* The last sectors of the flash are where the box keeps its settings. */
    NorFlash chip(CHIP_BYTES);
    std::fill(chip.bytes.begin() + 5 * 4096, chip.bytes.end(), 0x3C);

    TEST_ASSERT_TRUE(try_write(chip, new_image()));

    TEST_ASSERT_EQUAL_HEX8(0xFF, chip.bytes[5 * 4096 - 1]);
    TEST_ASSERT_EQUAL(CHIP_BYTES - 5 * 4096,
                      std::count(chip.bytes.begin() + 5 * 4096, chip.bytes.end(), 0x3C));
}

static void test_a_power_cut_at_any_moment_leaves_no_half_firmware_to_boot(void)
{
    const Image image = new_image();
    NorFlash uncut(CHIP_BYTES);
    TEST_ASSERT_TRUE(try_write(uncut, image));
    int bootloaders = 0;
    for (long cut = 0; cut < uncut.operations; ++cut) {
        NorFlash chip(CHIP_BYTES);
        put_old_firmware(chip);
        chip.operations_left = cut;

        TEST_ASSERT_FALSE(try_write(chip, image));

        const bool boots = rom_would_boot(chip.bytes);
        bootloaders += !boots;
        TEST_ASSERT_TRUE(!boots || holds(chip, old_firmware) || holds(chip, new_firmware));
        chip.operations_left = -1;
        TEST_ASSERT_TRUE(try_write(chip, image));
        TEST_ASSERT_TRUE(holds(chip, new_firmware));
    }
    /* The proof that the cuts bite: nearly all of them leave a bootloader. */
    TEST_ASSERT_GREATER_OR_EQUAL(uncut.operations - 2, bootloaders);
}

static void test_a_worn_cell_is_found_and_the_box_stays_a_bootloader(void)
{
    /* In the first page, right after it, in the last page. */
    for (const std::uint32_t offset : {100U, 259U, 4U * 4096 + 255}) {
        NorFlash chip(CHIP_BYTES);
        put_old_firmware(chip);
        const auto mask = static_cast<std::uint8_t>(new_firmware[offset] & -new_firmware[offset]);
        TEST_ASSERT_NOT_EQUAL(0, mask);
        chip.stick(offset, mask);
        ChipTarget target(chip);
        try {
            flash_write(target, new_image(), [](std::size_t, std::size_t) {});
            TEST_FAIL_MESSAGE("not noticed");
        } catch (const FlashError &error) {
            TEST_ASSERT_TRUE(error.fault() == Fault::verify);
            char place[16];
            std::snprintf(place, sizeof place, "0x%08X", TEST_FLASH + offset);
            TEST_ASSERT_NOT_NULL(std::strstr(error.what(), place));
        }
        TEST_ASSERT_FALSE(rom_would_boot(chip.bytes));
    }
}

static void test_progress_rises_by_one_to_its_total(void)
{
    NorFlash chip(CHIP_BYTES);
    ChipTarget target(chip);
    std::size_t last = 0, end = 0;
    flash_write(target, new_image(), [&](std::size_t done, std::size_t total) {
        TEST_ASSERT_EQUAL(last + 1, done);
        last = done;
        end = total;
    });
    TEST_ASSERT_EQUAL(end, last);
    TEST_ASSERT_EQUAL(2 * 5 + 1, end);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_flash_holds_the_firmware_afterwards);
    RUN_TEST(test_sectors_that_the_file_does_not_touch_keep_their_bytes);
    RUN_TEST(test_a_power_cut_at_any_moment_leaves_no_half_firmware_to_boot);
    RUN_TEST(test_a_worn_cell_is_found_and_the_box_stays_a_bootloader);
    RUN_TEST(test_progress_rises_by_one_to_its_total);
    return UNITY_END();
}
