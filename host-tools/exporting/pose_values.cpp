/* SPDX-License-Identifier: Apache-2.0 */
#include "pose_values.hpp"

#include <algorithm>
#include <cmath>

namespace opms_host {

namespace {

constexpr double DEG = 180 / 3.14159265358979323846;

Quaternion normalised(Quaternion q)
{
    const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    const double scale = (q.w < 0 ? -1 : 1) / length;
    return {q.x * scale, q.y * scale, q.z * scale, q.w * scale};
}

}  // namespace

/* Four times the products of the components stand in the sums and differences of R's elements; the
 * largest component is taken from the diagonal, so that nothing small divides. */
Quaternion quaternion_from_matrix(const double R[9])
{
    const double xx = 1 + R[0] - R[4] - R[8], yy = 1 - R[0] + R[4] - R[8];
    const double zz = 1 - R[0] - R[4] + R[8], ww = 1 + R[0] + R[4] + R[8];
    const double xy = R[1] + R[3], xz = R[2] + R[6], yz = R[5] + R[7];
    const double xw = R[7] - R[5], yw = R[2] - R[6], zw = R[3] - R[1];
    const double largest = std::max({xx, yy, zz, ww});
    if (largest == ww) {
        return normalised({xw, yw, zw, ww});
    }
    if (largest == xx) {
        return normalised({xx, xy, xz, xw});
    }
    if (largest == yy) {
        return normalised({xy, yy, yz, yw});
    }
    return normalised({xz, yz, zz, zw});
}

void quaternion_to_matrix(const Quaternion &q, double R[9])
{
    const double values[9] = {
        1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y - q.z * q.w), 2 * (q.x * q.z + q.y * q.w),
        2 * (q.x * q.y + q.z * q.w), 1 - 2 * (q.x * q.x + q.z * q.z), 2 * (q.y * q.z - q.x * q.w),
        2 * (q.x * q.z - q.y * q.w), 2 * (q.y * q.z + q.x * q.w), 1 - 2 * (q.x * q.x + q.y * q.y)};
    std::copy(values, values + 9, R);
}

Quaternion quaternion_between(const Quaternion &a, const Quaternion &b, double part)
{
    const double cosine = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
    const double sign = cosine < 0 ? -1 : 1;
    /* The angle from the chord: exact where the cosine is next to 1. */
    const double chord = std::sqrt(
        (a.x - sign * b.x) * (a.x - sign * b.x) + (a.y - sign * b.y) * (a.y - sign * b.y) +
        (a.z - sign * b.z) * (a.z - sign * b.z) + (a.w - sign * b.w) * (a.w - sign * b.w));
    const double angle = 2 * std::asin(std::min(1.0, chord / 2));
    const double sine = std::sin(angle);
    const double of_a = sine < 1e-9 ? 1 - part : std::sin((1 - part) * angle) / sine;
    const double of_b = sign * (sine < 1e-9 ? part : std::sin(part * angle) / sine);
    return normalised({of_a * a.x + of_b * b.x, of_a * a.y + of_b * b.y, of_a * a.z + of_b * b.z,
                       of_a * a.w + of_b * b.w});
}

std::array<double, 3> angles_deg_from_matrix(const double R[9])
{
    return {DEG * std::atan2(R[3], R[0]), DEG * std::atan2(-R[6], std::hypot(R[7], R[8])),
            DEG * std::atan2(R[7], R[8])};
}

double angle_between_deg(const double a[9], const double b[9])
{
    double m[9];
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++) {
            m[3 * r + c] = a[r] * b[c] + a[3 + r] * b[3 + c] + a[6 + r] * b[6 + c];
        }
    }
    const double x = m[7] - m[5], y = m[2] - m[6], z = m[3] - m[1];
    return DEG * std::atan2(std::sqrt(x * x + y * y + z * z), m[0] + m[4] + m[8] - 1);
}

double distance_mm(const double a_m[3], const double b_m[3])
{
    return 1e3 * std::hypot(a_m[0] - b_m[0], a_m[1] - b_m[1], a_m[2] - b_m[2]);
}

const opms_pose_t &pose_of(const opms_location_t &location)
{
    return location.has_ground_detector ? location.ground_detector : location.pose.bar_camera;
}

PoseSigmas pose_sigmas(const opms_pose_t &pose)
{
    PoseSigmas sigmas;
    for (std::size_t i = 0; i < 3; i++) {
        sigmas.rotation_deg[i] = DEG * std::sqrt(pose.covariance[7 * i]);
        sigmas.position_mm[i] = 1e3 * std::sqrt(pose.covariance[7 * (3 + i)]);
    }
    return sigmas;
}

}  // namespace opms_host
