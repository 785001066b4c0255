/* SPDX-License-Identifier: Apache-2.0 */
/* No exception may pass through libpng, which calls room() and append(). */
#include "png_matrix.hpp"

#include <new>

#include "png_pack.h"
#include "png_unpack.h"

namespace opms_host {

namespace {

unsigned char *room(void *context, const png_layout *layout)
{
    auto *const picture = static_cast<cv::Mat *>(context);
    const int depth = layout->is_16_bit ? CV_16U : CV_8U;
    try {
        picture->create(static_cast<int>(layout->height_px), static_cast<int>(layout->width_px),
                        CV_MAKETYPE(depth, layout->channels));
    } catch (const cv::Exception &) {
        return nullptr;
    } catch (const std::bad_alloc &) {
        return nullptr;
    }
    return picture->data;
}

bool append(void *context, const unsigned char *bytes, std::size_t size)
{
    auto *const file = static_cast<std::vector<unsigned char> *>(context);
    try {
        file->insert(file->end(), bytes, bytes + size);
    } catch (const std::bad_alloc &) {
        return false;
    }
    return true;
}

}  // namespace

cv::Mat png_to_matrix(const std::vector<unsigned char> &file)
{
    cv::Mat picture;
    return png_unpack(file.data(), file.size(), room, &picture) ? picture : cv::Mat();
}

std::vector<unsigned char> png_from_matrix(const cv::Mat &picture, int level)
{
    const int depth = picture.depth(), channels = picture.channels();
    std::vector<unsigned char> file;
    if (picture.empty() || (depth != CV_8U && depth != CV_16U) || channels < 1 || channels > 4 ||
        channels == 2) {
        return file;
    }
    png_pixels pixels = {};
    pixels.layout.width_px = static_cast<std::uint32_t>(picture.cols);
    pixels.layout.height_px = static_cast<std::uint32_t>(picture.rows);
    pixels.layout.channels = channels;
    pixels.layout.is_16_bit = depth == CV_16U;
    pixels.first = picture.data;
    pixels.stride_bytes = picture.step[0];
    if (!png_pack(&pixels, level, append, &file)) {
        file.clear();
    }
    return file;
}

}  // namespace opms_host
