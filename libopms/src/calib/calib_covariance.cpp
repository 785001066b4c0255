// SPDX-License-Identifier: Apache-2.0
// The inverse of the joint information by the same elimination as the solution's: first the poses,
// then the shared unknowns; a pose's own covariance is that with the shared ones known, plus what
// their uncertainty does to it.
#include "calib/calib_covariance.h"

#include "algebra/spd.h"
#include "calib/calib_priors.h"
#include "calib/normal_equations.h"

namespace opms::calib
{

namespace
{

void add_priors(const opms_calibrator &calibrator, int size, double *total)
{
    for (int i = 0; i < size; ++i) {
        const Prior prior = prior_of(calibrator, calibrator.shape, i);
        total[i * size + i] += prior.sigma > 0.0 ? 1.0 / (prior.sigma * prior.sigma) : 0.0;
    }
}

} // namespace

bool add_information(Picture &picture, const PictureEquations &equations, double variance,
                     double *total)
{
    Mat6 inverse = equations.pose;
    if (!spd_invert(inverse.data(), 6, COVARIANCE_PIVOT_LEAST)) {
        return false;
    }
    const int size = equations.size;
    picture.pose_covariance = variance * inverse;
    picture.slope.setZero();
    for (int j = 0; j < size; ++j) {
        picture.slope.col(j) = inverse * Eigen::Map<const Vec6>(equations.coupling + 6 * j);
    }
    for (int i = 0; i < size; ++i) {
        const Eigen::Map<const Vec6> coupling(equations.coupling + 6 * i);
        for (int j = 0; j < size; ++j) {
            const double information =
                (equations.shared[i * size + j] - coupling.dot(picture.slope.col(j))) / variance;
            total[i * size + j] += information;
            if (i < LENS && j < LENS) {
                picture.information(i, j) = information;
            }
        }
    }
    return true;
}

bool invert_lens_information(const Mat8 &information, Mat8 &covariance)
{
    covariance = information;
    return spd_invert(covariance.data(), LENS, COVARIANCE_PIVOT_LEAST) != 0;
}

bool solve_covariance(opms_calibrator &calibrator, double scale, double variance, bool with_cockle)
{
    double total[SHARED * SHARED] = {};
    PictureEquations equations;
    equations.size = with_cockle ? SHARED : LENS;
    const int size = equations.size;
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        Picture &picture = calibrator.pictures[k];
        if (!in_use(picture)) {
            continue;
        }
        sum_equations(picture, calibrator.shape, picture.pose, scale,
                      with_cockle ? calibrator.cockle_scale_m : 0.0, 1, Weights::Inliers,
                      equations);
        if (!add_information(picture, equations, variance, total)) {
            return false;
        }
    }
    add_priors(calibrator, size, total);
    if (!spd_invert(total, size, COVARIANCE_PIVOT_LEAST)) {
        return false;
    }
    calibrator.covariance.setZero();
    for (int i = 0; i < size; ++i) {
        for (int j = 0; j < size; ++j) {
            calibrator.covariance(i, j) = total[i * size + j];
        }
    }
    return true;
}

Mat6 by_shared_covariance(const opms_calibrator &calibrator, const Mat6Shared &by_shared)
{
    const Mat6Shared product = by_shared.lazyProduct(calibrator.covariance);
    return product.lazyProduct(by_shared.transpose());
}

Mat6 full_pose_covariance(const opms_calibrator &calibrator, const Picture &picture)
{
    return picture.pose_covariance + by_shared_covariance(calibrator, picture.slope);
}

Eigen::Matrix<double, 6, LENS> pose_lens_covariance(const opms_calibrator &calibrator,
                                                    const Picture &picture)
{
    return -picture.slope.lazyProduct(calibrator.covariance.leftCols<LENS>());
}

} // namespace opms::calib
