/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * 32-bit numbers as UF2, PICOBOOT and the RP2040 store them, on any host. */
#ifndef OPMS_FLASH_LITTLE_ENDIAN_HPP
#define OPMS_FLASH_LITTLE_ENDIAN_HPP

#include <cstdint>

namespace opms::flash {

inline std::uint32_t u32_at(const std::uint8_t *bytes)
{
    return bytes[0] | std::uint32_t{bytes[1]} << 8 | std::uint32_t{bytes[2]} << 16 |
           std::uint32_t{bytes[3]} << 24;
}

inline void put_u32(std::uint8_t *at, std::uint32_t value)
{
    for (int i = 0; i < 4; ++i) {
        at[i] = static_cast<std::uint8_t>(value >> 8 * i);
    }
}

}  // namespace opms::flash

#endif
