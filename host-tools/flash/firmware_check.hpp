/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Is an image the box's firmware? Asked before anything is erased. */
#ifndef OPMS_FLASH_FIRMWARE_CHECK_HPP
#define OPMS_FLASH_FIRMWARE_CHECK_HPP

#include "uf2_file.hpp"

namespace opms::flash {

/** Would the boot ROM start it (second stage with its checksum, vector table), and is it a trigger
 * box: does it hold the HID descriptor by which the host knows one?
 * @throws FileError that says what is missing. */
void firmware_check(const Image &image);

/** The boot ROM's CRC-32 of the second stage (RP2040 datasheet, "Flash Second Stage"): polynomial
 * 0x04C11DB7, start value 0xFFFFFFFF, not reflected, nothing added at the end. */
std::uint32_t boot_crc32(const std::uint8_t *bytes, std::size_t size);

constexpr std::size_t BOOT_STAGE_BYTES = 252; /**< of the second stage; its CRC follows */

}  // namespace opms::flash

#endif
