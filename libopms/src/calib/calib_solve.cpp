// SPDX-License-Identifier: Apache-2.0
// Levenberg-Marquardt. The poses touch only their own pictures, so their blocks are eliminated one
// by one and what is left to solve has the size of the shared unknowns, whatever the number of
// pictures (Schur's complement; Triggs et al., Bundle adjustment - a modern synthesis, 2000).
// The robust scale starts at the median residual and follows it down as the fit improves.
#include "calib/calib_solve.h"

#include <algorithm>
#include <cmath>

#include "algebra/spd.h"
#include "calib/calib_priors.h"
#include "calib/normal_equations.h"

namespace opms::calib
{

namespace
{

constexpr double RAYLEIGH_MEDIAN = 1.1774; // of the length of two unit normal coordinates
constexpr double DAMPING_START = 1e-4;
constexpr double DAMPING_MAX = 1e8;
constexpr double CONVERGED = 1e-4; // promised fall of the cost, in sigma^2
constexpr double ROUNDING = 1e-2;  // the same, where the step did no good
constexpr uint32_t SAMPLES = 4096;

constexpr double PIVOT_LEAST = 1e-15;

/* Equations of the shared unknowns alone, packed like those of a picture. */
struct SharedEquations {
    double matrix[SHARED * SHARED];
    double gradient[SHARED];     // the poses eliminated
    double own_gradient[SHARED]; // with the poses as they are
};

void add_priors(const opms_calibrator &calibrator, int size, SharedEquations &shared)
{
    for (int i = 0; i < size; ++i) {
        const Prior prior = prior_of(calibrator, calibrator.shape, i);
        if (prior.sigma > 0.0) {
            const double weight = 1.0 / (prior.sigma * prior.sigma);
            shared.matrix[i * size + i] += weight;
            shared.gradient[i] += weight * prior.off;
            shared.own_gradient[i] += weight * prior.off;
        }
    }
}

double prior_cost(const opms_calibrator &calibrator, const Shape &shape, int size)
{
    double cost = 0.0;
    for (int i = 0; i < size; ++i) {
        const Prior prior = prior_of(calibrator, shape, i);
        if (prior.sigma > 0.0) {
            cost += prior.off * prior.off / (prior.sigma * prior.sigma);
        }
    }
    return cost;
}

/* Take the pose of a picture out of the equations of the shared unknowns. */
bool eliminate(const PictureEquations &equations, double damping, Picture &picture,
               SharedEquations &shared)
{
    const int size = equations.size;
    Mat6 factor = equations.pose;
    factor.diagonal() *= 1.0 + damping;
    if (!spd_factor(factor.data(), 6, SPD_PIVOT_LEAST)) {
        return false;
    }
    picture.gradient = picture.step = equations.pose_gradient;
    spd_solve(factor.data(), 6, picture.step.data());
    for (int j = 0; j < size; ++j) {
        const Eigen::Map<const Vec6> coupling(equations.coupling + 6 * j);
        picture.slope.col(j) = coupling;
        spd_solve(factor.data(), 6, picture.slope.col(j).data());
        shared.own_gradient[j] += equations.shared_gradient[j];
        shared.gradient[j] += equations.shared_gradient[j] - coupling.dot(picture.step);
        for (int i = 0; i < size; ++i) {
            const Eigen::Map<const Vec6> other(equations.coupling + 6 * i);
            shared.matrix[i * size + j] +=
                equations.shared[i * size + j] - other.dot(picture.slope.col(j));
        }
    }
    return picture.slope.leftCols(size).allFinite();
}

Shape moved(const Shape &from, const double *step, int size)
{
    Shape to = from;
    add_to(to.lens, step);
    for (int k = LENS; k < size; ++k) {
        to.cockle[k - LENS] += step[k];
    }
    return to;
}

Rigid moved(const Picture &picture, const Vec6 &step)
{
    return algebra::swung(picture.pose, step.head<3>(),
                          picture.pose.R.transpose() * step.tail<3>(), picture.middle);
}

class Solver
{
public:
    Solver(opms_calibrator &calibrator, const SolvePlan &plan)
        : calibrator_(calibrator), plan_(plan), size_(plan.with_cockle ? SHARED : LENS),
          cockle_scale_m_(plan.with_cockle ? calibrator.cockle_scale_m : 0.0)
    {
    }

    SolveEnd run()
    {
        SolveEnd end{HUGE_VAL, residual_scale(calibrator_, plan_.stride), 0, false};
        end.cost = cost_of_trial(calibrator_.shape, end.scale, true);
        double damping = DAMPING_START, before = 0.0;
        while (end.iterations < plan_.iterations_max && damping < DAMPING_MAX &&
               !end.converged) {
            ++end.iterations;
            double promised = 0.0;
            if (!iterate(end, damping, promised)) {
                // Less than rounding shows is no reason to go on.
                end.converged = promised > 0.0 && promised < ROUNDING;
                damping *= 8.0;
                continue;
            }
            const bool settled = left_after(promised, before) < CONVERGED && damping < 1e-2;
            before = promised;
            damping = std::max(1e-9, 0.1 * damping);
            end.converged = !follow_scale(end) && settled;
        }
        return end;
    }

private:
    /* What a step leaves to gain: steps shrink by the same part each time, or faster, and a tenth
     * of what may be left is for the doubt. The first step tells nothing of that. */
    static double left_after(double promised, double before)
    {
        return promised < before ? std::min(promised, 10.0 * promised * promised / before)
                                 : promised;
    }

