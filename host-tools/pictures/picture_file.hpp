/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Reads a picture file as the camera delivered it. */
#ifndef OPMS_PICTURES_PICTURE_FILE_HPP
#define OPMS_PICTURES_PICTURE_FILE_HPP

#include <cstdint>
#include <string>

#include <opencv2/core.hpp>

#include <opms/types.h>

/** Read a picture of a known size; pixels are unchanged (8 or 16 bit, grey or colour).
 *
 * Nothing is unpacked before the file's header has shown the expected size.
 *
 * @param[out] error  On failure what is wrong, without the file's name.
 * @return An empty matrix on failure. */
cv::Mat picture_read(const std::string &path, int32_t width_px, int32_t height_px,
                     std::string &error);

/** Read a picture of any size from 16 to 16384 px a side; else as picture_read(). */
cv::Mat picture_read_any(const std::string &path, std::string &error);

/** Grey of a picture from picture_read(): itself, or the luma of a colour picture. */
cv::Mat picture_grey(const cv::Mat &picture);

/** A view on a grey matrix. @param white_level as in opms_image_t. */
opms_image_t picture_view(const cv::Mat &grey, uint16_t white_level);

#endif
