// SPDX-License-Identifier: Apache-2.0
// Each edge is a line l among the rays that must pass through the image of its bar point P:
// l^T H P = 0, linear in H. Two things make the almost one-dimensional bar well behaved:
//  - H maps the middle of the bar to a point in front of the camera, so with the bar's origin
//    there its last entry may be set to 1, and the depth's slope across 20 mm, which little but noise
//    shows, is held near zero by a prior; the derivative at the middle is all that is used afterwards.
//  - The line also says where the side runs to: with its direction d, l^T H d = 0. Without it sides measured
//    only at their middles would leave H open. It counts little, as the normals may be rough.
// Reweighted twice for the depth and, by Cauchy's weights, against outliers.
#include "pose/homography_start.h"

#include "pose/refine.h"

namespace opms::pose {

namespace {

using Vec8 = Eigen::Matrix<double, 8, 1>;
using Mat8 = Eigen::Matrix<double, 8, 8>;

constexpr int PASSES = 4;
constexpr double LEVER_M = 0.002;      // length over which a normal is believed
constexpr double SLOPE_PER_M = 5.0;    // usual relative change of the depth over the plane

/* Coordinates about the middle, in units of the spread, of the plane and of the rays. */
struct Units {
    double X0, Y0, plane;
    double x0, y0, ray;
};

bool choose_units(const EdgeSet &set, uint32_t n, Units &units)
{
    // A point on each line: the foot of the axis would do for the middle, but the line's normal form
    // has lost the point, so take the least-squares crossing of all lines.
    double X = 0.0, Y = 0.0, XX = 0.0;
    double axx = 0.0, axy = 0.0, ayy = 0.0, bx = 0.0, by = 0.0;
    for (uint32_t i = 0; i < n; ++i) {
        X += set.X[i];
        Y += set.Y[i];
        XX += set.X[i] * set.X[i] + set.Y[i] * set.Y[i];
        const double size2 = set.mx[i] * set.mx[i] + set.my[i] * set.my[i];
        const double w = size2 > 0.0 ? 1.0 / size2 : 0.0;
        axx += w * set.mx[i] * set.mx[i];
        axy += w * set.mx[i] * set.my[i];
        ayy += w * set.my[i] * set.my[i];
        bx += w * set.mx[i] * set.c[i];
        by += w * set.my[i] * set.c[i];
    }
    const double det = axx * ayy - axy * axy;
    units.X0 = X / n;
    units.Y0 = Y / n;
    units.plane = std::sqrt(XX / n - units.X0 * units.X0 - units.Y0 * units.Y0);
    units.x0 = (ayy * bx - axy * by) / det;
    units.y0 = (axx * by - axy * bx) / det;
    double spread = 0.0;
    for (uint32_t i = 0; i < n; ++i) {
        const double size2 = set.mx[i] * set.mx[i] + set.my[i] * set.my[i];
        const double off = set.c[i] - set.mx[i] * units.x0 - set.my[i] * units.y0;
        spread += size2 > 0.0 ? off * off / size2 : 0.0;
    }
    units.ray = std::sqrt(spread / n);
    return units.plane > 0.0 && units.ray > 0.0 && std::isfinite(units.plane) &&
           std::isfinite(units.ray);
}

/* Sum of w (l l^T) x (P P^T + d d^T): the blocks of a 9 x 9 matrix, kept as 6 x 6 unique products. */
struct Moments {
    double sum[6][6];
};

void add_edge(Moments &moments, const double l[3], double X, double Y, double dX2, double dY2,
              double weight)
{
    const double lines[6] = {weight * l[0] * l[0], weight * l[0] * l[1], weight * l[0] * l[2],
                             weight * l[1] * l[1], weight * l[1] * l[2], weight * l[2] * l[2]};
    const double points[6] = {X * X + dX2, X * Y, X, Y * Y + dY2, Y, 1.0};
    for (int a = 0; a < 6; ++a) {
        for (int b = 0; b < 6; ++b) {
            moments.sum[a][b] += lines[a] * points[b];
        }
    }
}

bool solve(const Moments &moments, double prior, Vec8 &h)
{
    static const int UNIQUE[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    Eigen::Matrix<double, 9, 9> full;
    for (int a = 0; a < 9; ++a) {
        for (int b = 0; b < 9; ++b) {
            full(a, b) = moments.sum[UNIQUE[a / 3][b / 3]][UNIQUE[a % 3][b % 3]];
        }
    }
    Mat8 matrix = full.topLeftCorner<8, 8>();
    matrix(6, 6) += prior;
    matrix(7, 7) += prior;
    const Vec8 diagonal = matrix.diagonal();
    if (!(diagonal.minCoeff() > 0.0)) {
        return false;
    }
    const Vec8 unit = diagonal.cwiseSqrt().cwiseInverse();
    Mat8 scaled = unit.asDiagonal() * matrix * unit.asDiagonal();
    scaled.diagonal().array() += 1e-13;
    const Eigen::LLT<Mat8> factor(scaled);
    if (factor.info() != Eigen::Success) {
        return false;
    }
    const Vec8 right = full.topRightCorner<8, 1>();
    h = -(unit.asDiagonal() * factor.solve(unit.asDiagonal() * right));
    return h.allFinite();
}

} // namespace

bool homography_start(const EdgeSet &set, uint32_t n, const opms_edge_t *edges, PlaneView &view)
{
    Units units;
    if (n < 8 || !choose_units(set, n, units)) {
        return false;
    }
    double z[EdgeSet::CAPACITY], depth[EdgeSet::CAPACITY];
    const double lever = LEVER_M / units.plane;
    Vec8 h;
    double scale = 0.0; // 0: no residuals yet
    for (int pass = 0; pass < PASSES; ++pass) {
        Moments moments = {};
        for (uint32_t i = 0; i < n; ++i) {
            const double l[3] = {set.mx[i] * units.ray, set.my[i] * units.ray,
                                 set.mx[i] * units.x0 + set.my[i] * units.y0 - set.c[i]};
            double weight = set.is[i] > 0.0 ? 1.0 : 0.0;
            if (scale > 0.0) {
                const double part = z[i] / (2.0 * scale);
                weight /= (1.0 + part * part) * depth[i] * depth[i];
            }
            const int side = edges[set.order[i]].side;
            const double along_x = (side & 1) ? lever * lever : 0.0;
            const double along_y = (side & 1) ? 0.0 : lever * lever;
            add_edge(moments, l, (set.X[i] - units.X0) / units.plane,
                     (set.Y[i] - units.Y0) / units.plane, along_x, along_y, weight);
        }
        const double slope = SLOPE_PER_M * units.plane;
        if (!solve(moments, 1.0 / (slope * slope), h)) {
            return false;
        }
        for (uint32_t i = 0; i < n && pass + 1 < PASSES; ++i) {
            const double X = (set.X[i] - units.X0) / units.plane;
            const double Y = (set.Y[i] - units.Y0) / units.plane;
            const double lx = set.mx[i] * units.ray, ly = set.my[i] * units.ray;
            const double lc = set.mx[i] * units.x0 + set.my[i] * units.y0 - set.c[i];
            depth[i] = std::max(0.1, 1.0 + h[6] * X + h[7] * Y);
            z[i] = (lx * (h[0] * X + h[1] * Y + h[2]) + ly * (h[3] * X + h[4] * Y + h[5])) /
                       depth[i] + lc;
        }
        scale = pass + 1 < PASSES ? robust_scale(z, n) : scale;
    }
    view.centre_m[0] = units.X0;
    view.centre_m[1] = units.Y0;
    view.ray[0] = units.x0 + units.ray * h[2];
    view.ray[1] = units.y0 + units.ray * h[5];
    const double per_metre = units.ray / units.plane;
    view.jac[0] = (h[0] - h[2] * h[6]) * per_metre;
    view.jac[1] = (h[1] - h[2] * h[7]) * per_metre;
    view.jac[2] = (h[3] - h[5] * h[6]) * per_metre;
    view.jac[3] = (h[4] - h[5] * h[7]) * per_metre;
    return true;
}

} // namespace opms::pose
