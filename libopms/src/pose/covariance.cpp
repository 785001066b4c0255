// SPDX-License-Identifier: Apache-2.0
// The estimate is an M-estimate: with psi(z) = w(z) z and the curvature matrix
// D = sum psi'+(z) J J^T, where psi'+ is psi' or 0 where that is negative, its
// covariance is
//   E[psi^2] E[psi'+] / E[psi']^2  D^-1,
// where the first factor is known for Gaussian noise of the stated sigmas, and is measured from the
// residuals where they are larger than stated: only as far as they are so by more than chance, for
// a few edges must not blow up an honest statement.
#include "pose/covariance.h"

#include "lens/lens_wide.h"
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
 * follows from it. */
WIDE_INLINE void intrinsics_row(const opms_lens_t &lens, const Four &x, const Four &y,
                                const Four &mx, const Four &my, Four row[8])
{
    const lens_wide_bend_t bend = lens_bend_wide(&lens, x, y);
    const Four r2 = x * x + y * y;
    const Four part = 1.0 / (bend.xx * bend.yy - bend.xy * bend.xy);
    const Four ax = (bend.yy * mx - bend.xy * my) * part; // fx n_u / sigma
    const Four ay = (bend.xx * my - bend.xy * mx) * part; // fy n_v / sigma
    const Four radial = (ax * x + ay * y) * r2;
    row[0] = ax * bend.xd * (1.0 / lens.fx_px);
    row[1] = ay * bend.yd * (1.0 / lens.fy_px);
    row[2] = ax * (1.0 / lens.fx_px);
    row[3] = ay * (1.0 / lens.fy_px);
    row[4] = radial;
    row[5] = radial * r2;
    row[6] = 2.0 * ax * x * y + ay * (r2 + 2.0 * y * y);
    row[7] = ax * (r2 + 2.0 * x * x) + 2.0 * ay * x * y;
}

using IntrinsicsSums = double[7][8];

/* Sums of psi'+ J n . d(u, v)/dk over the edges. */
WIDE_INLINE void sum_intrinsics_lanes(const EdgeSet &set, const opms_lens_t &lens,
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

WIDE_EITHER(sum_intrinsics,
            (const EdgeSet &set, const opms_lens_t &lens, const EdgeFrame &frame, double scale,
             IntrinsicsSums &out),
            (set, lens, frame, scale, out))

/* What the residuals come to. */
struct ResidualSums {
    double psi2, slopes, curvature, counted; // over the edges that count at all
    double used, used_z2, used_px2, used_w;  // over those that count by more than a half
};

WIDE_INLINE void sum_residuals_lanes(const EdgeSet &set, const double *z, double scale,
                                     ResidualSums &out)
{
    Four psi2 = {}, slopes = {}, curvature = {}, counted = {};
    Four used = {}, used_z2 = {}, used_px2 = {}, used_w = {};
    const Four one = Four{} + 1.0;
    const double per_window = 1.0 / (TUKEY * scale);
    for (uint32_t i = 0; i < set.count; i += WIDE_DOUBLES) {
        Four at = wide_double_load(z + i), sigma = wide_double_load(set.sigma_px + i);
        for (uint32_t k = set.count - i; k < WIDE_DOUBLES; ++k) {
            at[k] = TUKEY * scale; // of no weight
            sigma[k] = 0.0;
        }
        const Four part = at * per_window, part2 = part * part;
        const Four rest = wide_double_positive(1.0 - part2);
        const Four w = rest * rest, z2 = at * at;
        const wide_long_t counts = w > 0.0, uses = w > 0.5;
        const Four slope = rest * (rest - 4.0 * part2);
        psi2 += w * w * z2;
        slopes += slope;
        curvature += wide_double_positive(slope);
        counted += wide_double_where(counts, one);
        used += wide_double_where(uses, one);
        used_z2 += wide_double_where(uses, z2);
        used_px2 += wide_double_where(uses, w * z2 * sigma * sigma);
        used_w += wide_double_where(uses, w);
    }
    out = {wide_double_sum(psi2),    wide_double_sum(slopes),  wide_double_sum(curvature),
           wide_double_sum(counted), wide_double_sum(used),    wide_double_sum(used_z2),
           wide_double_sum(used_px2), wide_double_sum(used_w)};
}

WIDE_EITHER(sum_residuals,
            (const EdgeSet &set, const double *z, double scale, ResidualSums &out),
            (set, z, scale, out))

} // namespace

FitQuality fit_quality(const EdgeSet &set, const Fit &fit, const double *z)
{
    ResidualSums sums;
    sum_residuals(set, z, fit.scale, sums);
    FitQuality quality = {};
    quality.used = static_cast<uint32_t>(sums.used);
    quality.inflation = GAUSSIAN_INFLATION;
    if (quality.used > 0) {
        quality.chi2_dof = sums.used_z2 / std::max(1.0, sums.used - UNKNOWNS);
        quality.residual_px = std::sqrt(sums.used_px2 / sums.used_w);
    }
    const double freedom = sums.counted - UNKNOWNS;
    if (freedom > 0.0 && sums.slopes > 0.0) {
        const double measured = sums.psi2 * sums.curvature / (sums.slopes * sums.slopes) *
                                (sums.counted / freedom);
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
    sum_intrinsics(set, lens, frame, fit.scale, sums);
    const Mat78 step = inverse * Eigen::Map<RowMajor<7, 8>>(&sums[0][0]);
    Mat68 result;
    result.topRows<3>() = step.topRows<3>();
    result.bottomRows<3>() = fit.placement.R * step.middleRows<3>(3);
    return result;
}

} // namespace opms::pose
