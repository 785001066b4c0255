/* SPDX-License-Identifier: Apache-2.0 */
#include "pose_times.hpp"

#include <cmath>

namespace opms_host {
namespace {

struct MidExposure {
    std::int64_t box_ns = 0;
    bool is_whole = false; /**< no term is missing */
};

MidExposure mid_exposure(const opms_pair_result_t &result, double exposure_us)
{
    const bool is_seen = (result.known & OPMS_PAIR_EXPOSURE_SEEN) != 0;
    bool has_exposure = (result.known & OPMS_PAIR_HAS_EXPOSURE) != 0;
    std::int64_t exposure_ns = has_exposure ? result.exposure_ns : 0;
    MidExposure mid;
    mid.box_ns = result.mid_exposure_box_ns;
    if (!is_seen && exposure_us > 0) {
        mid.box_ns -= exposure_ns / 2;
        exposure_ns = std::llround(exposure_us * 1e3);
        mid.box_ns += exposure_ns / 2;
        has_exposure = true;
    }
    mid.is_whole = has_exposure && (result.known & OPMS_PAIR_HAS_START_DELAY);
    return mid;
}

}  // namespace

void set_pose_times(const opms_pair_result_t &result, double exposure_us,
                    const opms_clock_t *box_clock, PoseRecord &pose)
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
    const MidExposure mid = mid_exposure(result, exposure_us);
    pose.is_mid_exposure = mid.is_whole;
    if (result.known & OPMS_PAIR_HAS_START_EDGE) {
        pose.has_time = true;
        pose.t_scan_ns = mid.box_ns - result.start_edge_box_ns;
    }
    std::int64_t host_ns = 0;
    if (box_clock &&
        opms_clock_host_from_box(box_clock, mid.box_ns, &host_ns, nullptr) == OPMS_OK) {
        pose.t_host_ns = host_ns;
    }
}

}  // namespace opms_host
