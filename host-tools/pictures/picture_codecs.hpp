/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Pictures of all formats but PNG, by OpenCV's imgcodecs in the module opms_imgcodecs.so, which is
 * loaded when it is first needed: it brings more than a hundred libraries. */
#ifndef OPMS_PICTURES_PICTURE_CODECS_HPP
#define OPMS_PICTURES_PICTURE_CODECS_HPP

#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace opms_host {

/** Unpack a picture as it is: depth and channels are unchanged.
 * @return false with @p error where the module is missing; @p picture is empty where the file
 * cannot be decoded. */
bool codecs_decode(const std::vector<unsigned char> &file, cv::Mat &picture, std::string &error);

/** Pack an 8 bit picture as JPEG. @param quality  0 to 100. @return false with @p error. */
bool codecs_jpeg(const cv::Mat &picture, int quality, std::vector<unsigned char> &file,
                 std::string &error);

}  // namespace opms_host

/* The module's functions; false where it cannot be done. */
extern "C" {
bool opms_codecs_decode(const std::vector<unsigned char> &file, cv::Mat &picture);
bool opms_codecs_jpeg(const cv::Mat &picture, int quality, std::vector<unsigned char> &file);
}

#endif
