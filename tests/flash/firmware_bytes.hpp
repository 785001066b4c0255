/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A firmware made up for tests, and UF2 files of it, written from the formats' definitions and not
 * with the code under test. */
#ifndef TESTS_FLASH_FIRMWARE_BYTES_HPP
#define TESTS_FLASH_FIRMWARE_BYTES_HPP

#include <cstdint>
#include <string>
#include <vector>

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t TEST_FLASH = 0x10000000;

void set_u32(Bytes &bytes, std::size_t at, std::uint32_t value);
std::uint32_t get_u32(const Bytes &bytes, std::size_t at);

/** The boot ROM's CRC, by polynomial division of the whole message as one long number. */
std::uint32_t long_division_crc(const Bytes &bytes, std::size_t size);

/** Does the boot ROM start what the flash holds? */
bool rom_would_boot(const Bytes &flash);

/** A bootable image of the trigger box with noise for code. */
Bytes make_firmware(std::size_t size, unsigned seed);

/** One block of a UF2 file for the RP2040. */
Bytes make_block(std::uint32_t address, const Bytes &page, std::uint32_t number,
                 std::uint32_t count);

/** A UF2 file of @p firmware from the beginning of the flash. */
Bytes make_uf2(const Bytes &firmware);

void write_file(const std::string &path, const Bytes &bytes);

#endif
