// SPDX-License-Identifier: Apache-2.0
#include "calib/pose_alone.h"

#include <algorithm>

#include "algebra/spd.h"
#include "calib/normal_equations.h"

namespace opms::calib
{

namespace
{

constexpr int ITERATIONS = 30;
constexpr double DAMPING_MAX = 1e6;
constexpr double SETTLED = 1e-3; // promised fall of the cost, in sigma^2
constexpr uint32_t SAMPLES = 512;

double scale_of(const opms_calibrator &calibrator, const Picture &picture)
{
    double lengths[SAMPLES];
    const uint32_t each = picture.count / SAMPLES + 1;
    const uint32_t n = residual_lengths(picture, calibrator.shape, calibrator.cockle_scale_m, 0,
                                        each, lengths, SAMPLES);
    std::nth_element(lengths, lengths + n / 2, lengths + n);
    return std::max(1.0, lengths[n / 2]);
}

bool step_of(const PictureEquations &equations, double damping, Vec6 &step)
{
    Mat6 factor = equations.pose;
    factor.diagonal() *= 1.0 + damping;
    if (!spd_factor(factor.data(), 6, SPD_PIVOT_LEAST)) {
        return false;
    }
    step = -equations.pose_gradient;
    spd_solve(factor.data(), 6, step.data());
    return step.allFinite();
}

} // namespace

void solve_pose_alone(const opms_calibrator &calibrator, Picture &picture)
{
    double damping = 1e-4;
    for (int i = 0; i < ITERATIONS && damping < DAMPING_MAX; ++i) {
        const double scale = scale_of(calibrator, picture);
        PictureEquations equations;
        equations.size = LENS;
        sum_equations(picture, calibrator.shape, picture.pose, scale, calibrator.cockle_scale_m, 1,
                      Weights::Robust, equations);
        Vec6 step;
        if (!equations.in_front || !step_of(equations, damping, step)) {
            return; // as good as the start; the joint solution says whether that fits
        }
        const Rigid trial = algebra::swung(picture.pose, step.head<3>(),
                                           picture.pose.R.transpose() * step.tail<3>(),
                                           picture.middle);
        const double cost = picture_cost(picture, calibrator.shape, trial, scale,
                                         calibrator.cockle_scale_m, 1);
        if (cost > equations.cost) {
            damping *= 8.0;
            continue;
        }
        picture.pose = trial;
        damping = std::max(1e-9, 0.1 * damping);
        if (-step.dot(equations.pose_gradient) < SETTLED) {
            return;
        }
    }
}

} // namespace opms::calib
