/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The pose of one picture for a lens that is known. */
#ifndef OPMS_CALIB_POSE_ALONE_H
#define OPMS_CALIB_POSE_ALONE_H

#include "calib/calib_state.h"

namespace opms::calib
{

/** Improve picture.pose from where it is, the lens as it stands, with a robust scale of its own:
 * among pictures that fit already, all its points would be outliers. */
void solve_pose_alone(const opms_calibrator &calibrator, Picture &picture);

} // namespace opms::calib
#endif
