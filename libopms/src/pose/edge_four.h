/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Four edges side by side in the vector unit, their residuals and gradients.
 *
 * With Xc = R^T (P - t), R <- R Exp(w), t <- t + d: dXc/dw = [Xc]x and dXc/dd = -R^T. For the ray
 * (x, y) = (Xc/Zc, Yc/Zc), the residual z = c - m.(x, y) - s gain/sigma and q = m.(x, y):
 *   dz/dw = (-(my + q y), mx + q x, my x - mx y),
 *   dz/d(R^T d) = (mx, my, -q) / Zc, dz/ds = -gain/sigma. */
#ifndef OPMS_POSE_EDGE_FOUR_H
#define OPMS_POSE_EDGE_FOUR_H

#include "algebra/wide_doubles.h"
#include "pose/refine.h"

namespace opms::pose
{

/** Into functions that are compiled for several vector units. */
#define EDGE_INLINE __attribute__((always_inline)) inline

using Four = wide_double_t;

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

struct EdgeFour {
    Four mx, my, is; /**< of the set */
    Four depth, nearness, x, y, q;
    Four z; /**< residual in sigmas */

    /** Edges i to i + 3; those from n on count for nothing. */
    EDGE_INLINE EdgeFour(const EdgeSet &set, uint32_t i, uint32_t n, const EdgeFrame &frame)
        : mx(wide_double_load(set.mx + i)), my(wide_double_load(set.my + i)),
          is(wide_double_load(set.is + i))
    {
        const Four X = wide_double_load(set.X + i), Y = wide_double_load(set.Y + i);
        Four c = wide_double_load(set.c + i);
        for (uint32_t k = n - i; k < WIDE_DOUBLES; ++k) {
            mx[k] = my[k] = is[k] = c[k] = 0.0;
        }
        depth = frame.ex.z() * X + frame.ey.z() * Y + frame.origin.z();
        nearness = 1.0 / depth;
        x = (frame.ex.x() * X + frame.ey.x() * Y + frame.origin.x()) * nearness;
        y = (frame.ex.y() * X + frame.ey.y() * Y + frame.origin.y()) * nearness;
        q = mx * x + my * y;
        z = c - q - frame.shift_px * is;
    }

    /** dz/d(w, R^T d, shift) */
    EDGE_INLINE void gradient(Four row[7]) const
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
    EDGE_INLINE Four curvature(double scale) const
    {
        const Four part = z * (1.0 / (TUKEY * scale));
        const Four part2 = part * part;
        const Four rest = wide_double_positive(1.0 - part2);
        return wide_double_positive(rest * (rest - 4.0 * part2));
    }
};

} // namespace opms::pose
#endif
