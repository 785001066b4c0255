/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What differs between a recorded pose and the same one made again. Pure. */
#ifndef OPMS_CLI_REPLAY_COMPARE_HPP
#define OPMS_CLI_REPLAY_COMPARE_HPP

#include <cstdint>
#include <string>
#include <vector>

#include "scan_records.hpp"

enum class ReplayFrom { pictures, points };

/** Of one picture. */
struct PoseChange {
    std::uint64_t number = 0;
    opms_bar_state_t recorded = OPMS_BAR_ABSENT, again = OPMS_BAR_ABSENT;
    /** Names of what is not the same to the last bit: "state", "pose", "covariance", ... */
    std::vector<std::string> differs;
    bool both_located = false;
    double position_mm = 0, angle_deg = 0; /**< valid where both_located */

    bool identical() const { return differs.empty(); }
};

/** @param from  Of points, what the picture alone gives (squares, edges, grey levels) is left out.
 */
PoseChange compare_poses(const opms_host::PoseRecord &recorded, const opms_host::PoseRecord &again,
                         ReplayFrom from);

/** Of all pictures. */
struct ReplayFigures {
    std::uint64_t compared = 0, identical = 0, states_changed = 0, both_located = 0;
    double position_rms_mm = 0, position_most_mm = 0, angle_rms_deg = 0, angle_most_deg = 0;
};

class ReplaySums {
public:
    void add(const PoseChange &change);
    ReplayFigures figures() const;

private:
    ReplayFigures so_far_;
    double position_sum_mm2_ = 0, angle_sum_deg2_ = 0;
};

#endif
