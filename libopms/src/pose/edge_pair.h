/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Two edges side by side in one vector register, their residuals and gradients.
 *
 * With Xc = R^T (P - t), R <- R Exp(w), t <- t + d: dXc/dw = [Xc]x and dXc/dd = -R^T. For the ray
 * (x, y) = (Xc/Zc, Yc/Zc), the residual z = c - m.(x, y) - s gain/sigma and q = m.(x, y):
 *   dz/dw = (-(my + q y), mx + q x, my x - mx y),
 *   dz/d(R^T d) = (mx, my, -q) / Zc, dz/ds = -gain/sigma. */
#ifndef OPMS_POSE_EDGE_PAIR_H
#define OPMS_POSE_EDGE_PAIR_H

#include "pose/refine.h"

namespace opms::pose
{

using Pair = Eigen::Array2d;

/** Bar axes and origin in the camera frame. */
struct EdgeFrame {
    Vec3 ex, ey, origin;
    double shift_px;

    explicit EdgeFrame(const Placement &placement)
        : ex(placement.R.row(0)), ey(placement.R.row(1)),
          origin(-(placement.R.transpose() * placement.t)), shift_px(placement.shift_px)
    {
    }
};

struct EdgePair {
    Pair mx, my, is; /**< of the set */
    Pair depth, nearness, x, y, q;
    Pair z; /**< residual in sigmas */

    /** Edges i and i + 1 of the first n; where i + 1 is n, the second counts for nothing. */
    EdgePair(const EdgeSet &set, uint32_t i, uint32_t n, const EdgeFrame &frame)
        : mx(load(set.mx + i)), my(load(set.my + i)), is(load(set.is + i))
    {
        const Pair X = load(set.X + i), Y = load(set.Y + i);
        Pair c = load(set.c + i);
        if (i + 1 == n) {
            mx[1] = my[1] = is[1] = c[1] = 0.0;
        }
        depth = frame.ex.z() * X + frame.ey.z() * Y + frame.origin.z();
        nearness = depth.inverse();
        x = (frame.ex.x() * X + frame.ey.x() * Y + frame.origin.x()) * nearness;
        y = (frame.ex.y() * X + frame.ey.y() * Y + frame.origin.y()) * nearness;
        q = mx * x + my * y;
        z = c - q - frame.shift_px * is;
    }

    /** dz/d(w, R^T d, shift) */
    void gradient(Pair row[7]) const
    {
        row[0] = -(my + q * y);
        row[1] = mx + q * x;
        row[2] = my * x - mx * y;
        row[3] = mx * nearness;
        row[4] = my * nearness;
        row[5] = -q * nearness;
        row[6] = -is;
    }

    /** Slope of Tukey's weight times residual, not below 0: its part in the cost's curvature. */
    Pair curvature(double scale) const
    {
        const Pair part = z * (1.0 / (TUKEY * scale));
        const Pair part2 = part * part;
        const Pair rest = (1.0 - part2).max(Pair::Zero());
        return (rest * (rest - 4.0 * part2)).max(Pair::Zero());
    }

  private:
    static Pair load(const double *column)
    {
        return Eigen::Map<const Pair, Eigen::Aligned16>(column);
    }
};

} // namespace opms::pose
#endif
