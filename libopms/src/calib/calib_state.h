/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What a calibrator knows: pictures, the solution so far, and what they say about the lens. */
#ifndef OPMS_CALIB_CALIB_STATE_H
#define OPMS_CALIB_CALIB_STATE_H

#include <opms/calib.h>

#include "algebra/rotation.h"

namespace opms::calib
{

using algebra::Mat3;
using algebra::Rigid;
using algebra::Vec3;

constexpr int LENS = 8;                               // parameters of the lens
constexpr int SHARED = LENS + OPMS_CALIB_COCKLE_TERMS; // with the target's cockle

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;
using Mat8 = Eigen::Matrix<double, LENS, LENS>;
using MatShared = Eigen::Matrix<double, SHARED, SHARED>;
using Mat6Shared = Eigen::Matrix<double, 6, SHARED>;

/** One picture: its points (owned by the handle's memory block) and its part of the solution. */
struct Picture {
    opms_calib_point_t *points;
    double *residuals; // 2 a point: measured less model
    double *weights;   // robust, 0 to 1
    uint32_t count;
    bool switched_on;
    opms_calib_use_t use;
    Mat3 homography; // target (X, Y, 1), about its middle, to pixels about the picture's
    Vec3 middle;     // of the points, in the target
    Rigid pose;      // camera to target
    // After a solution:
    Mat8 information;     // about the lens, the pose eliminated
    Mat6 pose_covariance; // from the image noise alone, the shared unknowns known
    Mat6Shared slope;     // -d(w, d)/d(shared): how the pose answers to another lens
    // While it is being solved:
    Vec6 step, gradient;
    Rigid trial;
};

inline bool in_use(const Picture &picture)
{
    return picture.switched_on && picture.use == OPMS_CALIB_USED;
}

/** What all pictures share. */
struct Shape {
    opms_lens_t lens;
    double cockle[OPMS_CALIB_COCKLE_TERMS];
};

/** Move the lens's parameters, in the order of its covariance. */
inline void add_to(opms_lens_t &lens, const double *step)
{
    double *const values[LENS] = {&lens.fx_px, &lens.fy_px, &lens.cx_px, &lens.cy_px,
                                  &lens.k1,    &lens.k2,    &lens.p1,    &lens.p2};
    for (int i = 0; i < LENS; ++i) {
        *values[i] += step[i];
    }
}

} // namespace opms::calib

/** All of a handle; `pictures_max` pictures and their points follow it in memory. */
struct opms_calibrator {
    opms_calib_options_t options;
    opms::calib::Picture *pictures;
    uint32_t picture_count;
    opms::calib::Shape shape;
    double cockle_scale_m; // half the target's size; heights are of (X/s)^i (Y/s)^j
    bool solved;
    opms_calib_result_t result;
    double variance; // of the residuals, in units of the stated one, correlation included
    opms::calib::MatShared covariance; // of lens and cockle; 0 for a cockle not estimated
};

#endif
