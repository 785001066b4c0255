/* SPDX-License-Identifier: Apache-2.0 */
#include "replay_devices.hpp"

#include "folder_source.hpp"

namespace opms_host {

bool open_replay(const std::string &source_path, const std::string &box_path, Devices &devices,
                 OpenError &error)
{
    error.kind = OpenFailure::input;
    if (!box_path.empty()) {
        error.text = box_path + " is no recorded scan";
        return false;
    }
    if (!devices.clock) {
        devices.clock = std::make_shared<SystemClock>();
    }
    devices.source = open_folder_source(source_path, devices.clock, error.text);
    return devices.source != nullptr;
}

}  // namespace opms_host
