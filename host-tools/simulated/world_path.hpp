/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How the simulated operator sweeps the detector over the bar: smooth, periodic, known exactly. */
#ifndef OPMS_SIMULATED_WORLD_PATH_HPP
#define OPMS_SIMULATED_WORLD_PATH_HPP

#include "simulate/simulate.hpp"

namespace opms_host {

struct PathPoint {
    opms::simulate::Pose ground_detector;
    cv::Vec3d velocity_m_s{0, 0, 0};     /**< of the detector's origin, ground frame */
    cv::Vec3d rotation_rad_s{0, 0, 0};   /**< ground frame */
};

/** Sweeps along the bar while the operator walks there and back. At time 0 all stands still, as it
 * does before the run. */
class DetectorPath {
public:
    DetectorPath(double duration_s, double max_speed_m_s);
    /** At a time since the run's start; repeats after the duration. */
    PathPoint at(double t_s) const;
    double duration_s() const { return duration_s_; }

private:
    double duration_s_, sweeps_, sweep_m_, scale_;
};

}  // namespace opms_host
#endif
