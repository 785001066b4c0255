/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Writes an image so that a box which loses power at any moment comes up either as it was, or as a
 * bootloader, or with the whole new firmware; never with a part of it. */
#ifndef OPMS_FLASH_FLASH_WRITE_HPP
#define OPMS_FLASH_FLASH_WRITE_HPP

#include <cstddef>
#include <cstdint>
#include <functional>

#include "uf2_file.hpp"

namespace opms::flash {

/** Flash memory behind some cable. Calls return when done and throw FlashError. */
class FlashTarget {
public:
    virtual ~FlashTarget() = default;
    virtual void erase(std::uint32_t address, std::uint32_t size) = 0;
    virtual void write(std::uint32_t address, const std::uint8_t *bytes, std::uint32_t size) = 0;
    virtual void read(std::uint32_t address, std::uint8_t *bytes, std::uint32_t size) = 0;
};

/** Told after each step; @p done of @p total are in units of roughly equal time. */
using Progress = std::function<void(std::size_t done, std::size_t total)>;

/** Erase, write and verify. The image begins with the flash's first sector (firmware_check()).
 *
 * The boot ROM starts what follows the second stage in the first page if that page's checksum is
 * right, else it becomes a bootloader. So the first sector is erased before all others, and its
 * first page is written after all else was read back and found right.
 * @throws FlashError, with Fault::verify where the flash did not keep what was written. */
void flash_write(FlashTarget &target, const Image &image, const Progress &progress);

}  // namespace opms::flash

#endif
