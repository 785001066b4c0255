/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The poses of a scan on its time axis, and where the detector was in between. */
#ifndef OPMS_EXPORTING_POSE_TRACK_HPP
#define OPMS_EXPORTING_POSE_TRACK_HPP

#include <cstdint>
#include <vector>

#include "pose_values.hpp"
#include "scan_records.hpp"

namespace opms_host {

/** A pose between two of the track. */
struct TrackPose {
    double t_m[3] = {0, 0, 0};
    Quaternion rotation;
    PoseSigmas sigmas;       /**< of the less exact of the two */
    std::int64_t gap_ns = 0; /**< from the one before to the one after; 0: on one of them */
};

class PoseTrack {
public:
    /** Located poses with a certain time are taken, others passed over. */
    void add(const PoseRecord &pose);
    /** @return False where the time lies before the first or after the last pose, or where those
     * beside it are further apart than @p most_gap_ns: nothing is made up there. */
    bool at(std::int64_t t_scan_ns, std::int64_t most_gap_ns, TrackPose &pose);
    std::size_t size() const { return points_.size(); }

private:
    struct Point {
        std::int64_t t_scan_ns = 0;
        TrackPose pose;
    };

    void sort();

    std::vector<Point> points_;
    bool sorted_ = true;
};

}  // namespace opms_host
#endif
