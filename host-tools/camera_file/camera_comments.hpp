/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Comments of a camera file, so that a rewrite keeps them. */
#ifndef OPMS_HOST_CAMERA_COMMENTS_HPP
#define OPMS_HOST_CAMERA_COMMENTS_HPP

#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "camera_file.hpp"

namespace opms_host {

/** Comments of a parsed text, in its order. One on a line of its own belongs to the next key below,
 * one behind a value to the key it stands in. */
std::vector<CameraComment> camera_read_comments(const std::string &text,
                                                const YAML::Node &document);

}  // namespace opms_host
#endif
