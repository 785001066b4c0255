/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * One picture of the target by itself: its homography, and its pose once the lens is roughly known.
 */
#ifndef OPMS_CALIB_PLANE_VIEW_H
#define OPMS_CALIB_PLANE_VIEW_H

#include "calib/calib_state.h"

namespace opms::calib
{

/** Fit the homography from the target's plane to pixels about the picture's middle, robustly.
 *
 * @return false where the points determine none. Fills in picture.homography and middle. */
bool fit_homography(const opms_calib_options_t &options, Picture &picture);

/** What the homographies say of the focal length, for square pixels and a principal point in the
 * picture's middle; 0 where they say nothing. */
double focal_from_homographies(const opms_calibrator &calibrator);

/** Pose of a picture for such a camera. */
void pose_from_homography(double focal_px, Picture &picture);

} // namespace opms::calib
#endif
