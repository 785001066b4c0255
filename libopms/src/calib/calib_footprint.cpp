// SPDX-License-Identifier: Apache-2.0
// Camera to detector, from pictures taken while the head stood at known places on the target. Each
// gives one transform; their weighted mean is the answer. The lens is common to all of them, so
// its part of the uncertainty does not average out and is carried through the mean.
#include <opms/calib.h>

#include <cmath>

#include "algebra/spd.h"
#include "base/fail.h"
#include "calib/calib_covariance.h"

#define STAGE "calib"

using namespace opms::calib;
using opms::algebra::RowMajor;

namespace
{

/* One footprint's view of the transform: (w, d) of it as functions of the pose's (w, d) and of the
 * placing's (x, y, yaw). */
struct Sight {
    Rigid detector_camera;
    Mat6 by_pose;
    Eigen::Matrix<double, 6, 3> by_placing;
};

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

Mat6 own_covariance(const Picture &picture, const opms_footprint_t &footprint, const Sight &sight)
{
    Vec3 placing(footprint.sigma_m, footprint.sigma_m, footprint.sigma_rad);
    placing = placing.cwiseAbs2();
    return sight.by_pose * picture.pose_covariance * sight.by_pose.transpose() +
           sight.by_placing * placing.asDiagonal() * sight.by_placing.transpose();
}

/* (w, d) from one transform to another. */
Vec6 difference(const Rigid &from, const Rigid &to)
{
    Vec6 step;
    step.head<3>() = opms::algebra::rotation_log(from.R.transpose() * to.R);
    step.tail<3>() = to.t - from.t;
    return step;
}

opms_status_t check(const opms_calibrator_t *calibrator, const opms_footprint_t *footprints,
                    uint32_t count, const opms_camera_t *camera, opms_error_t *err)
{
    if (!calibrator || !footprints || !camera) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "calibrator, footprints or camera is NULL");
    }
    if (!calibrator->solved) {
        return opms_fail(err, OPMS_ERR_DOMAIN, STAGE, -1, "there is no solution yet");
    }
    if (count == 0) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "no footprint is given");
    }
    for (uint32_t i = 0; i < count; ++i) {
        const opms_footprint_t &footprint = footprints[i];
        if (footprint.picture >= calibrator->picture_count ||
            !in_use(calibrator->pictures[footprint.picture])) {
            return opms_fail(err, OPMS_ERR_ARG, STAGE, (int32_t)i,
                             "footprint %u: picture %u is not in the solution", i,
                             footprint.picture);
        }
        if (!std::isfinite(footprint.x_m) || !std::isfinite(footprint.y_m) ||
            !std::isfinite(footprint.yaw_rad) || !(footprint.sigma_m >= 0.0) ||
            !(footprint.sigma_m < 1.0) || !(footprint.sigma_rad >= 0.0) ||
            !(footprint.sigma_rad < 1.0)) {
            return opms_fail(err, OPMS_ERR_ARG, STAGE, (int32_t)i,
                             "footprint %u: place or sigma is not finite or out of range", i);
        }
    }
    return OPMS_OK;
}

/* The weighted mean of what all footprints see, and how it answers to each of them. */
struct Mean {
    Rigid transform;
    Mat6 own;                             // covariance without the lens's part
    Mat6Shared by_shared;
};

bool mean_of(const opms_calibrator_t &calibrator, const opms_footprint_t *footprints,
             uint32_t count, Mean &mean)
{
    const auto picture = [&](uint32_t i) -> const Picture & {
        return calibrator.pictures[footprints[i].picture];
    };
    mean.transform = sight_of(picture(0), footprints[0]).detector_camera;
    Mat6 total = Mat6::Zero();
    Vec6 pull = Vec6::Zero();
    mean.by_shared.setZero();
    for (uint32_t i = 0; i < count; ++i) {
        const Sight sight = sight_of(picture(i), footprints[i]);
        Mat6 weight = own_covariance(picture(i), footprints[i], sight);
        if (!spd_invert(weight.data(), 6, SPD_PIVOT_LEAST)) {
            return false;
        }
        total += weight;
        pull += weight * difference(mean.transform, sight.detector_camera);
        mean.by_shared -= (weight * sight.by_pose).eval().lazyProduct(picture(i).slope);
    }
    mean.own = total;
    if (!spd_invert(mean.own.data(), 6, SPD_PIVOT_LEAST)) {
        return false;
    }
    const Vec6 step = mean.own * pull;
    mean.transform.R = opms::algebra::orthonormal(
        mean.transform.R * opms::algebra::rotation_exp(step.head<3>()));
    mean.transform.t += step.tail<3>();
    mean.by_shared = mean.own.lazyProduct(mean.by_shared).eval();
    return true;
}

} // namespace

opms_status_t opms_calibrator_camera(const opms_calibrator_t *calibrator,
                                     const opms_footprint_t *footprints, uint32_t count,
                                     opms_camera_t *camera, opms_error_t *err)
{
    OPMS_TRY(check(calibrator, footprints, count, camera, err));
    Mean mean;
    if (!mean_of(*calibrator, footprints, count, mean)) {
        return opms_fail(err, OPMS_ERR_DOMAIN, STAGE, -1, "a pose's covariance is singular");
    }
    camera->lens = calibrator->result.lens;
    std::copy(calibrator->result.covariance, calibrator->result.covariance + LENS * LENS,
              camera->covariance_intrinsics);
    camera->has_covariance_intrinsics = 1;
    Eigen::Map<RowMajor<3, 3>>(camera->detector_camera.R) = mean.transform.R;
    Eigen::Map<Vec3>(camera->detector_camera.t_m) = mean.transform.t;
    camera->has_detector_camera = 1;
    const Mat6 covariance =
        mean.own + by_shared_covariance(*calibrator, mean.by_shared);
    Eigen::Map<RowMajor<6, 6>>(camera->covariance_detector_camera) =
        0.5 * (covariance + covariance.transpose());
    camera->has_covariance_detector_camera = 1;
    return OPMS_OK;
}
