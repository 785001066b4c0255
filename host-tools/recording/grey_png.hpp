/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Grey pictures as PNG files, faster than a general encoder: one fixed filter, and no search. */
#ifndef OPMS_RECORDING_GREY_PNG_HPP
#define OPMS_RECORDING_GREY_PNG_HPP

#include <cstdint>
#include <vector>

namespace opms_host {

/** A picture without gaps between its rows; 16 bit in the machine's byte order. */
struct GreyPicture {
    std::int32_t width_px = 0, height_px = 0;
    bool is_16_bit = false;
    const std::uint8_t *pixels = nullptr;
};

enum class PngEffort {
    pack, /**< to about half of the size */
    none  /**< as large as it is, at a tenth of the time */
};

/** @return The file; empty where there is no memory for it. */
std::vector<std::uint8_t> grey_png(const GreyPicture &picture, PngEffort effort);

}  // namespace opms_host
#endif
