/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Fixed-size matrices of the pose stage. Nothing here allocates. */
#ifndef OPMS_POSE_POSE_ALGEBRA_H
#define OPMS_POSE_POSE_ALGEBRA_H

#include "algebra/rotation.h"

namespace opms::pose
{

using algebra::Mat3;
using algebra::orthonormal;
using algebra::rotation_exp;
using algebra::rotation_log;
using algebra::rotation_of;
using algebra::RowMajor;
using algebra::skew;
using algebra::translation_of;
using algebra::Vec3;

using Mat6 = Eigen::Matrix<double, 6, 6>;
using Vec7 = Eigen::Matrix<double, 7, 1>;
using Mat7 = Eigen::Matrix<double, 7, 7>;
using Mat68 = Eigen::Matrix<double, 6, 8>;
using Mat78 = Eigen::Matrix<double, 7, 8>;

} // namespace opms::pose
#endif
