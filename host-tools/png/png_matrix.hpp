/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * PNG files and OpenCV's matrices. */
#ifndef OPMS_PNG_PNG_MATRIX_HPP
#define OPMS_PNG_PNG_MATRIX_HPP

#include <cstddef>
#include <vector>

#include <opencv2/core.hpp>

namespace opms_host {

/** The pixels of a file as they are: 8 or 16 bit; grey, BGR or BGRA; as OpenCV's imdecode() with
 * IMREAD_UNCHANGED gives them. @return An empty matrix where the file is damaged. */
cv::Mat png_to_matrix(const std::vector<unsigned char> &file);

/** A file of a matrix of 8 or 16 bit with 1 (grey), 3 (BGR) or 4 (BGRA) channels.
 * @param level  zlib's, 0 to 9.
 * @return Empty where the matrix is none of these or there is no memory. */
std::vector<unsigned char> png_from_matrix(const cv::Mat &picture, int level);

}  // namespace opms_host
#endif
