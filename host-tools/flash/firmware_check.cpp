/* SPDX-License-Identifier: Apache-2.0 */
#include "firmware_check.hpp"

#include <algorithm>

#include <opms/wire.h>

#include "little_endian.hpp"

namespace opms::flash {

namespace {

constexpr std::uint32_t VECTORS_OFFSET = 256; /**< the second stage goes there */
constexpr std::uint32_t RAM_START = 0x20000000, RAM_END = 0x20042000;

bool covers(const Image &image, std::uint32_t address)
{
    return std::any_of(image.sectors.begin(), image.sectors.end(), [address](const Sector &s) {
        return address >= s.address && address - s.address < SECTOR_BYTES;
    });
}

/** The second stage is what the boot ROM looks at; without it the box would stay a bootloader. */
void check_second_stage(const Sector &first)
{
    const std::uint8_t *const bytes = first.bytes.data();
    if (boot_crc32(bytes, BOOT_STAGE_BYTES) != u32_at(bytes + BOOT_STAGE_BYTES)) {
        throw FileError("the checksum of its boot stage is wrong: the RP2040 would not start it");
    }
}

void check_vectors(const Image &image)
{
    const std::uint8_t *const vectors = image.sectors.front().bytes.data() + VECTORS_OFFSET;
    const std::uint32_t stack = u32_at(vectors), reset = u32_at(vectors + 4);
    if (stack <= RAM_START || stack > RAM_END || stack % 4 != 0) {
        throw FileError("its stack is not in the RP2040's RAM: this is no program for it");
    }
    if (reset % 2 != 1 || !covers(image, reset - 1)) {
        throw FileError("its first instruction is not in the file: this is no program");
    }
}

/** The beginning of the box's HID report descriptor: usage page and usage, as HID codes them. */
bool has_box_descriptor(const Image &image)
{
    const std::array<std::uint8_t, 5> wanted = {
        0x06, OPMS_USB_USAGE_PAGE & 0xFF, OPMS_USB_USAGE_PAGE >> 8, 0x09, OPMS_USB_USAGE};
    std::vector<std::uint8_t> bytes;
    for (const Sector &sector : image.sectors) {
        bytes.insert(bytes.end(), sector.bytes.begin(), sector.bytes.end());
    }
    return std::search(bytes.begin(), bytes.end(), wanted.begin(), wanted.end()) != bytes.end();
}

}  // namespace

std::uint32_t boot_crc32(const std::uint8_t *bytes, std::size_t size)
{
    std::uint32_t crc = 0xFFFFFFFF;
    for (std::size_t i = 0; i < size; ++i) {
        crc ^= std::uint32_t{bytes[i]} << 24;
        for (int bit = 0; bit < 8; ++bit) {
            crc = crc << 1 ^ ((crc & 0x80000000) != 0 ? 0x04C11DB7U : 0U);
        }
    }
    return crc;
}

void firmware_check(const Image &image)
{
    if (image.sectors.empty() || image.sectors.front().address != FLASH_START) {
        throw FileError("nothing is for the beginning of the flash: the RP2040 would not start it");
    }
    check_second_stage(image.sectors.front());
    check_vectors(image);
    if (!has_box_descriptor(image)) {
        throw FileError("this is a program for the RP2040, but not the firmware of the trigger "
                        "box (it lacks the box's HID descriptor)");
    }
}

}  // namespace opms::flash
