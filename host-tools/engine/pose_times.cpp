/* SPDX-License-Identifier: Apache-2.0 */
#include "pose_times.hpp"

namespace opms_host {

void set_pose_times(const opms_pair_result_t &result, const opms_clock_t *box_clock,
                    PoseRecord &pose)
{
    pose.frame_state = result.frame_state;
    pose.known = result.known;
    if (result.frame_state != OPMS_FRAME_PAIRED) {
        return;
    }
    pose.trigger_number = result.trigger_number;
    if (!(result.known & OPMS_PAIR_HAS_TRIGGER_TIME)) {
        return;
    }
    pose.is_mid_exposure = (result.known & OPMS_PAIR_HAS_MID_EXPOSURE) != 0;
    if (result.known & OPMS_PAIR_HAS_START_EDGE) {
        pose.has_time = true;
        pose.t_scan_ns = result.mid_exposure_box_ns - result.start_edge_box_ns;
    }
    std::int64_t host_ns = 0;
    if (box_clock && opms_clock_host_from_box(box_clock, result.mid_exposure_box_ns, &host_ns,
                                              nullptr) == OPMS_OK) {
        pose.t_host_ns = host_ns;
    }
}

}  // namespace opms_host
