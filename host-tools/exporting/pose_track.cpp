/* SPDX-License-Identifier: Apache-2.0 */
#include "pose_track.hpp"

#include <algorithm>

namespace opms_host {

void PoseTrack::add(const PoseRecord &pose)
{
    if (!pose.has_time || pose.location.state != OPMS_BAR_LOCATED) {
        return;
    }
    const opms_pose_t &from = pose_of(pose.location);
    Point point;
    point.t_scan_ns = pose.t_scan_ns;
    std::copy(from.transform.t_m, from.transform.t_m + 3, point.pose.t_m);
    point.pose.rotation = quaternion_from_matrix(from.transform.R);
    point.pose.sigmas = pose_sigmas(from);
    sorted_ = sorted_ && (points_.empty() || points_.back().t_scan_ns <= point.t_scan_ns);
    points_.push_back(point);
}

void PoseTrack::sort()
{
    if (!sorted_) {
        std::stable_sort(points_.begin(), points_.end(), [](const Point &a, const Point &b) {
            return a.t_scan_ns < b.t_scan_ns;
        });
        sorted_ = true;
    }
}

bool PoseTrack::at(std::int64_t t_scan_ns, std::int64_t most_gap_ns, TrackPose &pose)
{
    sort();
    const auto after = std::lower_bound(
        points_.begin(), points_.end(), t_scan_ns,
        [](const Point &point, std::int64_t t_ns) { return point.t_scan_ns < t_ns; });
    if (after == points_.end()) {
        return false;
    }
    if (after->t_scan_ns == t_scan_ns) {
        pose = after->pose;
        return true;
    }
    if (after == points_.begin()) {
        return false;
    }
    const Point &a = *(after - 1), &b = *after;
    const std::int64_t gap_ns = b.t_scan_ns - a.t_scan_ns;
    if (gap_ns > most_gap_ns) {
        return false;
    }
    const double part =
        static_cast<double>(t_scan_ns - a.t_scan_ns) / static_cast<double>(gap_ns);
    pose.gap_ns = gap_ns;
    pose.rotation = quaternion_between(a.pose.rotation, b.pose.rotation, part);
    for (std::size_t i = 0; i < 3; i++) {
        pose.t_m[i] = a.pose.t_m[i] + part * (b.pose.t_m[i] - a.pose.t_m[i]);
        pose.sigmas.position_mm[i] =
            std::max(a.pose.sigmas.position_mm[i], b.pose.sigmas.position_mm[i]);
        pose.sigmas.rotation_deg[i] =
            std::max(a.pose.sigmas.rotation_deg[i], b.pose.sigmas.rotation_deg[i]);
    }
    return true;
}

}  // namespace opms_host
