/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The two poses of a plane whose view is known to first order. */
#ifndef OPMS_POSE_PLANAR_H
#define OPMS_POSE_PLANAR_H

#include "pose/homography_start.h"

namespace opms::pose
{

/** The two poses with that view of the plane, its printed face towards the camera.
 *
 * @return false where the view shows the back of the plane or is no view of a plane. */
bool planar_poses(const PlaneView &view, Placement poses[2]);

/** The other pose with the same first-order view of the bar's plane around a bar point (X, Y). */
Placement planar_mirror(const Placement &placement, double X, double Y);

} // namespace opms::pose
#endif
