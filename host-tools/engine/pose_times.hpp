/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * From the decision on a picture's pair to the times of its pose. */
#ifndef OPMS_ENGINE_POSE_TIMES_HPP
#define OPMS_ENGINE_POSE_TIMES_HPP

#include "scan_records.hpp"

namespace opms_host {

/** Set what the pair tells of the pose. A time on the scan's axis is given only where the pair is
 * certain and both the trigger and the start edge are known. The length of the exposure is what the
 * strobe showed; else what the frame reports, because it changes with the light; else what the
 * camera's profile states.
 * @param exposure_us  As the frame reports it; NaN: it does not.
 * @param box_clock    The pairer's; NULL: no time on the host's clock. */
void set_pose_times(const opms_pair_result_t &result, double exposure_us,
                    const opms_clock_t *box_clock, PoseRecord &pose);

}  // namespace opms_host
#endif
