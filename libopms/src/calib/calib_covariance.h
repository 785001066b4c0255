/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How well the lens and each pose are known. */
#ifndef OPMS_CALIB_CALIB_COVARIANCE_H
#define OPMS_CALIB_CALIB_COVARIANCE_H

#include "calib/calib_state.h"
#include "calib/normal_equations.h"

namespace opms::calib
{

constexpr double COVARIANCE_PIVOT_LEAST = 1e-13; // below it, equations are singular

/** Add to `total` (size x size of the equations) what a picture says of the shared unknowns, its
 * pose eliminated. Fills in the picture's information, pose_covariance and slope. */
bool add_information(Picture &picture, const PictureEquations &equations, double variance,
                     double *total);

/** Fill in calibrator.covariance and each picture's information, pose_covariance and slope, for
 * residuals whose variance is `variance` times the stated one.
 *
 * @param scale  of the residuals in stated sigmas: tells the inliers
 * @return false where the equations are singular. */
bool solve_covariance(opms_calibrator &calibrator, double scale, double variance,
                      bool with_cockle);

/** Inverse of a symmetric positive definite matrix of unlike units; false where it is singular. */
bool invert_lens_information(const Mat8 &information, Mat8 &covariance);

/** Covariance of six figures that answer to the shared unknowns by `by_shared`. */
Mat6 by_shared_covariance(const opms_calibrator &calibrator, const Mat6Shared &by_shared);

/** A picture's pose, its lens's uncertainty included; and with the lens's parameters. */
Mat6 full_pose_covariance(const opms_calibrator &calibrator, const Picture &picture);
Eigen::Matrix<double, 6, LENS> pose_lens_covariance(const opms_calibrator &calibrator,
                                                    const Picture &picture);

} // namespace opms::calib
#endif
