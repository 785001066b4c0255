/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A NOR flash chip whose power can be cut within any operation. */
#ifndef TESTS_FLASH_NOR_FLASH_HPP
#define TESTS_FLASH_NOR_FLASH_HPP

#include <cstdint>
#include <random>

#include "firmware_bytes.hpp"

class NorFlash {
public:
    explicit NorFlash(std::size_t size) : bytes(size, 0xFF) {}

    /** All bits of a sector become 1. @return false when the power went away meanwhile. */
    bool erase_sector(std::uint32_t offset)
    {
        const bool cut = !spend();
        for (std::size_t i = offset; i < offset + 4096; ++i) {
            const auto noise = static_cast<std::uint8_t>(random_() >> 24);
            bytes.at(i) = static_cast<std::uint8_t>(cut ? bytes.at(i) | noise : 0xFF);
        }
        return !cut;
    }

    /** Bits of a page become 0, never 1. @return false when the power went away meanwhile. */
    bool program_page(std::uint32_t offset, const std::uint8_t *page)
    {
        const bool cut = !spend();
        const std::size_t size = cut ? random_() % 256 : 256;
        for (std::size_t i = 0; i < size; ++i) {
            bytes.at(offset + i) &= page[i];
        }
        apply_stuck();
        return !cut;
    }

    /** A cell that is 0 whatever is done. */
    void stick(std::uint32_t offset, std::uint8_t mask)
    {
        stuck_offset_ = offset;
        stuck_mask_ = mask;
    }

    Bytes bytes;
    long operations_left = -1; /**< then the power goes away; -1: never */
    long operations = 0;

private:
    bool spend()
    {
        ++operations;
        if (operations_left < 0) {
            return true;
        }
        return operations_left-- > 0;
    }

    void apply_stuck()
    {
        bytes.at(stuck_offset_) &= static_cast<std::uint8_t>(~stuck_mask_);
    }

    std::mt19937 random_{7};
    std::uint32_t stuck_offset_ = 0;
    std::uint8_t stuck_mask_ = 0;
};

#endif
