/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A UF2 file for the RP2040: bytes -> flash sectors, or a text that says what is wrong.
 *
 * UF2 is Microsoft's format of 512-byte blocks, each with the address of its data
 * (https://github.com/microsoft/uf2). Read strictly: a file that has lost or repeats a block is
 * refused, because half of a firmware is worse than none. */
#ifndef OPMS_FLASH_UF2_FILE_HPP
#define OPMS_FLASH_UF2_FILE_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace opms::flash {

constexpr std::uint32_t FLASH_START = 0x10000000;
constexpr std::uint32_t FLASH_BYTES = 2 * 1024 * 1024; /**< of a Raspberry Pi Pico */
constexpr std::uint32_t SECTOR_BYTES = 4096;           /**< the least that can be erased */
constexpr std::uint32_t PAGE_BYTES = 256;              /**< the least that can be written */

/** Why a file was refused. */
class FileError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/** A sector as it must be afterwards; what the file leaves open is 0xFF, as erasing leaves it. */
struct Sector {
    std::uint32_t address;
    std::array<std::uint8_t, SECTOR_BYTES> bytes;
};

/** What to write: only the sectors that the file touches, by rising address. */
struct Image {
    std::vector<Sector> sectors;
    std::size_t payload_bytes = 0;
};

/** Read a UF2 file's bytes. @throws FileError */
Image uf2_parse(const std::uint8_t *bytes, std::size_t size);

/** Read a UF2 file. @throws FileError, its text beginning with the file's name. */
Image uf2_read(const std::string &path);

}  // namespace opms::flash

#endif
