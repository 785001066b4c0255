// SPDX-License-Identifier: Apache-2.0
// The estimate is an M-estimate: with psi(z) = w(z) z and the curvature matrix
// D = sum psi'+(z) J J^T, where psi'+ is psi' or 0 where that is negative, its
// covariance is
//   E[psi^2] E[psi'+] / E[psi']^2  D^-1,
// where the first factor is known for Gaussian noise of the stated sigmas, and is measured from the
// residuals where they are larger than stated: only as far as they are so by more than chance, for
// a few edges must not blow up an honest statement.
#include "pose/covariance.h"

#include "pose/edge_four.h"

namespace opms::pose
{

namespace
{

constexpr double GAUSSIAN_INFLATION = 0.8626; // for TUKEY = 6 and a scale of 1
constexpr int UNKNOWNS = 7;

/* 0 below 0, 1 above 1, smooth between. */
double smooth_step(double x)
{
    const double t = std::min(1.0, std::max(0.0, x));
    return t * t * (3.0 - 2.0 * t);
}

/* n . d(u, v)/d(intrinsics) / sigma at the rays (x, y). An edge keeps m = J^T n / sigma; n / sigma
 * follows from it, J being that of lens_bend(). */
WIDE_INLINE void intrinsics_row(const opms_lens_t &lens, const Four &x, const Four &y,
                                const Four &mx, const Four &my, Four row[8])
{
    const Four r2 = x * x + y * y;
    const Four gain = 1.0 + r2 * (lens.k1 + r2 * lens.k2) + 2.0 * (lens.p1 * y + lens.p2 * x);
    const Four slope2 = 2.0 * lens.k1 + 4.0 * lens.k2 * r2;
    const Four xx = gain + slope2 * x * x + 4.0 * lens.p2 * x;
    const Four xy = slope2 * x * y + 2.0 * (lens.p1 * x + lens.p2 * y);
    const Four yy = gain + slope2 * y * y + 4.0 * lens.p1 * y;
    const Four part = 1.0 / (xx * yy - xy * xy);
    const Four ax = (yy * mx - xy * my) * part; // fx n_u / sigma
    const Four ay = (xx * my - xy * mx) * part; // fy n_v / sigma
    const Four radial = (ax * x + ay * y) * r2;
    row[0] = ax * (x * gain + lens.p2 * r2) * (1.0 / lens.fx_px);
    row[1] = ay * (y * gain + lens.p1 * r2) * (1.0 / lens.fy_px);
    row[2] = ax * (1.0 / lens.fx_px);
    row[3] = ay * (1.0 / lens.fy_px);
    row[4] = radial;
    row[5] = radial * r2;
    row[6] = 2.0 * ax * x * y + ay * (r2 + 2.0 * y * y);
    row[7] = ax * (r2 + 2.0 * x * x) + 2.0 * ay * x * y;
}

using IntrinsicsSums = double[7][8];

/* Sums of psi'+ J n . d(u, v)/dk over the edges. */
WIDE_INLINE void sum_intrinsics(const EdgeSet &set, const opms_lens_t &lens,
                                const EdgeFrame &frame, double scale, IntrinsicsSums &out)
{
    Four sums[7][8];
    for (auto &line : sums) {
        for (Four &sum : line) {
            sum = Four{};
        }
    }
    for (uint32_t i = 0; i < set.count; i += WIDE_DOUBLES) {
        const EdgeFour edge(set, i, set.count, frame);
        Four by_lens[8];
        intrinsics_row(lens, edge.x, edge.y, edge.mx, edge.my, by_lens);
        Four row[7];
        edge.gradient(row);
        const Four curvature = edge.curvature(scale);
        for (int a = 0; a < 7; ++a) {
            const Four weighted = curvature * row[a];
            for (int b = 0; b < 8; ++b) {
                sums[a][b] += weighted * by_lens[b];
            }
        }
    }
    for (int a = 0; a < 7; ++a) {
        for (int b = 0; b < 8; ++b) {
            out[a][b] = wide_double_sum(sums[a][b]);
        }
    }
}

WIDE_AVX2 void sum_intrinsics_avx2(const EdgeSet &set, const opms_lens_t &lens,
                                   const EdgeFrame &frame, double scale, IntrinsicsSums &out)
{
    sum_intrinsics(set, lens, frame, scale, out);
}

} // namespace

FitQuality fit_quality(const EdgeSet &set, const Fit &fit, const double *z)
{
    double psi2 = 0.0, slopes = 0.0, curvature = 0.0, counted = 0.0;
    double used_z2 = 0.0, used_px2 = 0.0, used_w = 0.0;
    FitQuality quality = {};
    for (uint32_t i = 0; i < set.count; ++i) {
        const double w = tukey_weight(z[i], fit.scale);
        if (!(w > 0.0)) {
            continue;
        }
        counted += 1.0;
        psi2 += w * w * z[i] * z[i];
        const double part = z[i] / (TUKEY * fit.scale);
        const double rest = 1.0 - part * part;
        const double slope = rest * (rest - 4.0 * part * part);
        slopes += slope;
        curvature += std::max(0.0, slope);
        if (w > 0.5) {
            const double px = z[i] * set.sigma_px[i];
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
        const double measured = psi2 * curvature / (slopes * slopes) * (counted / freedom);
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
    // Where an intrinsic k grows, the residual falls by n . d(u, v)/dk; so
    // D step = sum psi'+ J n . d(u, v)/dk.
    IntrinsicsSums sums;
    const EdgeFrame frame(fit.placement);
    if (wide_has_avx2()) {
        sum_intrinsics_avx2(set, lens, frame, fit.scale, sums);
    } else {
        sum_intrinsics(set, lens, frame, fit.scale, sums);
    }
    const Mat78 step = inverse * Eigen::Map<RowMajor<7, 8>>(&sums[0][0]);
    Mat68 result;
    result.topRows<3>() = step.topRows<3>();
    result.bottomRows<3>() = fit.placement.R * step.middleRows<3>(3);
    return result;
}

} // namespace opms::pose
