/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A folder of pictures as a camera that waits for who takes them. */
#ifndef OPMS_SOURCES_FOLDER_SOURCE_HPP
#define OPMS_SOURCES_FOLDER_SOURCE_HPP

#include <memory>
#include <string>

#include "frame_source.hpp"
#include "host_clock.hpp"

namespace opms_host {

/** Pictures of @p folder, in the order of their names (numbers in them by value); all have the size
 * of the first. They bring no camera's id and no time. @return NULL on failure. */
std::unique_ptr<FrameSource> open_folder_source(const std::string &folder,
                                                std::shared_ptr<HostClock> clock,
                                                std::string &error);

/** a9 before a10: runs of digits by their value, the rest by its bytes. */
bool name_is_before(const std::string &a, const std::string &b);

}  // namespace opms_host
#endif
