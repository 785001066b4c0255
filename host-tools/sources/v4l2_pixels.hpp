/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The grey of V4L2's pixel formats. */
#ifndef OPMS_SOURCES_V4L2_PIXELS_HPP
#define OPMS_SOURCES_V4L2_PIXELS_HPP

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include <opms/types.h>

namespace opms_host {

/** A format that can be used. */
struct V4l2Pixels {
    std::uint32_t fourcc;
    opms_pixel_format_t grey;
    std::uint16_t white_level;    /**< as opms_image_t's */
    std::uint32_t bytes_a_pixel;  /**< of the rows with the grey in them */
    bool interleaved;             /**< every second byte is colour: the grey must be copied out */
};

/** By preference: pure grey first, then what has it in a plane of its own. */
extern const V4l2Pixels V4L2_PIXELS[];
extern const std::size_t V4L2_PIXELS_COUNT;

const V4l2Pixels *v4l2_pixels_of(std::uint32_t fourcc);
/** "GREY", "Y10 ", ... */
std::string fourcc_text(std::uint32_t fourcc);

/** Grey of an interleaved picture. @return Its own memory, rows of @p width_px bytes. */
std::shared_ptr<const void> v4l2_copy_grey(const void *pixels, std::int32_t width_px,
                                           std::int32_t height_px, std::ptrdiff_t stride_bytes);

}  // namespace opms_host
#endif
