/* SPDX-License-Identifier: Apache-2.0 */
#include <charconv>
#include <cstdint>
#include <sstream>

#include <linux/videodev2.h>

#include "v4l2_controls.hpp"
#include "v4l2_source.hpp"

namespace opms_host {
namespace {

constexpr int DEVICES_MOST = 64;

bool parse_option(const std::string &option, V4l2Place &place)
{
    const std::size_t equals = option.find('=');
    const std::string key = option.substr(0, equals);
    const std::string value = equals == std::string::npos ? "" : option.substr(equals + 1);
    if (key == "size" && value.find('x') != std::string::npos) {
        place.size = value;
        return true;
    }
    if (key == "trigger" && value == "wired") {
        place.wired_trigger = true;
        return true;
    }
    if (key == "gain_step_db") {
        const char *const end = value.data() + value.size();
        const auto [next, error] = std::from_chars(value.data(), end, place.gain_step_db);
        return error == std::errc() && next == end && place.gain_step_db > 0 &&
               place.gain_step_db < 100;
    }
    return false;
}

}  // namespace

bool v4l2_place_parse(const std::string &text, V4l2Place &place, std::string &error)
{
    place = V4l2Place();
    std::istringstream parts(text);
    std::getline(parts, place.path, ',');
    if (place.path.empty() || place.path[0] != '/') {
        error = "v4l2:" + text + " names no device; give one such as v4l2:/dev/video0";
        return false;
    }
    for (std::string option; std::getline(parts, option, ',');) {
        if (!parse_option(option, place)) {
            error = option + " is no option of a V4L2 camera; give size=WIDTHxHEIGHT, "
                             "trigger=wired or gain_step_db=NUMBER";
            return false;
        }
    }
    return true;
}

std::vector<V4l2Entry> list_v4l2(V4l2Calls &calls)
{
    std::vector<V4l2Entry> entries;
    for (int i = 0; i < DEVICES_MOST; ++i) {
        const std::string path = "/dev/video" + std::to_string(i);
        const int fd = calls.open(path.c_str());
        if (fd < 0) {
            continue;
        }
        v4l2_capability who = {};
        if (calls.ioctl(fd, VIDIOC_QUERYCAP, &who) == 0) {
            const std::uint32_t can = (who.capabilities & V4L2_CAP_DEVICE_CAPS) != 0
                                          ? who.device_caps : who.capabilities;
            if ((can & V4L2_CAP_VIDEO_CAPTURE) != 0 && (can & V4L2_CAP_STREAMING) != 0) {
                const bool triggers = v4l2_find_controls(calls, fd).trigger.has_value();
                entries.push_back({path, reinterpret_cast<const char *>(who.card),
                                   triggers ? "has a trigger mode" : "no trigger mode known"});
            }
        }
        calls.close(fd);
    }
    return entries;
}

}  // namespace opms_host
