/* SPDX-License-Identifier: Apache-2.0 */
#include "picture_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "picture_header.hpp"

namespace {

constexpr std::size_t SLACK_BYTES = 64u << 20; /* for what a file may hold besides its pixels */

/** Read a whole file, but no more than @p most bytes. */
bool read_bytes(const std::string &path, std::size_t most, std::vector<unsigned char> &bytes,
                std::string &error)
{
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored)) {
        error = "is a directory, not a picture";
        return false;
    }
    errno = 0;
    const std::unique_ptr<std::FILE, int (*)(std::FILE *)> in(std::fopen(path.c_str(), "rb"),
                                                              &std::fclose);
    if (!in) {
        error = std::string("cannot open: ") + std::strerror(errno);
        return false;
    }
    std::size_t got = 0;
    do {
        bytes.resize(got + (1u << 20));
        got += std::fread(bytes.data() + got, 1, bytes.size() - got, in.get());
    } while (got == bytes.size() && got <= most);
    bytes.resize(got);
    if (std::ferror(in.get())) {
        error = std::string("cannot read: ") + std::strerror(errno);
        return false;
    }
    if (got > most) {
        error = "is larger than any picture of this camera";
        return false;
    }
    return true;
}

std::string size_text(uint64_t width, uint64_t height)
{
    return std::to_string(width) + " x " + std::to_string(height);
}

/** @return false with @p error where the file cannot be a picture of the expected size. */
bool check_header(const std::vector<unsigned char> &bytes, int32_t width_px, int32_t height_px,
                  std::string &error)
{
    if (bytes.empty()) {
        error = "is empty";
        return false;
    }
    const PictureHeader header = picture_header(bytes);
    if (header.kind == PictureKind::unknown) {
        error = "is no picture (PNG, JPEG, TIFF, BMP and PGM can be read)";
    } else if (header.width_px == 0 || header.height_px == 0) {
        error = "is a damaged picture: its header does not hold";
    } else if (header.width_px != static_cast<uint64_t>(width_px) ||
               header.height_px != static_cast<uint64_t>(height_px)) {
        error = "is " + size_text(header.width_px, header.height_px) +
                " px, but the camera file is for " +
                size_text(static_cast<uint64_t>(width_px), static_cast<uint64_t>(height_px));
    } else if (!header.complete) {
        error = "is a damaged picture: it ends early";
    }
    return error.empty();
}

cv::Mat decode(const std::vector<unsigned char> &bytes)
{
    try {
        return cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
    } catch (const cv::Exception &) {
        return cv::Mat();
    }
}

}  // namespace

cv::Mat picture_read(const std::string &path, int32_t width_px, int32_t height_px,
                     std::string &error)
{
    error.clear();
    const auto pixels = static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px);
    std::vector<unsigned char> bytes;
    if (!read_bytes(path, pixels * 8 + SLACK_BYTES, bytes, error) ||
        !check_header(bytes, width_px, height_px, error)) {
        return cv::Mat();
    }
    const cv::Mat picture = decode(bytes);
    if (picture.empty() || picture.cols != width_px || picture.rows != height_px) {
        error = "is a damaged picture: it cannot be decoded";
    } else if (picture.depth() != CV_8U && picture.depth() != CV_16U) {
        error = "has neither 8 nor 16 bit a pixel";
    } else if (picture.channels() != 1 && picture.channels() != 3 && picture.channels() != 4) {
        error = "has " + std::to_string(picture.channels()) + " channels; grey or colour is needed";
    }
    return error.empty() ? picture : cv::Mat();
}

cv::Mat picture_grey(const cv::Mat &picture)
{
    if (picture.channels() == 1) {
        return picture;
    }
    cv::Mat grey;
    cv::cvtColor(picture, grey,
                 picture.channels() == 4 ? cv::COLOR_BGRA2GRAY : cv::COLOR_BGR2GRAY);
    return grey;
}

opms_image_t picture_view(const cv::Mat &grey, uint16_t white_level)
{
    opms_image_t image = {};
    image.pixels = grey.data;
    image.width_px = grey.cols;
    image.height_px = grey.rows;
    image.stride_bytes = static_cast<ptrdiff_t>(grey.step[0]);
    image.format = grey.depth() == CV_16U ? OPMS_PIXEL_GREY16 : OPMS_PIXEL_GREY8;
    image.white_level = white_level;
    return image;
}
