// SPDX-License-Identifier: Apache-2.0
// Infinitesimal plane-based pose (Collins and Bartoli, IJCV 2014): the derivative of the view at
// one point gives the orientation up to a reflection about the line of sight. Turn the camera so
// that the point is on its axis; the derivative is then the upper left 2 x 2 block of the rotation
// over the depth. Its larger singular value is 1 over the depth, for a rotation's block has one
// singular value 1; the third row follows from the columns' length, up to its sign.
#include "pose/planar.h"

namespace opms::pose
{

namespace
{

/* Rotation that takes the z axis to the direction of v, which looks ahead (v.z > 0). Eigen's own
 * brings a singular value decomposition along for vectors that look back. */
Mat3 turn_axis_to(const Vec3 &v)
{
    const Vec3 to = v.normalized();
    const Vec3 axis(-to.y(), to.x(), 0.0); // z x v, its length the angle's sine
    const Mat3 cross = skew(axis);
    return Mat3::Identity() + cross + cross * cross / (1.0 + to.z());
}

Placement placement_of(const Mat3 &camera_from_bar, const Vec3 &point_camera, double X, double Y)
{
    Placement placement;
    placement.R = camera_from_bar.transpose();
    placement.t = Vec3(X, Y, 0.0) - placement.R * point_camera;
    placement.shift_px = 0.0;
    return placement;
}

} // namespace

Placement planar_mirror(const Placement &placement, double X, double Y)
{
    const Mat3 camera_from_bar = placement.R.transpose();
    const Vec3 point = camera_from_bar * (Vec3(X, Y, 0.0) - placement.t);
    const Vec3 sight = point.normalized();
    // Mirror the plane in the plane normal to the line of sight; its other face then looks here,
    // so turn its normal around: a rotation again.
    Mat3 mirrored = camera_from_bar - 2.0 * sight * (sight.transpose() * camera_from_bar);
    mirrored.col(2) = -mirrored.col(2);
    Placement other = placement_of(orthonormal(mirrored), point, X, Y);
    other.shift_px = placement.shift_px;
    return other;
}

bool planar_poses(const PlaneView &view, Placement poses[2])
{
    const Vec3 sight(view.ray[0], view.ray[1], 1.0);
    const Mat3 turn = turn_axis_to(sight);
    using Mat2 = Eigen::Matrix2d;
    Mat2 jac, axes;
    jac << view.jac[0], view.jac[1], view.jac[2], view.jac[3];
    axes = turn.topLeftCorner<2, 2>() - sight.head<2>() * turn.block<1, 2>(2, 0);
    const Mat2 block = axes.inverse() * jac; // upper left of the rotation over the depth
    // Facing: the printed face, whose normal is +Z, is seen where its view is a mirrored one.
    if (!(block.determinant() < 0.0)) {
        return false;
    }
    const Mat2 square = block.transpose() * block;
    const double half = 0.5 * square.trace();
    const double inverse_depth =
        std::sqrt(half + std::sqrt(std::max(0.0, half * half - square.determinant())));
    if (!(inverse_depth > 1e-9) || !std::isfinite(inverse_depth)) {
        return false;
    }
    const Mat2 upper = block / inverse_depth;
    const Mat2 rest = Mat2::Identity() - upper.transpose() * upper; // b b^T
    const double b0 = std::sqrt(std::max(0.0, rest(0, 0)));
    const double b1 = std::copysign(std::sqrt(std::max(0.0, rest(1, 1))), rest(0, 1));
    Mat3 rotation;
    rotation.col(0) << upper.col(0), b0;
    rotation.col(1) << upper.col(1), b1;
    rotation.col(2) = rotation.col(0).cross(rotation.col(1));
    poses[0] = placement_of(turn * orthonormal(rotation), sight / inverse_depth, view.centre_m[0],
                            view.centre_m[1]);
    poses[0].shift_px = view.shift_px;
    poses[1] = planar_mirror(poses[0], view.centre_m[0], view.centre_m[1]);
    return poses[0].R.allFinite() && poses[0].t.allFinite() && poses[1].R.allFinite() &&
           poses[1].t.allFinite();
}

} // namespace opms::pose
