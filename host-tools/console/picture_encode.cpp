/* SPDX-License-Identifier: Apache-2.0 */
#include "picture_encode.hpp"

#include <vector>

#include <opencv2/core.hpp>

#include "picture_codecs.hpp"
#include "png_matrix.hpp"

namespace opms_host {

namespace {

constexpr int PNG_FAST = 1, JPEG_QUALITY = 85;

cv::Mat eight_bits(const cv::Mat &grey, const opms_image_t &image)
{
    if (grey.depth() == CV_8U) {
        return grey;
    }
    cv::Mat scaled;
    const double white = image.white_level > 0 ? image.white_level : 65535.0;
    grey.convertTo(scaled, CV_8U, 255.0 / white);
    return scaled;
}

}  // namespace

bool picture_encode(const opms_image_t &image, bool png, std::string &bytes, std::string &error)
{
    const int type = image.format == OPMS_PIXEL_GREY16 ? CV_16UC1 : CV_8UC1;
    /* OpenCV has no view of constant pixels; nothing is written through it. */
    const cv::Mat grey(image.height_px, image.width_px, type, const_cast<void *>(image.pixels),
                       static_cast<std::size_t>(image.stride_bytes));
    std::vector<unsigned char> file;
    if (png) {
        file = png_from_matrix(grey, PNG_FAST);
    } else if (!codecs_jpeg(eight_bits(grey, image), JPEG_QUALITY, file, error)) {
        return false;
    }
    if (file.empty()) {
        error = "the picture cannot be encoded";
        return false;
    }
    bytes.assign(file.begin(), file.end());
    return true;
}

}  // namespace opms_host
