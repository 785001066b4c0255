/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/edge_fit.h"

#include <math.h>

#include "bar/bar_code.h"
#include "bar/edge_blur.h"
#include "bar/stretch_fit.h"

/* The pixels next to a side are taken in lines across it: rows of the picture where the side is
 * nearer to upright, columns otherwise. In each line the signed distance of a pixel from the
 * predicted edge is linear, so no pixel is ever interpolated. Several lines make a stretch, in
 * which black level, contrast and a small displacement are solved for by linear least squares. */

#define LINES_A_STRETCH 5
#define LINES_ENOUGH 16   /* across a side, for some of them to be left out while scouting */
#define INSIDE_BLURS                                                                               \
    4.2 /* reach of the pixels that take part, in standard deviations of the blur */
#define OUTSIDE_BLURS 3.2
#define GROUND_BLURS 1.4
#define CUT_NOISE_LEAST 0.002

/** Where a side is expected in the picture: a parabola through three projected points. */
typedef struct side_curve {
    int along_axis;        /* 0: lines are columns (x steps along the side), 1: lines are rows */
    double p0[2], p1[2], p2[2]; /* px(tau) = p0 + tau p1 + tau^2 p2, tau = -1..1 over 20 mm */
    double normal[2];      /* outward, at the middle */
    double cosine;         /* of the angle between the normal and the direction across the lines */
    double sign;           /* of that direction, +1 when the coordinate grows outwards */
    double px_per_mm;      /* across the side, outwards */
    double half_px;        /* half the side's length */
    double border_px;      /* distance of the bar's border beyond the sides along Y */
    double along_mm[2];    /* gradient of the position along the side, mm per px of u and of v, */
    double along_turn[2];  /* and its change by tau: the ends are seldom parallel in the picture */
} side_curve_t;

static const double side_outward[4][2] = {{-1, 0}, {0, -1}, {1, 0}, {0, 1}};

static void side_point(int side, double tau, double square_y, double *x_mm, double *y_mm)
{
    const double *out = side_outward[side];
    *x_mm = BAR_HALF_SQUARE_MM * (out[0] + (out[0] == 0 ? tau : 0));
    *y_mm = square_y + BAR_HALF_SQUARE_MM * (out[1] + (out[1] == 0 ? tau : 0));
}

/** Row of the inverse of the map's derivative: X for the sides along X, Y for the others. */
static void along_gradient(const double jac[4], int along_x, double gradient[2])
{
    const double det = jac[0] * jac[3] - jac[1] * jac[2];
    gradient[0] = (along_x ? jac[3] : -jac[2]) / det;
    gradient[1] = (along_x ? -jac[1] : jac[0]) / det;
}

static int side_predict(const edge_scene_t *scene, int square, int side, side_curve_t *curve)
{
    const double square_y = BAR_PITCH_MM * (square - OPMS_BAR_ORIGIN);
    double end[3][2], jacs[3][4];
    const double *jac = jacs[1];
    for (int i = 0; i < 3; ++i) {
        double x, y;
        side_point(side, i - 1.0, square_y, &x, &y);
        if (!plane_map_project(&scene->map, scene->lens, scene->ray_limit, x, y, end[i],
                               jacs[i])) {
            return 0;
        }
    }
    for (int axis = 0; axis < 2; ++axis) {
        curve->p0[axis] = end[1][axis];
        curve->p1[axis] = 0.5 * (end[2][axis] - end[0][axis]);
        curve->p2[axis] = 0.5 * (end[2][axis] + end[0][axis]) - end[1][axis];
    }
    curve->half_px = hypot(curve->p1[0], curve->p1[1]);
    if (!(curve->half_px > 1.5 && curve->half_px < 4000)) {
        return 0;
    }
    const double *out = side_outward[side];
    const double out_px[2] = {jac[0] * out[0] + jac[1] * out[1], jac[2] * out[0] + jac[3] * out[1]};
    double nx = -curve->p1[1] / curve->half_px, ny = curve->p1[0] / curve->half_px;
    curve->px_per_mm = nx * out_px[0] + ny * out_px[1];
    if (curve->px_per_mm < 0) {
        nx = -nx;
        ny = -ny;
        curve->px_per_mm = -curve->px_per_mm;
    }
    double border[2];
    if (!plane_map_project(&scene->map, scene->lens, scene->ray_limit, out[0] * BAR_HALF_WIDTH_MM,
                           square_y, border, NULL)) {
        return 0;
    }
    curve->border_px = nx * (border[0] - end[1][0]) + ny * (border[1] - end[1][1]);
    curve->normal[0] = nx;
    curve->normal[1] = ny;
    curve->along_axis = fabs(curve->p1[0]) >= fabs(curve->p1[1]) ? 0 : 1;
    const double across = curve->along_axis == 0 ? ny : nx;
    curve->sign = across < 0 ? -1 : 1;
    curve->cosine = fabs(across);
    const int along_x = side == 1 || side == 3;
    double ends[2][2];
    along_gradient(jac, along_x, curve->along_mm);
    along_gradient(jacs[0], along_x, ends[0]);
    along_gradient(jacs[2], along_x, ends[1]);
    for (int axis = 0; axis < 2; ++axis) {
        curve->along_turn[axis] = 0.5 * (ends[1][axis] - ends[0][axis]);
    }
    return curve->px_per_mm > 0.05;
}

