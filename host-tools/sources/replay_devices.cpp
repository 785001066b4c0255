/* SPDX-License-Identifier: Apache-2.0 */
#include "replay_devices.hpp"

#include <filesystem>

#include "folder_source.hpp"
#ifdef OPMS_SOURCES_HAVE_RECORDING
#include "replay_box.hpp"
#endif

namespace opms_host {
namespace {

bool is_scan(const std::string &path)
{
    namespace fs = std::filesystem;
    std::error_code ignored;
    return fs::path(path).extension() == ".sqlite" || fs::exists(path + "/scan.sqlite", ignored);
}

bool open_scan(const std::string &path, bool with_source, bool with_box, Devices &devices,
               std::string &error)
{
#ifdef OPMS_SOURCES_HAVE_RECORDING
    const std::shared_ptr<ReplayScan> scan = ReplayScan::open(path, error);
    if (!scan) {
        return false;
    }
    if (with_box && !scan->header().has_box) {
        error = path + " was recorded without a box";
        return false;
    }
    scan->use(with_box, with_source);
    devices.clock = scan;
    devices.box = with_box ? make_replay_box(scan) : std::move(devices.box);
    devices.source = with_source ? make_replay_camera(scan) : nullptr;
    return true;
#else
    (void)with_source;
    (void)with_box;
    (void)devices;
    error = path + ": this program was built without SQLite: no recordings";
    return false;
#endif
}

}  // namespace

bool open_replay(const std::string &source_path, const std::string &box_path, Devices &devices,
                 OpenError &error)
{
    error.kind = OpenFailure::input;
    if (!box_path.empty() && !is_scan(box_path)) {
        error.text = box_path + " is no recorded scan: it has no scan.sqlite";
        return false;
    }
    if (!box_path.empty() && !source_path.empty() && box_path != source_path) {
        error.text = "box and camera must be of the same recording: " + box_path + " and " +
                     source_path + " are not";
        return false;
    }
    if (!box_path.empty() || is_scan(source_path)) {
        return open_scan(box_path.empty() ? source_path : box_path, !source_path.empty(),
                         !box_path.empty(), devices, error.text);
    }
    if (!devices.clock) {
        devices.clock = std::make_shared<SystemClock>();
    }
    devices.source = open_folder_source(source_path, devices.clock, error.text);
    return devices.source != nullptr;
}

}  // namespace opms_host
