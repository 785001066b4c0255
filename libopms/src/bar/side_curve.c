/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/side_curve.h"

#include <math.h>

#include "bar/bar_code.h"

/** A point of the square's outline in the picture. */
typedef struct outline_point {
    double px[2], jac[4];
} outline_point_t;

static const double side_outward[4][2] = {{-1, 0}, {0, -1}, {1, 0}, {0, 1}};

/** The outline by eighths: side s has its middle at 2 s + 1 and its ends at 2 s and 2 s + 2. */
static const double outline[8][2] = {{-1, 1},  {-1, 0}, {-1, -1}, {0, -1},
                                     {1, -1}, {1, 0},  {1, 1},   {0, 1}};

/** Row of the inverse of the map's derivative: X for the sides along X, Y for the others. */
static void along_gradient(const double jac[4], int along_x, double gradient[2])
{
    const double per_det = 1 / (jac[0] * jac[3] - jac[1] * jac[2]);
    gradient[0] = (along_x ? jac[3] : -jac[2]) * per_det;
    gradient[1] = (along_x ? -jac[1] : jac[0]) * per_det;
}

/** One side from its ends, of which `low` has the lesser X or Y, and its middle. */
static void curve_of(int side, const outline_point_t *low, const outline_point_t *mid,
                     const outline_point_t *high, side_curve_t *curve)
{
    for (int axis = 0; axis < 2; ++axis) {
        curve->p0[axis] = mid->px[axis];
        curve->p1[axis] = 0.5 * (high->px[axis] - low->px[axis]);
        curve->p2[axis] = 0.5 * (high->px[axis] + low->px[axis]) - mid->px[axis];
    }
    const double *p1 = curve->p1, *jac = mid->jac, *out = side_outward[side];
    curve->half_px = sqrt(p1[0] * p1[0] + p1[1] * p1[1]);
    curve->border_px = 0;
    curve->seen = curve->half_px > 1.5 && curve->half_px < 4000;
    if (!curve->seen) {
        return;
    }
    const double out_px[2] = {jac[0] * out[0] + jac[1] * out[1], jac[2] * out[0] + jac[3] * out[1]};
    const double per_length = 1 / curve->half_px;
    const double nx = -p1[1] * per_length, ny = p1[0] * per_length;
    const double inward = nx * out_px[0] + ny * out_px[1] < 0 ? -1 : 1;
    curve->px_per_mm = fabs(nx * out_px[0] + ny * out_px[1]);
    curve->normal[0] = inward * nx;
    curve->normal[1] = inward * ny;
    curve->along_axis = fabs(p1[0]) >= fabs(p1[1]) ? 0 : 1;
    const double across = curve->normal[1 - curve->along_axis];
    curve->sign = across < 0 ? -1 : 1;
    curve->cosine = fabs(across);
    const int along_x = side == 1 || side == 3;
    double ends[2][2];
    along_gradient(jac, along_x, curve->along_mm);
    along_gradient(low->jac, along_x, ends[0]);
    along_gradient(high->jac, along_x, ends[1]);
    for (int axis = 0; axis < 2; ++axis) {
        curve->along_turn[axis] = 0.5 * (ends[1][axis] - ends[0][axis]);
    }
    curve->seen = curve->px_per_mm > 0.05;
}

void side_curves(const plane_map_t *map, const opms_lens_t *lens, double ray_limit, int square,
                 side_curve_t curve[4])
{
    const double square_y = BAR_PITCH_MM * (square - OPMS_BAR_ORIGIN);
    outline_point_t point[8];
    int reached[8];
    for (int i = 0; i < 8; ++i) {
        reached[i] = plane_map_project(map, lens, ray_limit, BAR_HALF_SQUARE_MM * outline[i][0],
                                       square_y + BAR_HALF_SQUARE_MM * outline[i][1], point[i].px,
                                       point[i].jac);
    }
    for (int side = 0; side < 4; ++side) {
        /* Sides 0 and 3 are met from their higher end when one goes round. */
        const int first = 2 * side, last = (2 * side + 2) & 7;
        const int turned = side == 0 || side == 3;
        const int low = turned ? last : first, high = turned ? first : last;
        side_curve_t *c = &curve[side];
        c->seen = 0;
        if (!reached[low] || !reached[2 * side + 1] || !reached[high]) {
            continue;
        }
        curve_of(side, &point[low], &point[2 * side + 1], &point[high], c);
        double border[2];
        if (c->seen && !(side & 1)) {
            c->seen = plane_map_project(map, lens, ray_limit,
                                        side_outward[side][0] * BAR_HALF_WIDTH_MM, square_y, border,
                                        NULL);
            c->border_px = c->normal[0] * (border[0] - c->p0[0]) +
                           c->normal[1] * (border[1] - c->p0[1]);
        }
    }
}

double side_curve_lean(const side_curve_t *curve)
{
    const double *n = curve->normal, *a = curve->along_mm;
    return (n[0] * a[0] + n[1] * a[1]) / sqrt(a[0] * a[0] + a[1] * a[1]);
}
