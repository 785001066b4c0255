// SPDX-License-Identifier: Apache-2.0
#include "calib/calib_sight.h"

#include <cmath>

#include "base/fail.h"

namespace opms::calib
{

Sight sight_of(const Picture &picture, const opms_footprint_t &footprint)
{
    Sight sight;
    const double c = std::cos(footprint.yaw_rad), s = std::sin(footprint.yaw_rad);
    Mat3 detector_target;
    detector_target << c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0;
    const Vec3 place(footprint.x_m, footprint.y_m, 0.0);
    sight.detector_camera.R = detector_target * picture.pose.R;
    sight.detector_camera.t = detector_target * (picture.pose.t - place);
    sight.by_pose.setIdentity();
    sight.by_pose.bottomRightCorner<3, 3>() = detector_target;
    // The head is truly further on by (dx, dy) and turned by dyaw: seen from it, all is less so.
    sight.by_placing.setZero();
    sight.by_placing.bottomLeftCorner<3, 2>() = -detector_target.leftCols<2>();
    const Vec3 up = Vec3::UnitZ();
    sight.by_placing.col(2).head<3>() = -(sight.detector_camera.R.transpose() * up);
    sight.by_placing.col(2).tail<3>() = -up.cross(sight.detector_camera.t);
    return sight;
}

Mat6 placing_covariance(const Picture &picture, const opms_footprint_t &footprint,
                        const Sight &sight)
{
    Vec3 placing(footprint.sigma_m, footprint.sigma_m, footprint.sigma_rad);
    placing = placing.cwiseAbs2();
    return sight.by_pose * picture.pose_covariance * sight.by_pose.transpose() +
           sight.by_placing * placing.asDiagonal() * sight.by_placing.transpose();
}

Vec6 rigid_difference(const Rigid &from, const Rigid &to)
{
    Vec6 step;
    step.head<3>() = opms::algebra::rotation_log(from.R.transpose() * to.R);
    step.tail<3>() = to.t - from.t;
    return step;
}

opms_status_t check_placing(const opms_footprint_t &footprint, uint32_t index, opms_error_t *err)
{
    if (!std::isfinite(footprint.x_m) || !std::isfinite(footprint.y_m) ||
        !std::isfinite(footprint.yaw_rad) || !(footprint.sigma_m >= 0.0) ||
        !(footprint.sigma_m < 1.0) || !(footprint.sigma_rad >= 0.0) ||
        !(footprint.sigma_rad < 1.0)) {
        return opms_fail(err, OPMS_ERR_ARG, "calib", (int32_t)index,
                         "footprint %u: place or sigma is not finite or out of range", index);
    }
    return OPMS_OK;
}

} // namespace opms::calib
