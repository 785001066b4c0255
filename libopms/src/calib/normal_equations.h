/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Normal equations of a calibration, picture by picture: shared unknowns (lens, cockle) and pose.
 */
#ifndef OPMS_CALIB_NORMAL_EQUATIONS_H
#define OPMS_CALIB_NORMAL_EQUATIONS_H

#include "calib/calib_state.h"

namespace opms::calib
{

constexpr double TUKEY = 6.0; // of sigma: 98 % efficient for points, which have two coordinates

/** Equations of one picture with `size` shared unknowns: LENS, those of the lens, or SHARED, the
 * cockle's after them. Matrices are symmetric or column-major and packed: element (i, j) of
 * `shared` is at i * size + j, (pose i, shared j) of `coupling` at j * 6 + i. */
struct PictureEquations {
    int size;
    double shared[SHARED * SHARED];
    double coupling[6 * SHARED];
    Mat6 pose;
    double shared_gradient[SHARED];
    Vec6 pose_gradient;
    double cost;   // robust, in units of sigma^2
    bool in_front; // every point is before the camera and finite
};

/** How the points count. */
enum class Weights {
    Robust,  // by Tukey
    Inliers  // 1 for an inlier, else 0: for the covariance
};

constexpr double INLIER_WEIGHT = 0.25; // of Tukey: 4.2 sigmas
/** Mean square of two unit normal coordinates that are inliers, over 2: the tail is cut. */
constexpr double INLIER_VARIANCE = 0.999;

/** Sum up the equations of a picture's points, each `stride`-th of them.
 *
 * @param scale     standard deviation of the residuals in units of the stated sigmas
 * @param cockle_scale_m  of the cockle's terms; not looked at for size LENS
 * @param equations  its size says for how many shared unknowns */
void sum_equations(const Picture &picture, const Shape &shape, const Rigid &pose, double scale,
                   double cockle_scale_m, uint32_t stride, Weights weights,
                   PictureEquations &equations);

/** Robust cost alone. */
double picture_cost(const Picture &picture, const Shape &shape, const Rigid &pose, double scale,
                    double cockle_scale_m, uint32_t stride);

/** Residuals (measured less model), and Tukey's weights, of all points of a picture. */
void picture_residuals(const Picture &picture, const Shape &shape, double scale,
                       double cockle_scale_m, double *residuals, double *weights);

/** Lengths of the residuals, in the stated sigmas, of the points first, first + each, ...
 * @return how many were written, at most `room`. */
uint32_t residual_lengths(const Picture &picture, const Shape &shape, double cockle_scale_m,
                          uint32_t first, uint32_t each, double *lengths, uint32_t room);

/** Height of the target at a point: the cockle. */
double target_height(const Shape &shape, double cockle_scale_m, double X, double Y);

} // namespace opms::calib
#endif
