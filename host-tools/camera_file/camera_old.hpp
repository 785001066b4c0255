/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What stands where a camera file is to be written. */
#ifndef OPMS_HOST_CAMERA_OLD_HPP
#define OPMS_HOST_CAMERA_OLD_HPP

#include <string>

#include "camera_file.hpp"

namespace opms_host {

/** Name, extras and comments of an old camera file, whose lens may be one that cannot be used.
 * Throws FieldError or YAML::Exception where it is no camera file: it must not be replaced. */
CameraFile camera_read_old(const std::string &path);

}  // namespace opms_host
#endif
