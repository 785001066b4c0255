// SPDX-License-Identifier: Apache-2.0
// The estimate is an M-estimate: with psi(z) = w(z) z and A = J^T W J, its covariance is
//   E[psi^2] E[w] / E[psi']^2  A^-1,
// where the first factor is 0.965 for Gaussian noise of the stated sigmas, and is measured from the residuals where
// they are larger than stated. It is measured only as far as it differs from 0.965 by more than
// chance: a few edges must not blow up an honest statement.
#include "pose/covariance.h"

namespace opms::pose {

namespace {

constexpr double GAUSSIAN_INFLATION = 0.9652; // for TUKEY = 6 and a scale of 1
constexpr int UNKNOWNS = 7;

/* 0 below 0, 1 above 1, smooth between. */
double smooth_step(double x)
{
    const double t = std::min(1.0, std::max(0.0, x));
    return t * t * (3.0 - 2.0 * t);
}

/* Unit steps of the lens along the edge's normal, over sigma: n . d(u, v)/d(intrinsics) at a ray. The edge keeps
 * m = J^T n / sigma; n / sigma follows from it. */
void intrinsics_row(const opms_lens_t &lens, double x, double y, double mx, double my,
                    double row[8])
{
    const double r2 = x * x + y * y;
    const double gain = 1.0 + r2 * (lens.k1 + r2 * lens.k2);
    const double slope2 = 2.0 * lens.k1 + 4.0 * lens.k2 * r2;
    const double tilt = 2.0 * (lens.p1 * y + lens.p2 * x);
    const double xx = gain + slope2 * x * x + tilt + 4.0 * lens.p2 * x;
    const double xy = slope2 * x * y + 2.0 * (lens.p1 * x + lens.p2 * y);
    const double yy = gain + slope2 * y * y + tilt + 4.0 * lens.p1 * y;
    const double det = xx * yy - xy * xy;
    const double ax = (yy * mx - xy * my) / det; // n_u fx / sigma
    const double ay = (xx * my - xy * mx) / det; // n_v fy / sigma
    row[0] = ax * (x * (gain + tilt) + lens.p2 * r2) / lens.fx_px;
    row[1] = ay * (y * (gain + tilt) + lens.p1 * r2) / lens.fy_px;
    row[2] = ax / lens.fx_px;
    row[3] = ay / lens.fy_px;
    const double radial = (ax * x + ay * y) * r2;
    row[4] = radial;
    row[5] = radial * r2;
    row[6] = ax * 2.0 * x * y + ay * (r2 + 2.0 * y * y);
    row[7] = ax * (r2 + 2.0 * x * x) + ay * 2.0 * x * y;
}

} // namespace

FitQuality fit_quality(const EdgeSet &set, const Fit &fit, const double *z)
{
    double weights = 0.0, psi2 = 0.0, slopes = 0.0, counted = 0.0;
    double used_z2 = 0.0, used_px2 = 0.0, used_w = 0.0;
    FitQuality quality = {};
    for (uint32_t i = 0; i < set.count; ++i) {
        const double w = tukey_weight(z[i], fit.scale);
        if (!(w > 0.0)) {
            continue;
        }
        const double part = z[i] / (TUKEY * fit.scale);
        const double rest = 1.0 - part * part;
        counted += 1.0;
        weights += w;
        psi2 += w * w * z[i] * z[i];
        slopes += rest * (rest - 4.0 * part * part);
        if (w > 0.5) {
            const double px = z[i] / set.is[i];
            ++quality.used;
            used_z2 += z[i] * z[i];
            used_px2 += w * px * px;
            used_w += w;
        }
    }
    quality.inflation = GAUSSIAN_INFLATION;
    if (quality.used > 0) {
        quality.chi2_dof = used_z2 / std::max(1.0, static_cast<double>(quality.used) - UNKNOWNS);
        quality.residual_px = std::sqrt(used_px2 / used_w);
    }
    const double freedom = counted - UNKNOWNS;
    if (freedom > 0.0 && slopes > 0.0) {
        const double measured = psi2 * weights / (slopes * slopes) * (counted / freedom);
        const double excess = measured / GAUSSIAN_INFLATION - 1.0;
        const double chance = 2.0 * std::sqrt(2.0 / freedom);
        quality.inflation *= 1.0 + std::max(0.0, excess) * smooth_step(excess / chance);
    }
    return quality;
}

bool fit_covariance(const Fit &fit, double inflation, Mat7 &inverse, Mat6 &covariance)
{
    if (!invert_information(fit.normal.matrix, inverse)) {
        return false;
    }
    const Mat3 &R = fit.placement.R;
    covariance.topLeftCorner<3, 3>() = inflation * inverse.topLeftCorner<3, 3>();
    covariance.topRightCorner<3, 3>() = inflation * inverse.block<3, 3>(0, 3) * R.transpose();
    covariance.bottomLeftCorner<3, 3>() = covariance.topRightCorner<3, 3>().transpose();
    const Mat3 d = inflation * R * inverse.block<3, 3>(3, 3) * R.transpose();
    covariance.bottomRightCorner<3, 3>() = 0.5 * (d + d.transpose());
    return covariance.allFinite();
}

Mat68 fit_by_intrinsics(const EdgeSet &set, const opms_lens_t &lens, const Fit &fit,
                        const Mat7 &inverse)
{
    // The residual falls by n . d(u, v)/dk where an intrinsic grows; A step = J^T W n.d(u, v)/dk.
    const Mat3 into = fit.placement.R.transpose();
    const Vec3 origin = -(into * fit.placement.t);
    Mat78 moved = Mat78::Zero();
    for (uint32_t i = 0; i < set.count; ++i) {
        const Vec3 p = into.col(0) * set.X[i] + into.col(1) * set.Y[i] + origin;
        const double nearness = 1.0 / p.z();
        const double x = p.x() * nearness, y = p.y() * nearness;
        const double mx = set.mx[i], my = set.my[i];
        const double q = mx * x + my * y;
        const double z = set.c[i] - q - fit.placement.shift_px * set.is[i];
        const double weight = tukey_weight(z, fit.scale);
        if (!(weight > 0.0)) {
            continue;
        }
        Vec7 row;
        row << -(my + q * y), mx + q * x, my * x - mx * y, mx * nearness, my * nearness,
            -q * nearness, -set.is[i];
        Eigen::Matrix<double, 1, 8> by_lens;
        intrinsics_row(lens, x, y, mx, my, by_lens.data());
        moved.noalias() += (weight * row) * by_lens;
    }
    const Mat78 step = inverse * moved;
    Mat68 result;
    result.topRows<3>() = step.topRows<3>();
    result.bottomRows<3>() = fit.placement.R * step.middleRows<3>(3);
    return result;
}

} // namespace opms::pose