    /* Better fits show smaller residuals: follow them down. */
    bool follow_scale(SolveEnd &end)
    {
        const double scale = residual_scale(calibrator_, plan_.stride);
        if (!(scale < 0.95 * end.scale)) {
            return false;
        }
        end.scale = scale;
        end.cost = cost_of_trial(calibrator_.shape, scale, true);
        return true;
    }

    /* Robust cost of a shape with the trial poses, or with those that hold. */
    double cost_of_trial(const Shape &shape, double scale, bool as_they_are) const
    {
        double cost = 0.0;
        for (uint32_t k = 0; k < calibrator_.picture_count; ++k) {
            const Picture &picture = calibrator_.pictures[k];
            if (in_use(picture)) {
                cost += picture_cost(picture, shape, as_they_are ? picture.pose : picture.trial,
                                     scale, cockle_scale_m_, plan_.stride);
            }
        }
        return cost + prior_cost(calibrator_, shape, size_);
    }

    bool sum_up(double scale, double damping, SharedEquations &shared)
    {
        shared = {};
        for (uint32_t k = 0; k < calibrator_.picture_count; ++k) {
            Picture &picture = calibrator_.pictures[k];
            if (!in_use(picture)) {
                continue;
            }
            PictureEquations equations;
            equations.size = size_;
            sum_equations(picture, calibrator_.shape, picture.pose, scale, cockle_scale_m_,
                          plan_.stride, Weights::Robust, equations);
            if (!equations.in_front || !eliminate(equations, damping, picture, shared)) {
                return false;
            }
        }
        add_priors(calibrator_, size_, shared);
        for (int i = 0; i < size_; ++i) {
            shared.matrix[i * size_ + i] *= 1.0 + damping;
        }
        return true;
    }

    /* One step; false where it made the fit worse and was not taken. */
    bool iterate(SolveEnd &end, double damping, double &promised)
    {
        SharedEquations shared;
        double step[SHARED];
        if (!sum_up(end.scale, damping, shared)) {
            return false;
        }
        for (int i = 0; i < size_; ++i) {
            step[i] = -shared.gradient[i];
        }
        if (!spd_solve_scaled(shared.matrix, size_, 0.0, PIVOT_LEAST, step)) {
            return false;
        }
        promised = 0.0;
        for (int i = 0; i < size_; ++i) {
            promised -= step[i] * shared.own_gradient[i];
        }
        for (uint32_t k = 0; k < calibrator_.picture_count; ++k) {
            Picture &picture = calibrator_.pictures[k];
            if (in_use(picture)) {
                Vec6 pose_step = -picture.step;
                for (int i = 0; i < size_; ++i) {
                    pose_step -= picture.slope.col(i) * step[i];
                }
                promised -= pose_step.dot(picture.gradient);
                picture.trial = moved(picture, pose_step);
            }
        }
        const Shape shape = moved(calibrator_.shape, step, size_);
        const double cost = cost_of_trial(shape, end.scale, false);
        if (!(cost <= end.cost + 1e-9 * (1.0 + end.cost)) || !(shape.lens.fx_px > 0.0) ||
            !(shape.lens.fy_px > 0.0)) {
            return false;
        }
        take_trial(shape);
        end.cost = cost;
        return true;
    }

    void take_trial(const Shape &shape)
    {
        calibrator_.shape = shape;
        for (uint32_t k = 0; k < calibrator_.picture_count; ++k) {
            if (in_use(calibrator_.pictures[k])) {
                calibrator_.pictures[k].pose = calibrator_.pictures[k].trial;
            }
        }
    }

    opms_calibrator &calibrator_;
    const SolvePlan &plan_;
    const int size_; // of the shared unknowns
    const double cockle_scale_m_;
};

} // namespace

SolveEnd solve_jointly(opms_calibrator &calibrator, const SolvePlan &plan)
{
    return Solver(calibrator, plan).run();
}

double residual_scale(const opms_calibrator &calibrator, uint32_t stride)
{
    double lengths[SAMPLES];
    uint32_t points = 0, n = 0;
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        points += in_use(calibrator.pictures[k]) ? calibrator.pictures[k].count : 0;
    }
    const uint32_t each = std::max(stride, points / SAMPLES + 1);
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        const Picture &picture = calibrator.pictures[k];
        if (in_use(picture)) {
            n += residual_lengths(picture, calibrator.shape, calibrator.cockle_scale_m, k % each,
                                  each, lengths + n, SAMPLES - n);
        }
    }
    if (n == 0) {
        return 1.0;
    }
    std::nth_element(lengths, lengths + n / 2, lengths + n);
    return std::max(1e-3, lengths[n / 2] / RAYLEIGH_MEDIAN);
}

} // namespace opms::calib
