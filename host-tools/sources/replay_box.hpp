/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The box and the camera of a recorded scan. */
#ifndef OPMS_SOURCES_REPLAY_BOX_HPP
#define OPMS_SOURCES_REPLAY_BOX_HPP

#include <memory>

#include "box_port.hpp"
#include "frame_source.hpp"
#include "replay_scan.hpp"

namespace opms_host {

/** Its settings are the recorded ones and stay so; it starts by itself where it was started. */
std::unique_ptr<BoxPort> make_replay_box(std::shared_ptr<ReplayScan> scan);

/** Pictures with the ids, stamps and exposures that were recorded with them. */
std::unique_ptr<FrameSource> make_replay_camera(std::shared_ptr<ReplayScan> scan);

}  // namespace opms_host
#endif
