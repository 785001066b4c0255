/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A frame with its picture, out of what is true of it. */
#ifndef OPMS_SIMULATED_WORLD_FRAME_HPP
#define OPMS_SIMULATED_WORLD_FRAME_HPP

#include <memory>

#include "frame_source.hpp"
#include "world_options.hpp"
#include "world_pictures.hpp"
#include "world_truth.hpp"

namespace opms_host {

/** @param pixels  A buffer of the camera's size, filled here. Takes about a millisecond. */
FramePtr world_frame(WorldPictures &pictures, const WorldOptions &options, const TrueFrame &truth,
                     std::shared_ptr<std::uint8_t> pixels);

/** Id as the camera writes it; @p id counts from 1. */
std::uint64_t world_raw_id(const WorldOptions &options, std::uint64_t id);

/** What such a camera tells with its frames. */
opms_camera_profile_t world_camera_profile(const WorldOptions &options);

}  // namespace opms_host
#endif
