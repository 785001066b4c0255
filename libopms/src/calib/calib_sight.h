/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The camera on the detector, as one picture with the head at a known place has it. */
#ifndef OPMS_CALIB_CALIB_SIGHT_H
#define OPMS_CALIB_CALIB_SIGHT_H

#include "calib/calib_state.h"

namespace opms::calib
{

/** One footprint's view of the transform: (w, d) of it as functions of the pose's (w, d) and of the
 * placing's (x, y, yaw). */
struct Sight {
    Rigid detector_camera;
    Mat6 by_pose;
    Eigen::Matrix<double, 6, 3> by_placing;
};

Sight sight_of(const Picture &picture, const opms_footprint_t &footprint);

/** Of the image noise and of the placing, the lens known. */
Mat6 placing_covariance(const Picture &picture, const opms_footprint_t &footprint,
                        const Sight &sight);

/** (w, d) from one transform to another. */
Vec6 rigid_difference(const Rigid &from, const Rigid &to);

/** Place and sigmas finite and in range; `index` goes into the message. */
opms_status_t check_placing(const opms_footprint_t &footprint, uint32_t index, opms_error_t *err);

} // namespace opms::calib
#endif
