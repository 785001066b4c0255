/* SPDX-License-Identifier: Apache-2.0 */
#include "world_path.hpp"

#include <algorithm>
#include <cmath>

namespace opms_host {

namespace sim = opms::simulate;

namespace {

constexpr double SWEEP_MAX_M = 0.32; /* to each side */

/** A value and how fast it changes. */
struct Moving {
    double value, rate;
};

/** One more than that of the other sweep, so that both halves of the path differ. */
Moving operator+(const Moving &a, const Moving &b)
{
    return {a.value + b.value, a.rate + b.rate};
}

/** a (1 - cos(n w t)) / 2: begins at 0, at rest. */
Moving swing(double a, double n, double w, double t)
{
    return {a * (1 - std::cos(n * w * t)) / 2, a * n * w * std::sin(n * w * t) / 2};
}

/** a sin^3(n w t): begins at 0, at rest, and makes the way back another one than the way there. */
Moving lean(double a, double n, double w, double t)
{
    const double s = std::sin(n * w * t), c = std::cos(n * w * t);
    return {a * s * s * s, 3 * a * n * w * s * s * c};
}

cv::Matx33d about(int axis, double angle)
{
    cv::Vec3d w(0, 0, 0);
    w[axis] = angle;
    return sim::rotation(w);
}

}  // namespace

DetectorPath::DetectorPath(double duration_s, double max_speed_m_s) : duration_s_(duration_s)
{
    // Forward motion and height take some of the speed, so the sweep gets 95 % of it.
    const double reach_m = 0.95 * max_speed_m_s * duration_s / (2 * sim::PI);
    sweeps_ = std::max(1.0, std::floor(reach_m / SWEEP_MAX_M));
    sweep_m_ = std::min(SWEEP_MAX_M, reach_m / sweeps_);
    scale_ = sweep_m_ / SWEEP_MAX_M;
}

PathPoint DetectorPath::at(double t_s) const
{
    const double w = 2 * sim::PI / duration_s_, t = std::fmod(t_s, duration_s_);
    const Moving y = Moving{-sweep_m_, 0} + swing(2 * sweep_m_, sweeps_, w, t);
    const double s = scale_;
    const Moving x = Moving{0.44, 0} + swing(-0.18 * s, 1, w, t) + lean(0.02 * s, 1, w, t);
    const Moving z = Moving{0.02, 0} + swing(0.10 * s, 1, w, t) + lean(0.015 * s, 1, w, t);
    const double deg = sim::RAD * scale_;
    const Moving psi = swing(6 * deg, sweeps_, w, t) + lean(2 * deg, 1, w, t);
    const Moving phi = swing(4 * deg, 1, w, t) + lean(-2 * deg, 1, w, t);
    const Moving theta = swing(-5 * deg, sweeps_, w, t) + lean(1.5 * deg, 1, w, t);
    const cv::Matx33d rz = about(2, psi.value), rzy = rz * about(1, phi.value);
    PathPoint point;
    point.ground_detector.R = rzy * about(0, theta.value);
    point.ground_detector.t = {x.value, y.value, z.value};
    point.velocity_m_s = {x.rate, y.rate, z.rate};
    point.rotation_rad_s = cv::Vec3d(0, 0, psi.rate) + rz * cv::Vec3d(0, phi.rate, 0) +
                           rzy * cv::Vec3d(theta.rate, 0, 0);
    return point;
}

}  // namespace opms_host
