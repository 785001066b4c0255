// SPDX-License-Identifier: Apache-2.0
// The homography by the normalised direct linear transform (Hartley, PAMI 1997), reweighted by
// Cauchy's weights so that a few wrong points do not turn it. Zhang's two constraints on it (the
// images of the axes are orthogonal and of one length) then give the focal length, one number a
// constraint.
#include "calib/plane_view.h"

#include <algorithm>

#include "algebra/spd.h"

namespace opms::calib
{

namespace
{

using Mat9 = Eigen::Matrix<double, 9, 9>;
using Eigen::Vector2d;

constexpr int PASSES = 6;
constexpr uint32_t SAMPLES = 256; // points whose median residual is the scale
constexpr double DEGENERATE = 1e-9; // of a pivot: another homography would fit, too

/* To the unit square's size, about the middle. */
struct Units {
    Vector2d middle;
    double size;
};

template <typename Get>
Units units_of(uint32_t count, Get get)
{
    Units units{Vector2d::Zero(), 0.0};
    for (uint32_t i = 0; i < count; ++i) {
        units.middle += get(i);
    }
    units.middle /= count;
    for (uint32_t i = 0; i < count; ++i) {
        units.size += (get(i) - units.middle).squaredNorm();
    }
    units.size = std::sqrt(units.size / count);
    return units;
}

struct Pair {
    Vector2d target, seen; // both in their units
};

Pair pair_of(const Picture &picture, uint32_t i, const Units &target, const Units &seen)
{
    const opms_calib_point_t &point = picture.points[i];
    return {(Vector2d(point.target_m[0], point.target_m[1]) - target.middle) / target.size,
            (Vector2d(point.px[0], point.px[1]) - seen.middle) / seen.size};
}

/* The two equations of a point are x (h3 . P) - h1 . P = 0 and the same with y and h2. */
void add_point(const Pair &pair, double weight, Mat9 &sum)
{
    const Vec3 P(pair.target.x(), pair.target.y(), 1.0);
    const double x = pair.seen.x(), y = pair.seen.y();
    const Mat3 moment = weight * P * P.transpose();
    sum.block<3, 3>(0, 0) += moment;
    sum.block<3, 3>(3, 3) += moment;
    sum.block<3, 3>(0, 6) -= x * moment;
    sum.block<3, 3>(3, 6) -= y * moment;
    sum.block<3, 3>(6, 6) += (x * x + y * y) * moment;
}

/* The middle of the points is in front of the camera, so the last entry may be set to 1. */
bool solve_equations(Mat9 &sum, Mat3 &homography)
{
    sum.block<3, 3>(6, 0) = sum.block<3, 3>(0, 6);
    sum.block<3, 3>(6, 3) = sum.block<3, 3>(3, 6);
    Mat8 matrix = sum.topLeftCorner<8, 8>();
    Eigen::Matrix<double, 9, 1> entries;
    entries << -sum.topRightCorner<8, 1>(), 1.0;
    if (!spd_solve_scaled(matrix.data(), 8, 0.0, DEGENERATE, entries.data())) {
        return false; // points in one line, or too few
    }
    homography = Eigen::Map<const algebra::RowMajor<3, 3>>(entries.data());
    return true;
}

double distance(const Mat3 &homography, const Pair &pair)
{
    const Vec3 image = homography * Vec3(pair.target.x(), pair.target.y(), 1.0);
    return image.z() > 0.0 ? (image.head<2>() / image.z() - pair.seen).norm() : 1e3;
}

double median_distance(const Picture &picture, const Units &target, const Units &seen,
                       const Mat3 &homography)
{
    double sizes[SAMPLES];
    const uint32_t step = std::max(1U, picture.count / SAMPLES);
    uint32_t n = 0;
    for (uint32_t i = 0; i < picture.count && n < SAMPLES; i += step) {
        sizes[n++] = distance(homography, pair_of(picture, i, target, seen));
    }
    std::nth_element(sizes, sizes + n / 2, sizes + n);
    return sizes[n / 2];
}

bool fit_pass(const Picture &picture, const Units &target, const Units &seen, bool first,
              Mat3 &homography)
{
    const double scale =
        first ? 0.0 : std::max(1e-6, 2.0 * median_distance(picture, target, seen, homography));
    Mat9 sum = Mat9::Zero();
    for (uint32_t i = 0; i < picture.count; ++i) {
        const Pair pair = pair_of(picture, i, target, seen);
        double weight = 1.0;
        if (!first) {
            const double part = distance(homography, pair) / scale;
            const double depth =
                homography.row(2).dot(Vec3(pair.target.x(), pair.target.y(), 1.0));
            weight = 1.0 / ((1.0 + part * part) * std::max(0.01, depth * depth));
        }
        add_point(pair, weight, sum);
    }
    return solve_equations(sum, homography);
}

} // namespace

bool fit_homography(const opms_calib_options_t &options, Picture &picture)
{
    const opms_calib_point_t *points = picture.points;
    const Units target = units_of(picture.count, [points](uint32_t i) {
        return Vector2d(points[i].target_m[0], points[i].target_m[1]);
    });
    const Units seen = units_of(picture.count, [points](uint32_t i) {
        return Vector2d(points[i].px[0], points[i].px[1]);
    });
    if (!(target.size > 0.0) || !(seen.size > 0.0)) {
        return false;
    }
    Mat3 fitted;
    for (int pass = 0; pass < PASSES; ++pass) {
        if (!fit_pass(picture, target, seen, pass == 0, fitted)) {
            return false;
        }
    }
    if (!(fitted.determinant() != 0.0) || !fitted.allFinite()) {
        return false;
    }
    Mat3 from_target = Mat3::Identity(), to_seen = Mat3::Identity();
    from_target.diagonal() << 1.0 / target.size, 1.0 / target.size, 1.0;
    to_seen.diagonal() << seen.size, seen.size, 1.0;
    to_seen(0, 2) = seen.middle.x() - 0.5 * (options.width_px - 1);
    to_seen(1, 2) = seen.middle.y() - 0.5 * (options.height_px - 1);
    picture.homography = to_seen * fitted * from_target;
    picture.middle = Vec3(target.middle.x(), target.middle.y(), 0.0);
    return true;
}

double focal_from_homographies(const opms_calibrator &calibrator)
{
    double aa = 0.0, ab = 0.0;
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        const Picture &picture = calibrator.pictures[k];
        if (!picture.switched_on) {
            continue;
        }
        // In units of the picture, so that each picture counts alike.
        Mat3 h = picture.homography;
        h.topRows<2>() /= calibrator.options.width_px;
        h /= h.col(0).head<2>().norm() + h.col(1).head<2>().norm();
        const Vec3 p = h.col(0), q = h.col(1);
        const double a[2] = {p.head<2>().dot(q.head<2>()),
                             p.head<2>().squaredNorm() - q.head<2>().squaredNorm()};
        const double b[2] = {p.z() * q.z(), p.z() * p.z() - q.z() * q.z()};
        for (int i = 0; i < 2; ++i) {
            aa += a[i] * a[i];
            ab += a[i] * b[i];
        }
    }
    const double inverse_square = -ab / aa;
    return inverse_square > 0.0 ? calibrator.options.width_px / std::sqrt(inverse_square) : 0.0;
}

void pose_from_homography(double focal_px, Picture &picture)
{
    Mat3 h = picture.homography;
    h.topRows<2>() /= focal_px;
    h /= 0.5 * (h.col(0).norm() + h.col(1).norm());
    Mat3 axes; // of the target in the camera, not yet orthogonal
    axes.col(0) = h.col(0);
    axes.col(1) = h.col(1);
    // Halve the departure from a right angle between both.
    const Vec3 sum = (axes.col(0) + axes.col(1)).normalized();
    const Vec3 difference = (axes.col(0) - axes.col(1)).normalized();
    axes.col(0) = (sum + difference) * std::sqrt(0.5);
    axes.col(1) = (sum - difference) * std::sqrt(0.5);
    axes.col(2) = axes.col(0).cross(axes.col(1)).normalized();
    picture.pose.R = algebra::orthonormal(axes.transpose());
    picture.pose.t = picture.middle - picture.pose.R * h.col(2);
}

} // namespace opms::calib
