/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Any camera that OpenCV can open, for a look at the picture. Its frames have no ids and no times
 * that could be trusted (they may be repeated or old), so no pair of them is ever certain. */
#ifndef OPMS_SOURCES_PREVIEW_SOURCE_HPP
#define OPMS_SOURCES_PREVIEW_SOURCE_HPP

#include <memory>
#include <string>

#include "frame_source.hpp"
#include "host_clock.hpp"

namespace opms_host {

/** @param number  As OpenCV counts cameras. @return NULL on failure. */
std::unique_ptr<FrameSource> open_preview_source(int number, std::shared_ptr<HostClock> clock,
                                                 std::string &error);

}  // namespace opms_host
#endif
