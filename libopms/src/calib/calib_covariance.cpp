// SPDX-License-Identifier: Apache-2.0
// The inverse of the joint information by the same elimination as the solution's: first the poses,
// then the shared unknowns; a pose's own covariance is that with the shared ones known, plus what
// their uncertainty does to it.
#include "calib/calib_covariance.h"

#include <Eigen/Cholesky>

#include "calib/calib_priors.h"
#include "calib/normal_equations.h"

namespace opms::calib
{

namespace
{

template <int N>
bool invert(const Eigen::Matrix<double, N, N> &matrix, Eigen::Matrix<double, N, N> &inverse)
{
    using Square = Eigen::Matrix<double, N, N>;
    using Vector = Eigen::Matrix<double, N, 1>;
    const Vector diagonal = matrix.diagonal();
    if (!(diagonal.minCoeff() > 0.0)) {
        return false;
    }
    // Pixels, radians and metres differ by orders: compare in units of the diagonal.
    const Vector units = diagonal.cwiseSqrt().cwiseInverse();
    const Square scaled = units.asDiagonal() * matrix * units.asDiagonal();
    const Eigen::LDLT<Square> factor(scaled);
    if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 1e-13)) {
        return false;
    }
    const Square solved = factor.solve(Square::Identity());
    inverse = units.asDiagonal() * (0.5 * (solved + solved.transpose())) * units.asDiagonal();
    return inverse.allFinite();
}

template <int S>
bool add_picture(Picture &picture, const PictureEquations<S> &equations, double variance,
                 Eigen::Matrix<double, S, S> &total)
{
    Mat6 inverse;
    if (!invert<6>(equations.pose, inverse)) {
        return false;
    }
    const Eigen::Matrix<double, 6, S> slope = inverse * equations.coupling.transpose();
    const Eigen::Matrix<double, S, S> information =
        equations.shared - equations.coupling * slope;
    total += information / variance;
    picture.information = information.template topLeftCorner<LENS, LENS>() / variance;
    picture.pose_covariance = variance * inverse;
    picture.slope.setZero();
    picture.slope.template leftCols<S>() = slope;
    return true;
}

template <int S>
bool solve(opms_calibrator &calibrator, double scale, double variance, double cockle_scale_m)
{
    using Square = Eigen::Matrix<double, S, S>;
    Square total = Square::Zero(), covariance;
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        Picture &picture = calibrator.pictures[k];
        if (!in_use(picture)) {
            continue;
        }
        PictureEquations<S> equations;
        sum_equations<S>(picture, calibrator.shape, picture.pose, scale, cockle_scale_m, 1,
                         Weights::Inliers, equations);
        if (!add_picture<S>(picture, equations, variance, total)) {
            return false;
        }
    }
    for (int i = 0; i < S; ++i) {
        const Prior prior = prior_of(calibrator, calibrator.shape, i);
        total(i, i) += prior.sigma > 0.0 ? 1.0 / (prior.sigma * prior.sigma) : 0.0;
    }
    if (!invert<S>(total, covariance)) {
        return false;
    }
    calibrator.covariance.setZero();
    calibrator.covariance.topLeftCorner<S, S>() = covariance;
    return true;
}

} // namespace

bool invert_lens_information(const Mat8 &information, Mat8 &covariance)
{
    return invert<LENS>(information, covariance);
}

bool solve_covariance(opms_calibrator &calibrator, double scale, double variance, bool with_cockle)
{
    return with_cockle ? solve<SHARED>(calibrator, scale, variance, calibrator.cockle_scale_m)
                       : solve<LENS>(calibrator, scale, variance, 0.0);
}

Mat6 full_pose_covariance(const opms_calibrator &calibrator, const Picture &picture)
{
    return picture.pose_covariance +
           picture.slope * calibrator.covariance * picture.slope.transpose();
}

Eigen::Matrix<double, 6, LENS> pose_lens_covariance(const opms_calibrator &calibrator,
                                                    const Picture &picture)
{
    return -(picture.slope * calibrator.covariance.leftCols<LENS>());
}

} // namespace opms::calib
