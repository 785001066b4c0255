/* SPDX-License-Identifier: Apache-2.0 */
#include "scan_times.hpp"

#include <algorithm>
#include <ctime>

namespace opms_host {

std::uint64_t ScanTimes::wall_ns(std::int64_t host_ns) const
{
    return static_cast<std::uint64_t>(std::max<std::int64_t>(0, host_ns + offset_ns_));
}

std::uint64_t ScanTimes::wall_ns(const PoseRecord &pose) const
{
    return wall_ns(pose.t_host_ns != 0 ? pose.t_host_ns : pose.arrival_host_ns);
}

void ScanTimes::learn(const PoseRecord &pose)
{
    if (pose.has_time && pose.t_host_ns != 0) {
        has_axis_ = true;
        axis_host_ns_ = pose.t_host_ns - pose.t_scan_ns;
    }
}

std::uint64_t ScanTimes::wall_ns(const SensorRecord &sample) const
{
    const bool placed = sample.has_time && has_axis_;
    return wall_ns(placed ? axis_host_ns_ + sample.t_scan_ns : sample.arrival_host_ns);
}

std::string wall_time_text(std::int64_t wall_ns)
{
    const std::time_t seconds =
        static_cast<std::time_t>(wall_ns / 1000000000 - (wall_ns % 1000000000 < 0 ? 1 : 0));
    std::tm parts = {};
    if (gmtime_r(&seconds, &parts) == nullptr) {
        return "?";
    }
    char text[40];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
    return text;
}

}  // namespace opms_host
