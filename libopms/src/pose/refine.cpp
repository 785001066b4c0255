// SPDX-License-Identifier: Apache-2.0
// Levenberg-Marquardt whose damping is off until a step fails; weights by Tukey. The scale starts
// at the median residual, follows it down as the fit improves, and ends at the stated sigmas.
//
// With Xc = R^T (P - t), R <- R Exp(w), t <- t + d: dXc/dw = [Xc]x and dXc/dd = -R^T. For the ray
// (x, y) = (Xc/Zc, Yc/Zc) and the residual z = c - m.(x, y) - s/sigma, with q = m.(x, y):
//   dz/dw = (-(my + q y), mx + q x, my x - mx y), dz/d(R^T d) = (mx, my, -q) / Zc, dz/ds = -1/sigma.
#include "pose/refine.h"

#include <algorithm>

namespace opms::pose {

namespace {

using Pair = Eigen::Array2d; // two edges side by side in one vector register

constexpr double CONVERGED = 1e-7; // chi2 that the last step promised
constexpr double DAMPING_MAX = 1e8;

struct Frame {
    Vec3 ex, ey, origin; // bar axes and origin in the camera frame
};

Frame frame_of(const Placement &placement)
{
    Frame f;
    f.ex = placement.R.row(0);
    f.ey = placement.R.row(1);
    f.origin = -(placement.R.transpose() * placement.t);
    return f;
}

inline Pair load(const double *column)
{
    return Eigen::Map<const Pair, Eigen::Aligned16>(column);
}

/* Solves the damped equations; false where they are singular. */
bool solve_step(const Normal &normal, double damping, Vec7 &step)
{
    const Vec7 diagonal = normal.matrix.diagonal();
    if (!(diagonal.minCoeff() > 0.0)) {
        return false;
    }
    const Vec7 units = diagonal.cwiseSqrt().cwiseInverse();
    Mat7 scaled = units.asDiagonal() * normal.matrix * units.asDiagonal();
    scaled.diagonal().array() += damping + 1e-14;
    const Eigen::LLT<Mat7> factor(scaled);
    if (factor.info() != Eigen::Success) {
        return false;
    }
    step = -(units.asDiagonal() * factor.solve(units.asDiagonal() * normal.gradient));
    return step.allFinite();
}

/* The bar point `pivot` moves linearly in the camera frame, so that a large rotation swings the
 * camera around the bar as it should, instead of flying off along the tangent. */
Placement moved(const Placement &from, const Vec7 &step, const Vec3 &pivot)
{
    const Vec3 w = step.head<3>();
    const Vec3 seen = from.R.transpose() * (pivot - from.t);
    const Vec3 seen_then = seen + seen.cross(w) - step.segment<3>(3);
    Placement to;
    to.R = orthonormal(from.R * rotation_exp(w));
    to.t = pivot - to.R * seen_then;
    to.shift_px = from.shift_px + step[6];
    return to;
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

/* A better fit shows smaller residuals: follow them down. */
void follow_scale(const EdgeSet &set, uint32_t n, Fit &fit)
{
    if (fit.scale <= 1.0) {
        return;
    }
    double z[128];
    const uint32_t some = std::min<uint32_t>(n, 128);
    residuals(set, some, fit.placement, z);
    const double scale = robust_scale(z, some);
    if (scale < 0.9 * fit.scale) {
        fit.scale = scale;
        normal_equations(set, n, fit.placement, scale, fit.normal);
        fit.converged = false;
    }
}

} // namespace

void residuals(const EdgeSet &set, uint32_t n, const Placement &placement, double *z)
{
    const Frame f = frame_of(placement);
    for (uint32_t i = 0; i < n; ++i) {
        const Vec3 p = f.ex * set.X[i] + f.ey * set.Y[i] + f.origin;
        z[i] = set.c[i] - (set.mx[i] * p.x() + set.my[i] * p.y()) / p.z() -
               placement.shift_px * set.is[i];
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
    return std::max(1.0, 1.4826 * size[some / 2]);
}

void normal_equations(const EdgeSet &set, uint32_t n, const Placement &placement, double scale,
                      Normal &normal)
{
    const Frame f = frame_of(placement);
    const double narrow = 1.0 / (TUKEY * scale);
    Pair sums[28], slopes[7], lost(0.0, 0.0), nearest(1e300, 1e300);
    for (Pair &sum : sums) {
        sum.setZero();
    }
    for (Pair &slope : slopes) {
        slope.setZero();
    }
    for (uint32_t i = 0; i < n; i += 2) {
        const Pair X = load(set.X + i), Y = load(set.Y + i);
        Pair mx = load(set.mx + i), my = load(set.my + i), is = load(set.is + i);
        Pair c = load(set.c + i);
        if (i + 1 == n) { // the edge behind the last one is none of ours
            mx[1] = my[1] = is[1] = c[1] = 0.0;
        }
        const Pair depth = f.ex.z() * X + f.ey.z() * Y + f.origin.z();
        nearest = nearest.min(depth);
        const Pair nearness = depth.inverse();
        const Pair x = (f.ex.x() * X + f.ey.x() * Y + f.origin.x()) * nearness;
        const Pair y = (f.ex.y() * X + f.ey.y() * Y + f.origin.y()) * nearness;
        const Pair q = mx * x + my * y;
        const Pair z = c - q - placement.shift_px * is;
        const Pair part = z * narrow;
        const Pair rest = (1.0 - part * part).max(Pair::Zero());
        const Pair weight = rest * rest;
        lost += 1.0 - weight * rest;
        const Pair row[7] = {-(my + q * y), mx + q * x,     my * x - mx * y, mx * nearness,
                             my * nearness, -q * nearness, -is};
        int place = 0;
        for (int a = 0; a < 7; ++a) {
            const Pair weighted = weight * row[a];
            slopes[a] += weighted * z;
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
    const Vec7 diagonal = matrix.diagonal();
    if (!(diagonal.minCoeff() > 0.0)) {
        return false;
    }
    const Vec7 units = diagonal.cwiseSqrt().cwiseInverse();
    const Eigen::LDLT<Mat7> factor(units.asDiagonal() * matrix * units.asDiagonal());
    // The pivots of a correlation matrix are the parts of each unknown that the others leave open.
    if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 1e-11)) {
        return false;
    }
    inverse = units.asDiagonal() * factor.solve(Mat7::Identity()) * units.asDiagonal();
    inverse = (0.5 * (inverse + inverse.transpose())).eval();
    return inverse.allFinite();
}

void refine(const EdgeSet &set, uint32_t n, int iterations_max, Fit &fit)
{
    double z[128];
    const uint32_t some = std::min<uint32_t>(n, 128);
    residuals(set, some, fit.placement, z);
    fit.scale = robust_scale(z, some);
    fit.converged = false;
    normal_equations(set, n, fit.placement, fit.scale, fit.normal);
    const Vec3 pivot = middle_of(set, n);
    double damping = 0.0;
    for (int i = 0; i < iterations_max && fit.normal.in_front && !fit.converged; ++i) {
        Vec7 step;
        Fit trial = fit;
        bool better = false;
        if (solve_step(fit.normal, damping, step)) {
            trial.placement = moved(fit.placement, step, pivot);
            normal_equations(set, n, trial.placement, trial.scale, trial.normal);
            better = trial.normal.in_front && trial.normal.cost <= fit.normal.cost + CONVERGED;
        }
        if (better) {
            const double promised = -step.dot(fit.normal.gradient);
            trial.converged = promised < CONVERGED * fit.scale * fit.scale;
            fit = trial;
            damping = damping > 1e-5 ? 0.1 * damping : 0.0;
            follow_scale(set, n, fit);
        } else {
            damping = std::max(1e-3, 10.0 * damping);
            if (damping > DAMPING_MAX) {
                break;
            }
        }
    }
}

} // namespace opms::pose
