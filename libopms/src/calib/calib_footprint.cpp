// SPDX-License-Identifier: Apache-2.0
// Camera to detector, from pictures taken while the head stood at known places on the target. Each
// gives one transform; their weighted mean is the answer. The lens is common to all of them, so
// its part of the uncertainty does not average out and is carried through the mean.
#include <opms/calib.h>

#include <cmath>

#include "algebra/spd.h"
#include "base/fail.h"
#include "calib/calib_covariance.h"
#include "calib/calib_sight.h"

#define STAGE "calib"

using namespace opms::calib;
using opms::algebra::RowMajor;

namespace
{

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
        OPMS_TRY(check_placing(footprint, i, err));
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
        Mat6 weight = placing_covariance(picture(i), footprints[i], sight);
        if (!spd_invert(weight.data(), 6, SPD_PIVOT_LEAST)) {
            return false;
        }
        total += weight;
        pull += weight * rigid_difference(mean.transform, sight.detector_camera);
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
    Eigen::Map<RowMajor<6, LENS>>(camera->covariance_detector_camera_intrinsics) =
        mean.by_shared.lazyProduct(calibrator->covariance.leftCols<LENS>());
    camera->has_covariance_detector_camera_intrinsics = 1;
    return OPMS_OK;
}
