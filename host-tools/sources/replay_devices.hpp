/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What was recorded, once more as devices. */
#ifndef OPMS_SOURCES_REPLAY_DEVICES_HPP
#define OPMS_SOURCES_REPLAY_DEVICES_HPP

#include "open_devices.hpp"

namespace opms_host {

/** Replay @p source_path, @p box_path or both ("" where that device is none): a folder of pictures
 * (source alone), or a recorded scan. Sets what is asked for, and devices.clock where the recording
 * has its own time. @return false with @p error. */
bool open_replay(const std::string &source_path, const std::string &box_path, Devices &devices,
                 OpenError &error);

}  // namespace opms_host
#endif
