/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Writes the camera file (docs/conventions.md) that camera_file.hpp reads.
 *
 * What the reader reads back are the same bits. The file is written aside and then renamed, so that
 * there is the old file or the new one, never half of one. Keys of an old file that are none of
 * ours (ROS's own, a vendor's) are carried over, and its comments above the keys that they stood
 * at. Nothing is thrown. */
#ifndef OPMS_HOST_CAMERA_FILE_WRITE_HPP
#define OPMS_HOST_CAMERA_FILE_WRITE_HPP

#include <string>
#include <vector>

#include "camera_file.hpp"

namespace opms_host {

/** Whether a camera file can be written there: nothing is there yet, or one that may be replaced.
 * Call it before the work that leads to the file. @p error begins with the path. */
bool camera_file_may_write(const std::string &path, std::string &error) noexcept;

/** Write a camera file. An empty @p file.name keeps that of an old file.
 *
 * @param[out] error  On failure one line that begins with the path; the old file is untouched.
 * @param[out] notes  NULL, or gets what that format cannot hold. */
bool camera_file_write(const std::string &path, const CameraFile &file, std::string &error,
                       CameraFormat format = CameraFormat::ros,
                       std::vector<std::string> *notes = nullptr) noexcept;

}  // namespace opms_host
#endif