/** Cosine of the angle between the normals of the side and of its ends: 0 at right angles. */
static double lean_of(const side_curve_t *curve)
{
    const double *n = curve->normal, *a = curve->along_mm;
    return (n[0] * a[0] + n[1] * a[1]) / hypot(a[0], a[1]);
}

typedef struct side_window {
    double inside, outside; /* px from the edge */
    double ground;          /* distance of the bar's border, 0 where it plays no part */
    double trim;            /* of tau at each end */
} side_window_t;

/** Standard deviation of the blur where the picture has a given scale. */
static double blur_at(const edge_scene_t *scene, int family, double px_per_mm)
{
    const double still = scene->still_px, total = scene->blur_px[family];
    if (total <= still || !(scene->blur_scale[family] > 0)) {
        return total;
    }
    const double ratio = px_per_mm / scene->blur_scale[family];
    return sqrt(still * still + (total * total - still * still) * ratio * ratio);
}

static side_window_t window_of(const side_curve_t *curve, int side, double blur, double blur_along,
                               int clipped)
{
    side_window_t window;
    const double wide = OUTSIDE_BLURS * blur + 0.5;
    window.inside = fmin(INSIDE_BLURS * blur + 0.5, 13.0 * curve->px_per_mm);
    window.ground = 0;
    if (side == 1 || side == 3) {
        /* Up to the middle of the cells, which are modelled. */
        window.outside = fmin(wide, (BAR_CELL_GAP_MM + 4.0) * curve->px_per_mm);
    } else {
        /* Beyond the bar's border lies the ground, of unknown brightness. It is modelled as far as
         * its edge goes, since farther out lie the bar's side, its shadow and grass. */
        const double border = curve->border_px;
        if (clipped) {
            window.outside = fmin(wide, fmax(border - 2.2 * blur, 0.4 * border));
        } else {
            window.outside = fmin(wide, border + GROUND_BLURS * blur);
            window.ground = border < wide + 2.2 * blur ? border : 0;
        }
    }
    window.trim = fmin(0.5, 0.5 * blur_along / curve->half_px);
    return window;
}

static void load_pixels(const view_t *view, int along_axis, int main, int first, int count,
                        float *grey)
{
    if (along_axis == 1 && !view->wide) {
        const uint8_t *row = view->base + (ptrdiff_t)main * view->stride + first;
        for (int k = 0; k < count; ++k) {
            grey[k] = (float)row[k];
        }
        return;
    }
    for (int k = 0; k < count; ++k) {
        grey[k] = (float)(along_axis == 0 ? view_at(view, main, first + k)
                                          : view_at(view, first + k, main));
    }
}

/** What the model of saturated white needs besides. */
static void add_clipped(const edge_scene_t *scene, int side, const side_curve_t *curve,
                        double sigma_along, double along_px, side_model_t *model)
{
    const int family = side & 1;
    const double still = scene->still_px, total = scene->blur_px[family];
    model->per_cut_noise = (float)(1 / fmax(CUT_NOISE_LEAST, scene->cut_noise * scene->clip));
    model->family = family;
    model->blur_along = edge_blur_of(sigma_along, still);
    model->along_px = (float)along_px;
    model->box_by_total = model->box_by_still = 0;
    model->cross = model->cross_by = 0;
    if (model->blur.box > 0.f && scene->blur_scale[family] > 0) {
        /* box^2 = 12 (total^2 - still^2) at the scale at which these hold */
        const double ratio = curve->px_per_mm / scene->blur_scale[family];
        const double box = sqrt(12 * (total * total - still * still));
        model->box_by_total = (float)(ratio * 12 * total / box);
        model->box_by_still = (float)(-ratio * 12 * still / box);
    }
    if (edge_scene_moved(scene) && scene->blur_scale[0] > 0 && scene->blur_scale[1] > 0) {
        const double area =
            curve->px_per_mm * along_px / (scene->blur_scale[0] * scene->blur_scale[1]);
        model->cross_by = (float)(side < 2 ? -area : area);
        model->cross = (float)scene->cross_px2 * model->cross_by;
    }
}

