/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A pose in the numbers that other programs want: quaternion, angles, sigmas. */
#ifndef OPMS_EXPORTING_POSE_VALUES_HPP
#define OPMS_EXPORTING_POSE_VALUES_HPP

#include <array>

#include <opms/locate.h>

namespace opms_host {

/** Of unit length, w not negative. */
struct Quaternion {
    double x = 0, y = 0, z = 0, w = 1;
};

Quaternion quaternion_from_matrix(const double R[9]);
void quaternion_to_matrix(const Quaternion &q, double R[9]);
/** From @p a (0) to @p b (1) at constant rate, the shorter way. */
Quaternion quaternion_between(const Quaternion &a, const Quaternion &b, double part);

/** psi, phi, theta in degrees: R = Rz(psi) Ry(phi) Rx(theta). */
std::array<double, 3> angles_deg_from_matrix(const double R[9]);

/** Angle in degrees of the rotation from @p a to @p b; exact for small ones, too. */
double angle_between_deg(const double a[9], const double b[9]);
/** Distance in mm. */
double distance_mm(const double a_m[3], const double b_m[3]);

/** The pose that a located picture is about: the detector's in the ground frame where the camera
 * file knows where the camera sits, else the camera's in the bar's frame. */
const opms_pose_t &pose_of(const opms_location_t &location);

/** Standard deviations of a pose: along X, Y, Z; about the moving body's own x, y, z. */
struct PoseSigmas {
    std::array<double, 3> position_mm{}, rotation_deg{};
};

PoseSigmas pose_sigmas(const opms_pose_t &pose);

}  // namespace opms_host
#endif
