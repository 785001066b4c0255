// SPDX-License-Identifier: Apache-2.0
// Each edge is a line l among the rays that must pass through the image of its bar point P:
// l^T H P = 0, linear in H. Three things make the almost one-dimensional bar well behaved:
//  - H maps the middle of the bar to a point in front of the camera, so with the bar's origin
//    there its last entry may be set to 1, and the depth's slope across 20 mm, which little but
//    noise shows, is held near zero by a prior; the derivative at the middle is all that is used
//    afterwards.
//  - The common shift of the edges is one more unknown: left out, it makes the squares too small
//    and the view of a level bar a slanted one.
//  - The line also says where the side runs to: with its direction d, l^T H d = 0. Without it sides
//    measured only at their middles would leave H open. It counts little, as the normals may be
//    rough.
// Reweighted for the depth and, by Cauchy's weights, against outliers.
#include "pose/homography_start.h"

#include <algorithm>

#include "algebra/spd.h"
#include "pose/refine.h"

namespace opms::pose
{

namespace
{

using Vec9 = Eigen::Matrix<double, 9, 1>; // H row by row without its last entry; the shift in px
using Mat9 = Eigen::Matrix<double, 9, 9>;

constexpr int PASSES_MIN = 3;
constexpr int PASSES_MAX = 10;
constexpr double SCALE_GOOD = 1.5;  // outliers have lost their pull
constexpr double LEVER_M = 0.002;   // length over which a normal is believed
constexpr double SLOPE_PER_M = 5.0; // usual relative change of the depth over the plane

/* Coordinates about the middle, in units of the spread, of the plane and of the rays. */
struct Units {
    double X0, Y0, plane;
    double x0, y0, ray;
};

bool choose_units(const EdgeSet &set, uint32_t n, Units &units)
{
    // The lines have lost their points; the middle of the rays is the point nearest to all lines.
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

/* One edge in those units: the line l, the bar point, its side's direction, and what the shift
 * does. */
struct Row {
    double l[3];
    double X, Y;
    bool along_x;
    double shift;
};

Row row_of(const EdgeSet &set, uint32_t i, const opms_edge_t *edges, const Units &units)
{
    Row row;
    row.l[0] = set.mx[i] * units.ray;
    row.l[1] = set.my[i] * units.ray;
    row.l[2] = set.mx[i] * units.x0 + set.my[i] * units.y0 - set.c[i];
    row.X = (set.X[i] - units.X0) / units.plane;
    row.Y = (set.Y[i] - units.Y0) / units.plane;
    row.along_x = (edges[set.order[i]].side & 1) != 0;
    row.shift = set.is[i];
    return row;
}

/* Sum of w (l l^T) x (P P^T + d d^T), kept as the 6 x 6 products of its unique entries, and of the
 * products with the shift's column. */
struct Moments {
    double sum[6][6];
    double shift[9];
    double shift2;
};

void add_edge(Moments &moments, const Row &row, double lever2, double depth, double weight)
{
    const double *l = row.l;
    const double lines[6] = {weight * l[0] * l[0], weight * l[0] * l[1], weight * l[0] * l[2],
                             weight * l[1] * l[1], weight * l[1] * l[2], weight * l[2] * l[2]};
    const double points[6] = {row.X * row.X + (row.along_x ? lever2 : 0.0), row.X * row.Y, row.X,
                              row.Y * row.Y + (row.along_x ? 0.0 : lever2), row.Y,         1.0};
    for (int a = 0; a < 6; ++a) {
        for (int b = 0; b < 6; ++b) {
            moments.sum[a][b] += lines[a] * points[b];
        }
    }
    const double shift = depth * row.shift;
    const double weighted = weight * shift;
    for (int a = 0; a < 3; ++a) {
        moments.shift[3 * a] += weighted * l[a] * row.X;
        moments.shift[3 * a + 1] += weighted * l[a] * row.Y;
        moments.shift[3 * a + 2] += weighted * l[a];
    }
    moments.shift2 += weighted * shift;
}

/* `slope`: the usual size of the depth's slopes. */
bool solve(const Moments &moments, double slope, Vec9 &h)
{
    static const int UNIQUE[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    Mat9 matrix;
    Vec9 right;
    for (int a = 0; a < 8; ++a) {
        for (int b = 0; b < 8; ++b) {
            matrix(a, b) = moments.sum[UNIQUE[a / 3][b / 3]][UNIQUE[a % 3][b % 3]];
        }
        matrix(a, 8) = matrix(8, a) = moments.shift[a];
        right[a] = moments.sum[UNIQUE[a / 3][2]][UNIQUE[a % 3][2]];
    }
    matrix(8, 8) = moments.shift2;
    right[8] = moments.shift[8];
    matrix(6, 6) += 1.0 / (slope * slope);
    matrix(7, 7) += 1.0 / (slope * slope);
    h = -right;
    return spd_solve_scaled(matrix.data(), 9, 1e-13, SPD_PIVOT_LEAST, h.data()) != 0;
}

double depth_at(const Vec9 &h, const Row &row)
{
    return std::max(0.1, 1.0 + h[6] * row.X + h[7] * row.Y);
}

double residual_at(const Vec9 &h, const Row &row, double depth)
{
    const double x = h[0] * row.X + h[1] * row.Y + h[2];
    const double y = h[3] * row.X + h[4] * row.Y + h[5];
    const double last = 1.0 + h[6] * row.X + h[7] * row.Y;
    return (row.l[0] * x + row.l[1] * y + row.l[2] * last) / depth + h[8] * row.shift;
}

void weighted_moments(const EdgeSet &set, uint32_t n, const opms_edge_t *edges, const Units &units,
                      const Vec9 *h, const double *z, double scale, Moments &moments)
{
    const double lever = LEVER_M / units.plane;
    moments = {};
    for (uint32_t i = 0; i < n; ++i) {
        const Row row = row_of(set, i, edges, units);
        double weight = row.l[0] != 0.0 || row.l[1] != 0.0 ? 1.0 : 0.0; // else not reached
        double depth = 1.0;
        if (h) {
            const double part = z[i] / (2.0 * scale);
            depth = depth_at(*h, row);
            weight /= (1.0 + part * part) * depth * depth;
        }
        add_edge(moments, row, lever * lever, depth, weight);
    }
}

/* One weighted fit after another, the first with equal weights, until outliers pull no more. */
bool fit_homography(const EdgeSet &set, uint32_t n, const opms_edge_t *edges, const Units &units,
                    Vec9 &h)
{
    double z[EdgeSet::CAPACITY];
    double scale = 0.0;
    for (int pass = 1; pass <= PASSES_MAX; ++pass) {
        Moments moments;
        weighted_moments(set, n, edges, units, pass > 1 ? &h : nullptr, z, scale, moments);
        if (!solve(moments, SLOPE_PER_M * units.plane, h)) {
            return false;
        }
        if (pass >= PASSES_MIN && scale < SCALE_GOOD) {
            break;
        }
        for (uint32_t i = 0; i < n; ++i) {
            const Row row = row_of(set, i, edges, units);
            z[i] = residual_at(h, row, depth_at(h, row));
        }
        scale = std::max(1.0, robust_scale(z, n));
    }
    return true;
}

} // namespace

bool homography_start(const EdgeSet &set, uint32_t n, const opms_edge_t *edges, PlaneView &view)
{
    Units units;
    Vec9 h;
    if (n < 8 || !choose_units(set, n, units) || !fit_homography(set, n, edges, units, h)) {
        return false;
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
    view.shift_px = h[8];
    return true;
}

} // namespace opms::pose
