// SPDX-License-Identifier: Apache-2.0
// Levenberg-Marquardt. The poses touch only their own pictures, so their blocks are eliminated one
// by one and what is left to solve has the size of the shared unknowns, whatever the number of
// pictures (Schur's complement; Triggs et al., Bundle adjustment - a modern synthesis, 2000).
// The robust scale starts at the median residual and follows it down as the fit improves.
#include "calib/calib_solve.h"

#include <Eigen/Cholesky>

#include <algorithm>

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

template <int S>
using SharedVec = Eigen::Matrix<double, S, 1>;
template <int S>
using SharedMat = Eigen::Matrix<double, S, S>;

void add_to(opms_lens_t &lens, const double *step)
{
    double *const values[LENS] = {&lens.fx_px, &lens.fy_px, &lens.cx_px, &lens.cy_px,
                                  &lens.k1,    &lens.k2,    &lens.p1,    &lens.p2};
    for (int i = 0; i < LENS; ++i) {
        *values[i] += step[i];
    }
}

template <int S>
void add_priors(const opms_calibrator &calibrator, const Shape &shape, SharedMat<S> &matrix,
                SharedVec<S> &gradient)
{
    for (int i = 0; i < S; ++i) {
        const Prior prior = prior_of(calibrator, shape, i);
        if (prior.sigma > 0.0) {
            matrix(i, i) += 1.0 / (prior.sigma * prior.sigma);
            gradient[i] += prior.off / (prior.sigma * prior.sigma);
        }
    }
}

template <int S>
double prior_cost(const opms_calibrator &calibrator, const Shape &shape)
{
    double cost = 0.0;
    for (int i = 0; i < S; ++i) {
        const Prior prior = prior_of(calibrator, shape, i);
        if (prior.sigma > 0.0) {
            cost += prior.off * prior.off / (prior.sigma * prior.sigma);
        }
    }
    return cost;
}

/* Take the pose of a picture out of the equations of the shared unknowns. */
template <int S>
bool eliminate(const PictureEquations<S> &equations, double damping, Picture &picture,
               SharedMat<S> &matrix, SharedVec<S> &gradient)
{
    Mat6 pose = equations.pose;
    const Vec6 diagonal = pose.diagonal();
    if (!(diagonal.minCoeff() > 0.0)) {
        return false;
    }
    pose.diagonal() += damping * diagonal;
    const Eigen::LLT<Mat6> factor(pose);
    if (factor.info() != Eigen::Success) {
        return false;
    }
    picture.slope.template leftCols<S>() = factor.solve(equations.coupling.transpose());
    picture.step = factor.solve(equations.pose_gradient);
    picture.gradient = equations.pose_gradient;
    matrix.noalias() +=
        equations.shared - equations.coupling * picture.slope.template leftCols<S>();
    gradient.noalias() += equations.shared_gradient - equations.coupling * picture.step;
    return picture.slope.template leftCols<S>().allFinite();
}

template <int S>
bool solve_shared(const SharedMat<S> &matrix, const SharedVec<S> &gradient, SharedVec<S> &step)
{
    const SharedVec<S> diagonal = matrix.diagonal();
    if (!(diagonal.minCoeff() > 0.0)) {
        return false;
    }
    const SharedVec<S> units = diagonal.cwiseSqrt().cwiseInverse();
    const SharedMat<S> scaled = units.asDiagonal() * matrix * units.asDiagonal();
    const Eigen::LDLT<SharedMat<S>> factor(scaled);
    if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 1e-15)) {
        return false;
    }
    step = -(units.asDiagonal() * factor.solve(units.asDiagonal() * gradient));
    return step.allFinite();
}

template <int S>
Shape moved(const Shape &from, const SharedVec<S> &step)
{
    Shape to = from;
    add_to(to.lens, step.data());
    for (int k = LENS; k < S; ++k) {
        to.cockle[k - LENS] += step[k];
    }
    return to;
}

Rigid moved(const Picture &picture, const Vec6 &step)
{
    return algebra::swung(picture.pose, step.head<3>(), step.tail<3>(), picture.middle);
}

template <int S>
class Solver
{
public:
    Solver(opms_calibrator &calibrator, const SolvePlan &plan)
        : calibrator_(calibrator), plan_(plan),
          cockle_scale_m_(S > LENS ? calibrator.cockle_scale_m : 0.0)
    {
    }

    SolveEnd run()
    {
        SolveEnd end{HUGE_VAL, residual_scale(calibrator_, plan_.stride), 0, false};
        end.cost = cost_of_trial(calibrator_.shape, end.scale, true);
        double damping = DAMPING_START;
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
            const bool settled = promised < CONVERGED && damping < 1e-2;
            damping = std::max(1e-9, 0.1 * damping);
            end.converged = !follow_scale(end) && settled;
        }
        return end;
    }

private:
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
        return cost + prior_cost<S>(calibrator_, shape);
    }

    bool sum_up(double scale, double damping, SharedMat<S> &matrix, SharedVec<S> &gradient,
                SharedVec<S> &shared_gradient)
    {
        matrix.setZero();
        gradient.setZero();
        shared_gradient.setZero();
        for (uint32_t k = 0; k < calibrator_.picture_count; ++k) {
            Picture &picture = calibrator_.pictures[k];
            if (!in_use(picture)) {
                continue;
            }
            PictureEquations<S> equations;
            sum_equations<S>(picture, calibrator_.shape, picture.pose, scale, cockle_scale_m_,
                             plan_.stride, Weights::Robust, equations);
            shared_gradient += equations.shared_gradient;
            if (!equations.in_front ||
                !eliminate<S>(equations, damping, picture, matrix, gradient)) {
                return false;
            }
        }
        SharedVec<S> pull = SharedVec<S>::Zero();
        add_priors<S>(calibrator_, calibrator_.shape, matrix, pull);
        gradient += pull;
        shared_gradient += pull;
        matrix.diagonal() *= 1.0 + damping;
        return true;
    }

    /* One step; false where it made the fit worse and was not taken. */
    bool iterate(SolveEnd &end, double damping, double &promised)
    {
        SharedMat<S> matrix;
        SharedVec<S> gradient, shared_gradient, step;
        if (!sum_up(end.scale, damping, matrix, gradient, shared_gradient) ||
            !solve_shared<S>(matrix, gradient, step)) {
            return false;
        }
        promised = -step.dot(shared_gradient);
        for (uint32_t k = 0; k < calibrator_.picture_count; ++k) {
            Picture &picture = calibrator_.pictures[k];
            if (in_use(picture)) {
                const Vec6 pose_step =
                    -(picture.step + picture.slope.template leftCols<S>() * step);
                promised -= pose_step.dot(picture.gradient);
                picture.trial = moved(picture, pose_step);
            }
        }
        const Shape shape = moved<S>(calibrator_.shape, step);
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
    const double cockle_scale_m_;
};

} // namespace

SolveEnd solve_jointly(opms_calibrator &calibrator, const SolvePlan &plan)
{
    return plan.with_cockle ? Solver<SHARED>(calibrator, plan).run()
                            : Solver<LENS>(calibrator, plan).run();
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
