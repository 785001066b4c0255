// SPDX-License-Identifier: Apache-2.0
// Levenberg-Marquardt whose damping is off until a step fails; weights by Tukey. The scale starts
// at the median residual, follows it down as the fit improves, and ends at the stated sigmas.
#include "pose/refine.h"

#include <algorithm>

#include "algebra/spd.h"
#include "pose/edge_pair.h"

namespace opms::pose
{

namespace
{

constexpr double ROUNDING = 1e-7;    // chi2 by which a good step may seem to be worse
constexpr double DAMPING_MIN = 1e-5; // of a unit diagonal: acts on the weakest direction alone
constexpr double DAMPING_MAX = 1e6;

/* Solves the damped equations; false where they are singular. */
bool solve_step(const Normal &normal, double damping, Vec7 &step)
{
    Mat7 matrix = normal.matrix;
    step = -normal.gradient;
    return spd_solve_scaled(matrix.data(), 7, damping + 1e-14, SPD_PIVOT_LEAST, step.data()) != 0;
}

Placement moved(const Placement &from, const Vec7 &step, const Vec3 &pivot)
{
    const algebra::Rigid to =
        algebra::swung({from.R, from.t}, step.head<3>(), step.segment<3>(3), pivot);
    return {to.R, to.t, from.shift_px + step[6]};
}

Vec3 middle_of(const EdgeSet &set, uint32_t n)
{
    Vec3 sum = Vec3::Zero();
    for (uint32_t i = 0; i < n; ++i) {
        sum.x() += set.X[i];
        sum.y() += set.Y[i];
    }
    return sum / n;
}

/* The scale that the residuals ask for, at least the stated one. */
double scale_at(const EdgeSet &set, uint32_t n, const RefinePlan &plan, const Placement &placement)
{
    double z[128];
    const uint32_t some = std::min<uint32_t>(n, 128);
    residuals(set, some, placement, z);
    return std::max(1.0, plan.window * robust_scale(z, some));
}

/* A better fit shows smaller residuals: follow them down. */
void follow_scale(const EdgeSet &set, uint32_t n, const RefinePlan &plan, Fit &fit)
{
    if (fit.scale <= 1.0) {
        return;
    }
    const double scale = scale_at(set, n, plan, fit.placement);
    if (scale < 0.9 * fit.scale) {
        fit.scale = scale;
        normal_equations(set, n, fit.placement, scale, plan.steps, fit.normal);
        fit.converged = false;
    }
}

} // namespace

void residuals(const EdgeSet &set, uint32_t n, const Placement &placement, double *z)
{
    const EdgeFrame frame(placement);
    for (uint32_t i = 0; i < n; i += 2) {
        const EdgePair edge(set, i, n, frame);
        z[i] = edge.z[0];
        if (i + 1 < n) {
            z[i + 1] = edge.z[1];
        }
    }
}

double robust_scale(const double *z, uint32_t n)
{
    double size[128];
    const uint32_t some = std::min<uint32_t>(n, 128);
    for (uint32_t i = 0; i < some; ++i) {
        size[i] = std::isfinite(z[i]) ? std::fabs(z[i]) : 1e300;
    }
    std::nth_element(size, size + some / 2, size + some);
    return 1.4826 * size[some / 2];
}

void normal_equations(const EdgeSet &set, uint32_t n, const Placement &placement, double scale,
                      Steps steps, Normal &normal)
{
    const EdgeFrame frame(placement);
    Pair sums[28], slopes[7], lost(0.0, 0.0), nearest(1e300, 1e300);
    for (Pair &sum : sums) {
        sum.setZero();
    }
    for (Pair &slope : slopes) {
        slope.setZero();
    }
    for (uint32_t i = 0; i < n; i += 2) {
        const EdgePair edge(set, i, n, frame);
        nearest = nearest.min(edge.depth);
        const Pair part = edge.z * (1.0 / (TUKEY * scale));
        const Pair rest = (1.0 - part * part).max(Pair::Zero());
        const Pair weight = rest * rest;
        const Pair pull = weight * edge.z;
        const Pair curvature = steps == Steps::Newton ? edge.curvature(scale) : weight;
        lost += 1.0 - weight * rest;
        Pair row[7];
        edge.gradient(row);
        int place = 0;
        for (int a = 0; a < 7; ++a) {
            const Pair weighted = curvature * row[a];
            slopes[a] += pull * row[a];
            for (int b = a; b < 7; ++b) {
                sums[place++] += weighted * row[b];
            }
        }
    }
    int place = 0;
    for (int a = 0; a < 7; ++a) {
        normal.gradient[a] = slopes[a].sum();
        for (int b = a; b < 7; ++b) {
            normal.matrix(a, b) = normal.matrix(b, a) = sums[place++].sum();
        }
    }
    normal.cost = TUKEY * TUKEY / 3.0 * lost.sum();
    normal.in_front = nearest.minCoeff() > 1e-9 && std::isfinite(normal.cost) &&
                      normal.matrix.allFinite() && normal.gradient.allFinite();
}

bool invert_information(const Mat7 &matrix, Mat7 &inverse)
{
    // The pivots of a correlation matrix are the parts of each unknown that the others leave open.
    inverse = matrix;
    return spd_invert(inverse.data(), 7, 1e-11) != 0;
}

void refine(const EdgeSet &set, uint32_t n, const RefinePlan &plan, Fit &fit)
{
    fit.scale = scale_at(set, n, plan, fit.placement);
    fit.converged = false;
    normal_equations(set, n, fit.placement, fit.scale, plan.steps, fit.normal);
    const Vec3 pivot = middle_of(set, n);
    double damping = 0.0;
    for (int i = 0; i < plan.iterations_max && fit.normal.in_front && !fit.converged; ++i) {
        Vec7 step;
        bool better = false;
        if (solve_step(fit.normal, damping, step)) {
            Fit trial;
            trial.placement = moved(fit.placement, step, pivot);
            trial.scale = fit.scale;
            const double promised = -step.dot(fit.normal.gradient) / (fit.scale * fit.scale);
            if (promised < plan.tolerance && damping == 0.0) {
                fit.placement = trial.placement;
                fit.converged = true;
                follow_scale(set, n, plan, fit);
                continue;
            }
            normal_equations(set, n, trial.placement, trial.scale, plan.steps, trial.normal);
            better = trial.normal.in_front && trial.normal.cost <= fit.normal.cost + ROUNDING;
            if (better) {
                trial.converged = false;
                fit = trial;
            }
        }
        if (better) {
            damping = damping > DAMPING_MIN ? 0.3 * damping : 0.0;
            follow_scale(set, n, plan, fit);
        } else {
            damping = std::max(DAMPING_MIN, 10.0 * damping);
            if (damping > DAMPING_MAX) {
                break;
            }
        }
    }
}

} // namespace opms::pose
