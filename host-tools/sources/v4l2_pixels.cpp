/* SPDX-License-Identifier: Apache-2.0 */
#include "v4l2_pixels.hpp"

#include <algorithm>
#include <vector>

#include <linux/videodev2.h>

namespace opms_host {

const V4l2Pixels V4L2_PIXELS[] = {
    {V4L2_PIX_FMT_GREY, OPMS_PIXEL_GREY8, 255, 1, false},
    {V4L2_PIX_FMT_Y16, OPMS_PIXEL_GREY16, 65535, 2, false},
    {V4L2_PIX_FMT_Y12, OPMS_PIXEL_GREY16, 4095, 2, false},
    {V4L2_PIX_FMT_Y10, OPMS_PIXEL_GREY16, 1023, 2, false},
    {V4L2_PIX_FMT_NV12, OPMS_PIXEL_GREY8, 255, 1, false},
    {V4L2_PIX_FMT_YUYV, OPMS_PIXEL_GREY8, 255, 2, true},
};
const std::size_t V4L2_PIXELS_COUNT = sizeof V4L2_PIXELS / sizeof *V4L2_PIXELS;

const V4l2Pixels *v4l2_pixels_of(std::uint32_t fourcc)
{
    const V4l2Pixels *const end = V4L2_PIXELS + V4L2_PIXELS_COUNT;
    const V4l2Pixels *const found = std::find_if(
        V4L2_PIXELS, end, [fourcc](const V4l2Pixels &pixels) { return pixels.fourcc == fourcc; });
    return found == end ? nullptr : found;
}

std::string fourcc_text(std::uint32_t fourcc)
{
    std::string text;
    for (int shift = 0; shift < 32; shift += 8) {
        const char c = static_cast<char>(fourcc >> shift & 0x7F);
        text += c >= ' ' ? c : '?';
    }
    return text;
}

std::shared_ptr<const void> v4l2_copy_grey(const void *pixels, std::int32_t width_px,
                                           std::int32_t height_px, std::ptrdiff_t stride_bytes)
{
    const auto width = static_cast<std::size_t>(width_px);
    auto grey = std::make_shared<std::vector<std::uint8_t>>(
        width * static_cast<std::size_t>(height_px));
    const std::uint8_t *row = static_cast<const std::uint8_t *>(pixels);
    std::uint8_t *out = grey->data();
    for (std::int32_t v = 0; v < height_px; ++v, row += stride_bytes, out += width) {
        for (std::size_t u = 0; u < width; ++u) {
            out[u] = row[2 * u];
        }
    }
    return std::shared_ptr<const void>(grey, grey->data());
}

}  // namespace opms_host