static int fit_side(const edge_scene_t *scene, int square, int side, const grey_levels_t *levels,
                    stretch_t *stretches)
{
    side_curve_t curve;
    if (!side_predict(scene, square, side, &curve)) {
        return 0;
    }
    const view_t *view = scene->view;
    const int family = side == 1 || side == 3;
    const double sigma = blur_at(scene, family, curve.px_per_mm);
    const double along_px =
        1 / hypot(curve.along_mm[0], curve.along_mm[1]); /* per mm, square to the ends */
    const double sigma_along = blur_at(scene, !family, along_px);
    const int clipped = scene->clip < 1;
    const side_window_t window = window_of(&curve, side, sigma, sigma_along, clipped);
    const float shift = (float)(scene->shift_px * scene->shift_gain[family]);
    const double still = scene->still_px;
    side_model_t model = {
        .blur = edge_blur_of(sigma, still),
        .per_sigma = (float)(1 / sigma),
        .end_at =
            (float)(BAR_HALF_SQUARE_MM + scene->shift_px * scene->shift_gain[!family] / along_px),
        .along_scale = (float)(along_px / sigma_along),
        .lean = (float)(still * still / (sigma * sigma_along) * lean_of(&curve)),
        .cells = family ? bar_gap_cells(square, side == 3 ? 1 : -1) : 0,
        .cell_near = (float)(BAR_CELL_GAP_MM * curve.px_per_mm) - 2.f * shift,
        .cell_far = (float)((BAR_CELL_GAP_MM + BAR_CELL_Y_MM) * curve.px_per_mm),
        .ground = (float)window.ground,
        .clip = (float)scene->clip,
        .white_level = (float)view->white_level};
    if (scene->clip < 1) {
        add_clipped(scene, side, &curve, sigma_along, along_px, &model);
    }
    const int m = curve.along_axis, c = 1 - m;
    const int main_size = m == 0 ? view->width : view->height;
    const int cross_size = c == 0 ? view->width : view->height;
    const double reach = 1.0 - window.trim;
    const double a = curve.p0[m] - reach * curve.p1[m] + reach * reach * curve.p2[m];
    const double b = curve.p0[m] + reach * curve.p1[m] + reach * reach * curve.p2[m];
    const int from = (int)fmax(ceil(fmin(a, b)), 0),
              to = (int)fmin(floor(fmax(a, b)), main_size - 1);
    const int line_step = to - from >= LINES_ENOUGH ? scene->line_step : 1;
    const int line_count = (to - from) / line_step + 1;
    if (line_count < 2) {
        return 0;
    }
    int parts = (line_count + LINES_A_STRETCH / 2) / LINES_A_STRETCH;
    parts = parts < 1 ? 1 : parts > OPMS_BAR_EDGES_PER_SIDE ? OPMS_BAR_EDGES_PER_SIDE : parts;

    fit_line_t lines[STRETCH_LINES_MAX];
    int found = 0;
    for (int part = 0; part < parts; ++part) {
        const int part_from = line_count * part / parts, part_to = line_count * (part + 1) / parts;
        double along = 0;
        int used = 0;
        for (int k = part_from; k < part_to && used < STRETCH_LINES_MAX; ++k) {
            const int main = from + k * line_step;
            double tau = (main - curve.p0[m]) / curve.p1[m];
            tau = (main - curve.p0[m] - curve.p2[m] * tau * tau) / curve.p1[m];
            const double edge = curve.p0[c] + tau * (curve.p1[c] + tau * curve.p2[c]);
            /* Grey line from the inside of the window to its outside, whichever way that runs. */
            const double span = (window.inside + window.outside) / curve.cosine;
            const double start = curve.sign > 0
                ? edge - (window.inside - (double)shift) / curve.cosine
                : edge - (window.outside + (double)shift) / curve.cosine;
            const int first = (int)ceil(start), last = (int)floor(start + span);
            if (first < 1 || last > cross_size - 2 || last - first >= LINE_PIXELS_MAX) {
                continue;
            }
            fit_line_t *line = &lines[used];
            line->count = last - first + 1;
            line->s_step = (float)(curve.sign * curve.cosine);
            line->s_first = (float)(curve.sign * curve.cosine * (first - edge)) - shift;
            const double along_mm = curve.along_mm[c] + tau * curve.along_turn[c];
            line->along_step = (float)along_mm;
            line->along_first = (float)(BAR_HALF_SQUARE_MM * tau + along_mm * (first - edge));
            load_pixels(view, curve.along_axis, main, first, line->count, line->grey);
            along += tau;
            ++used;
        }
        stretch_t *out = &stretches[found];
        if (used == 0) {
            continue;
        }
        out->expected_px = shift;
        if (scene->clip < 1) {
            if (!stretch_fit_clipped(&model, lines, used, out)) {
                continue;
            }
        } else {
            stretch_sum(&model, lines, used, out);
            if (!stretch_solve(levels, out)) {
                continue;
            }
        }
        const double tau = along / used;
        out->square = (int16_t)square;
        out->side = (int16_t)side;
        out->along_mm = (float)(BAR_HALF_SQUARE_MM * tau);
        for (int axis = 0; axis < 2; ++axis) {
            out->predicted[axis] =
                (float)(curve.p0[axis] + tau * (curve.p1[axis] + tau * curve.p2[axis]));
            out->normal[axis] = (float)curve.normal[axis];
        }
        out->px_per_mm = (float)curve.px_per_mm;
        ++found;
    }
    return found;
}

int edge_fit_square(const edge_scene_t *scene, int square, const grey_levels_t *levels,
                    stretch_t *stretches)
{
    int count = 0;
    for (int side = 0; side < 4; ++side) {
        count += fit_side(scene, square, side, levels, stretches + count);
    }
    return count;
}
