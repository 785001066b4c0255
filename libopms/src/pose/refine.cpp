// SPDX-License-Identifier: Apache-2.0
// Levenberg-Marquardt whose damping is off until a step fails; weights by Tukey. The scale starts
// at the median residual, follows it down as the fit improves, and ends at the stated sigmas.
#include "pose/refine.h"

#include <algorithm>

#include "algebra/median.h"
#include "algebra/spd.h"
#include "pose/edge_four.h"

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

WIDE_INLINE void find_residuals_lanes(const EdgeSet &set, uint32_t n, const EdgeFrame &frame,
                                      double *z)
{
    for (uint32_t i = 0; i < n; i += WIDE_DOUBLES) {
        const EdgeFour edge(set, i, n, frame);
        for (uint32_t k = 0; k < WIDE_DOUBLES && i + k < n; ++k) {
            z[i + k] = edge.z[k];
        }
    }
}

WIDE_EITHER(find_residuals,
            (const EdgeSet &set, uint32_t n, const EdgeFrame &frame, double *z),
            (set, n, frame, z))

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
    find_residuals(set, n, EdgeFrame(placement), z);
}

double robust_scale(const double *z, uint32_t n)
{
    float size[128];
    const uint32_t some = std::min<uint32_t>(n, 128);
    for (uint32_t i = 0; i < some; ++i) {
        const double most = 1e30; // what is no number is not less either
        size[i] = static_cast<float>(std::fabs(z[i]) < most ? std::fabs(z[i]) : most);
    }
    return 1.4826 * static_cast<double>(median_of(size, static_cast<int>(some)));
}

namespace
{

/* Sums over edges: of the products of the rows' elements, of these times the residuals' pull. */
struct EdgeSums {
    double products[28], slopes[7];
    double lost, nearest;
};

WIDE_INLINE void sum_edges_lanes(const EdgeSet &set, uint32_t n, const EdgeFrame &frame,
                                 double scale, Steps steps, EdgeSums &out)
{
    Four products[28], slopes[7], lost = {}, nearest = {};
    for (Four &sum : products) {
        sum = Four{};
    }
    for (Four &slope : slopes) {
        slope = Four{};
    }
    for (uint32_t i = 0; i < n; i += WIDE_DOUBLES) {
        const EdgeFour edge(set, i, n, frame);
        const Four nearer = edge.depth - wide_double_positive(edge.depth - nearest);
        nearest = i == 0 ? edge.depth : nearer;
        const Four part = edge.z * (1.0 / (TUKEY * scale));
        const Four rest = wide_double_positive(1.0 - part * part);
        const Four weight = rest * rest;
        const Four pull = weight * edge.z;
        const Four curvature = steps == Steps::Newton ? edge.curvature(scale) : weight;
        lost += 1.0 - weight * rest;
        Four row[7];
        edge.gradient(row);
        int place = 0;
        for (int a = 0; a < 7; ++a) {
            const Four weighted = curvature * row[a];
            slopes[a] += pull * row[a];
            for (int b = a; b < 7; ++b) {
                products[place++] += weighted * row[b];
            }
        }
    }
    for (int place = 0; place < 28; ++place) {
        out.products[place] = wide_double_sum(products[place]);
    }
    for (int a = 0; a < 7; ++a) {
        out.slopes[a] = wide_double_sum(slopes[a]);
    }
    out.lost = wide_double_sum(lost);
    out.nearest = std::min(std::min(nearest[0], nearest[1]), std::min(nearest[2], nearest[3]));
}

WIDE_EITHER(sum_edges,
            (const EdgeSet &set, uint32_t n, const EdgeFrame &frame, double scale, Steps steps,
             EdgeSums &out),
            (set, n, frame, scale, steps, out))

} // namespace

void normal_equations(const EdgeSet &set, uint32_t n, const Placement &placement, double scale,
                      Steps steps, Normal &normal)
{
    const EdgeFrame frame(placement);
    EdgeSums sums;
    sum_edges(set, n, frame, scale, steps, sums);
    int place = 0;
    for (int a = 0; a < 7; ++a) {
        normal.gradient[a] = sums.slopes[a];
        for (int b = a; b < 7; ++b) {
            normal.matrix(a, b) = normal.matrix(b, a) = sums.products[place++];
        }
    }
    normal.cost = TUKEY * TUKEY / 3.0 * sums.lost;
    normal.in_front = sums.nearest > 1e-9 && std::isfinite(normal.cost) &&
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
