/* SPDX-License-Identifier: Apache-2.0 */
#include "picture_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "picture_codecs.hpp"
#include "picture_header.hpp"
#include "png_matrix.hpp"

namespace {

constexpr std::size_t SLACK_BYTES = 64u << 20; /* for what a file may hold besides its pixels */
constexpr std::size_t FILE_BYTES_MAX = 1u << 30; /* of a picture whose size is not known before */
constexpr int32_t SIDE_LEAST_PX = 16, SIDE_MOST_PX = 16384;

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
        error = "is larger than any such picture";
        return false;
    }
    return true;
}

std::string size_text(uint64_t width, uint64_t height)
{
    return std::to_string(width) + " x " + std::to_string(height);
}

/** @return false with @p error where the file cannot be a whole picture. */
bool check_header(const std::vector<unsigned char> &bytes, PictureHeader &header,
                  std::string &error)
{
    if (bytes.empty()) {
        error = "is empty";
        return false;
    }
    header = picture_header(bytes);
    if (header.kind == PictureKind::unknown) {
        error = "is no picture (PNG, JPEG, TIFF, BMP and PGM can be read)";
    } else if (header.width_px == 0 || header.height_px == 0) {
        error = "is a damaged picture: its header does not hold";
    }
    return error.empty();
}

/** @return Empty with @p error where the format's reader is missing, without where it fails. */
cv::Mat decode(const std::vector<unsigned char> &bytes, PictureKind kind, std::string &error)
{
    if (kind == PictureKind::png) {
        return opms_host::png_to_matrix(bytes);
    }
    cv::Mat picture;
    opms_host::codecs_decode(bytes, picture, error);
    return picture;
}

/** Unpack a picture whose header has been found good. */
cv::Mat unpack(const std::vector<unsigned char> &bytes, const PictureHeader &header,
               std::string &error)
{
    if (!header.complete) {
        error = "is a damaged picture: it ends early";
        return cv::Mat();
    }
    const cv::Mat picture = decode(bytes, header.kind, error);
    if (!error.empty()) {
        return cv::Mat();
    }
    if (picture.empty() || static_cast<uint64_t>(picture.cols) != header.width_px ||
        static_cast<uint64_t>(picture.rows) != header.height_px) {
        error = "is a damaged picture: it cannot be decoded";
    } else if (picture.depth() != CV_8U && picture.depth() != CV_16U) {
        error = "has neither 8 nor 16 bit a pixel";
    } else if (picture.channels() != 1 && picture.channels() != 3 && picture.channels() != 4) {
        error = "has " + std::to_string(picture.channels()) + " channels; grey or colour is needed";
    }
    return error.empty() ? picture : cv::Mat();
}

}  // namespace

cv::Mat picture_read(const std::string &path, int32_t width_px, int32_t height_px,
                     std::string &error)
{
    error.clear();
    const auto width = static_cast<std::size_t>(width_px);
    const auto height = static_cast<std::size_t>(height_px);
    std::vector<unsigned char> bytes;
    PictureHeader header;
    if (!read_bytes(path, width * height * 8 + SLACK_BYTES, bytes, error) ||
        !check_header(bytes, header, error)) {
        return cv::Mat();
    }
    if (header.width_px != width || header.height_px != height) {
        error = "is " + size_text(header.width_px, header.height_px) +
                " px, but the camera file is for " + size_text(width, height);
        return cv::Mat();
    }
    return unpack(bytes, header, error);
}

cv::Mat picture_read_any(const std::string &path, std::string &error)
{
    error.clear();
    std::vector<unsigned char> bytes;
    PictureHeader header;
    if (!read_bytes(path, FILE_BYTES_MAX, bytes, error) || !check_header(bytes, header, error)) {
        return cv::Mat();
    }
    const auto fits = [](uint64_t side) { return side >= SIDE_LEAST_PX && side <= SIDE_MOST_PX; };
    if (!fits(header.width_px) || !fits(header.height_px)) {
        error = "is " + size_text(header.width_px, header.height_px) +
                " px; pictures of 16 to 16384 px a side can be used";
        return cv::Mat();
    }
    return unpack(bytes, header, error);
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
