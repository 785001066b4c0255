/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Cameras of Video4Linux, without a library between. */
#ifndef OPMS_SOURCES_V4L2_SOURCE_HPP
#define OPMS_SOURCES_V4L2_SOURCE_HPP

#include <memory>
#include <string>
#include <vector>

#include "frame_source.hpp"
#include "host_clock.hpp"
#include "v4l2_calls.hpp"

namespace opms_host {

/** What stands behind "v4l2:". */
struct V4l2Place {
    std::string path;         /**< "/dev/video0" */
    std::string size;         /**< "1280x720"; empty: as the camera is set */
    bool wired_trigger = false; /**< it follows TRIG by a setting of its own */
    double gain_step_db = 0;  /**< what one step of its gain is; 0: not known */
};

/** "PATH[,size=WxH][,trigger=wired][,gain_step_db=X]". @return Whether it has that form. */
bool v4l2_place_parse(const std::string &text, V4l2Place &place, std::string &error);

/** @param wait_for_missing  A camera that is not there is sought from then on instead.
 * @param calls  NULL: those of the system.
 * @return NULL on failure. */
std::unique_ptr<FrameSource> open_v4l2_source(const V4l2Place &place, bool wait_for_missing,
                                              std::shared_ptr<HostClock> clock,
                                              std::shared_ptr<V4l2Calls> calls,
                                              std::string &error);

/** A camera that is there. */
struct V4l2Entry {
    std::string path, card, notes;
};

std::vector<V4l2Entry> list_v4l2(V4l2Calls &calls);

}  // namespace opms_host
#endif
