/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Rotations, for the stages that solve (C++, Eigen). Nothing here allocates. */
#ifndef OPMS_ALGEBRA_ROTATION_H
#define OPMS_ALGEBRA_ROTATION_H

#include <cmath>

#define EIGEN_NO_MALLOC
#include <Eigen/Core>
#include <Eigen/Geometry>

#include <opms/types.h>

namespace opms::algebra
{

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

template <int Rows, int Cols>
using RowMajor = Eigen::Matrix<double, Rows, Cols, Eigen::RowMajor>;

/** [v]x, with [v]x a = v x a. */
inline Mat3 skew(const Vec3 &v)
{
    Mat3 m;
    m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
    return m;
}

/** Rotation by the vector w: its direction is the axis, its length the angle. */
inline Mat3 rotation_exp(const Vec3 &w)
{
    const double angle2 = w.squaredNorm();
    const double angle = std::sqrt(angle2);
    const bool small = angle < 1e-4;
    const double a = small ? 1.0 - angle2 / 6.0 : std::sin(angle) / angle;
    const double b = small ? 0.5 - angle2 / 24.0 : (1.0 - std::cos(angle)) / angle2;
    const Mat3 k = skew(w);
    return Mat3::Identity() + a * k + b * k * k;
}

/** The vector w with rotation_exp(w) = r, its angle at most pi. */
inline Vec3 rotation_log(const Mat3 &r)
{
    const Eigen::AngleAxisd turn(r);
    return turn.angle() * turn.axis();
}

/** The rotation next to r: rounding of many products taken off. */
inline Mat3 orthonormal(const Mat3 &r)
{
    return Eigen::Quaterniond(r).normalized().toRotationMatrix();
}

inline Mat3 rotation_of(const opms_transform_t &transform)
{
    return Eigen::Map<const RowMajor<3, 3>>(transform.R);
}

inline Vec3 translation_of(const opms_transform_t &transform)
{
    return Eigen::Map<const Vec3>(transform.t_m);
}

/** A rigid transform while it is being solved for. */
struct Rigid {
    Mat3 R;
    Vec3 t;
};

/** Apply a step to a camera's pose: it turns by `w` and the target comes nearer by `d_camera`, both
 * in the camera frame. The plane point `pivot` moves linearly in the camera
 * frame, so that a large rotation swings the camera around the target as it should, instead of
 * flying off along the tangent. */
inline Rigid swung(const Rigid &from, const Vec3 &w, const Vec3 &d_camera,
                   const Vec3 &pivot)
{
    const Vec3 seen = from.R.transpose() * (pivot - from.t);
    const Vec3 seen_then = seen + seen.cross(w) - d_camera;
    Rigid to;
    to.R = orthonormal(from.R * rotation_exp(w));
    to.t = pivot - to.R * seen_then;
    return to;
}

} // namespace opms::algebra
#endif
