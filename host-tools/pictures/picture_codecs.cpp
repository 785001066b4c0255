/* SPDX-License-Identifier: Apache-2.0 */
#include "picture_codecs.hpp"

#include "program_module.hpp"

namespace opms_host {

namespace {

constexpr char MODULE[] = "opms_imgcodecs.so";

}  // namespace

bool codecs_decode(const std::vector<unsigned char> &file, cv::Mat &picture, std::string &error)
{
    const auto decode = reinterpret_cast<decltype(&opms_codecs_decode)>(
        program_module_symbol(MODULE, "opms_codecs_decode", error));
    if (!decode) {
        return false;
    }
    if (!decode(file, picture)) {
        picture.release();
    }
    return true;
}

bool codecs_jpeg(const cv::Mat &picture, int quality, std::vector<unsigned char> &file,
                 std::string &error)
{
    const auto pack = reinterpret_cast<decltype(&opms_codecs_jpeg)>(
        program_module_symbol(MODULE, "opms_codecs_jpeg", error));
    if (!pack) {
        return false;
    }
    if (!pack(picture, quality, file)) {
        error = "the picture cannot be encoded";
        return false;
    }
    return true;
}

}  // namespace opms_host
