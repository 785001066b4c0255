/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/edge_fit.h"

#include <math.h>
#include <string.h>

#include "bar/bar_code.h"
#include "bar/side_curve.h"
#include "bar/side_way.h"
#include "bar/stretch_fit.h"

/* A side is looked at along lines of pixels that cross it: rows, or columns if the side runs more
 * across than down. Each line gives raw grey levels at known distances from the expected edge;
 * those distances are exact up to the curvature, and the model in the distances is
 * linear, so no pixel is ever interpolated. Several lines make a stretch, in
 * which black level, contrast and a small displacement are solved for by linear least squares. */

#define LINES_A_STRETCH 4         /* as many as are summed up at once */
#define LINES_A_STRETCH_MOST 12   /* where the side has PARTS_ENOUGH of these */
#define PARTS_ENOUGH 4
#define LINES_A_STRETCH_SHAPED 5
#define SCOUTING_LINES 8  /* across a side are enough to scout by, however long it is */
#define INSIDE_BLURS                                                                               \
    3.0 /* reach of the pixels that take part, in standard deviations of the blur */
#define OUTSIDE_BLURS 2.7
#define GROUND_BLURS 1.4
#define CUT_NOISE_LEAST 0.002
#define RIM_BLURS 2.7      /* standard deviations of the lens's blur that count */
#define TRIM_MOST 0.85
#define STILL_PX 0.1       /* a way that is none */
#define PANEL_BLURS 3.2    /* standard deviations of the blur that a panel of the way is long */
#define PANELS_MOST 8

typedef struct side_window {
    double inside, outside; /* px from the edge */
    double ground;          /* distance of the bar's border, 0 where it plays no part */
    double trim;            /* of tau at each end */
    double along_most;      /* mm from the side's middle */
} side_window_t;

#define ANYWHERE_MM 1e6

/** Standard deviation of the blur where the picture has a given scale. */
static double blur_at(const edge_scene_t *scene, const side_way_t *of, int family,
                      double px_per_mm)
{
    const double still = scene->still_px, total = scene->blur_px[family];
    if (scene->shaped) {
        const double way = of->mm[family] * px_per_mm;
        return sqrt(still * still + way * way / 12);
    }
    if (total <= still || !(scene->blur_scale[family] > 0)) {
        return total;
    }
    const double ratio = px_per_mm / scene->blur_scale[family];
    return sqrt(still * still + (total * total - still * still) * ratio * ratio);
}

static double lesser(double a, double b)
{
    return a < b ? a : b;
}

static double larger(double a, double b)
{
    return a > b ? a : b;
}

static side_window_t window_of(const side_curve_t *curve, int side, double blur, double blur_along)
{
    side_window_t window;
    const double wide = OUTSIDE_BLURS * blur + 0.5;
    window.inside = lesser(INSIDE_BLURS * blur + 0.5, 13.0 * curve->px_per_mm);
    window.ground = 0;
    if (side == 1 || side == 3) {
        /* Up to the middle of the cells, which are modelled. */
        window.outside = lesser(wide, (BAR_CELL_GAP_MM + 4.0) * curve->px_per_mm);
    } else {
        /* Beyond the bar's border lies the ground, of unknown brightness. It is modelled as far as
         * its edge goes, since farther out lie the bar's side, its shadow and grass. */
        const double border = curve->border_px;
        window.outside = lesser(wide, border + GROUND_BLURS * blur);
        window.ground = border < wide + 2.2 * blur ? border : 0;
    }
    window.trim = lesser(0.5, 0.5 * blur_along / curve->half_px);
    window.along_most = ANYWHERE_MM;
    return window;
}

/** Keep what a moving picture smears into its neighbour's pixels out of the window: the next
 * square, and, along the side, code cells or the border. */
static void narrow_window(const edge_scene_t *scene, const side_way_t *way, int side,
                          const side_curve_t *curve, double along_px, side_window_t *window)
{
    const int family = side & 1;
    const double scale = curve->px_per_mm, rim = RIM_BLURS * scene->still_px;
    const double across = 0.5 * fabs(way->mm[family]) * scale + rim;
    const double along = 0.5 * fabs(way->mm[!family]) + rim / along_px;
    const double square_px = 2 * BAR_HALF_SQUARE_MM * scale, pitch_px = BAR_PITCH_MM * scale;
    window->inside = lesser(window->inside, larger(square_px - across, 1.0));
    if (family) {
        window->outside = lesser(window->outside, larger(pitch_px - square_px - across, 1.0));
    }
    const double border_mm = family ? BAR_HALF_WIDTH_MM : BAR_HALF_SQUARE_MM + BAR_CELL_GAP_MM;
    /* Where squares lean in the picture, lines of pixels run along the side, too. */
    window->along_most = border_mm - along;
    const double part = window->along_most / BAR_HALF_SQUARE_MM;
    window->trim = lesser(TRIM_MOST, larger(window->trim, 1 - part));
}

/** What the model of cut white and of motion needs besides. */
static void add_shape(const edge_scene_t *scene, const side_way_t *way, int side,
                      const side_curve_t *curve, double along_px, side_model_t *model)
{
    const int family = side & 1;
    const double still = scene->still_px, out = side < 2 ? -1 : 1;
    memset(&model->levels, 0, sizeof model->levels);
    const double way_px = way->mm[family] * curve->px_per_mm;
    const double along_way_px = way->mm[!family] * along_px;
    const double whole = sqrt(way_px * way_px + along_way_px * along_way_px);
    const double box = fabs(way_px) > STILL_PX ? fabs(way_px) : 0;
    model->per_cut_noise = (float)(1 / fmax(CUT_NOISE_LEAST, scene->cut_noise * scene->clip));
    model->family = family;
    model->blur = edge_blur_boxed(still, box);
    model->sigma = (float)still;
    model->per_sigma = (float)(1 / still);
    model->along_scale = (float)(along_px / still);
    model->lean = (float)side_curve_lean(curve);
    model->way_px = (float)(out * way_px);
    model->way_by = (float)(out * curve->px_per_mm);
    model->way_mm = (float)way->mm[!family];
    model->rise_across = (float)way->by_rise[family];
    model->rise_along = (float)way->by_rise[!family];
    const double panels = 1 + whole / (PANEL_BLURS * still);
    model->panels = whole > STILL_PX ? (int)lesser(panels, PANELS_MOST) : 0;
}

/** One side of a square, as it is looked at. */
typedef struct side_look {
    const edge_scene_t *scene;
    const side_curve_t *curve;
    int side;
    side_way_t way;
    float sag;              /* side_way_sag() */
    float shift;            /* outward, where the edge is expected beyond the curve */
    side_window_t window;
    side_model_t model;
    /* Lines of pixels across the side: every `step`-th from `from` on. */
    int from, count, step;
    int across_size;        /* pixels of a whole line */
    double per_length, bend; /* tau = t - bend t^2 with t = (line - p0) per_length */
    double s_step;          /* px across the side by a pixel of a line */
    double span, before;    /* length of the window, and of its part before the edge */
    fit_lines_t lines[2];
} side_look_t;

static void model_of(const edge_scene_t *scene, int square, side_look_t *look)
{
    const side_curve_t *curve = look->curve;
    const int family = look->side & 1;
    const double *a = curve->along_mm;
    const double along_px = 1 / sqrt(a[0] * a[0] + a[1] * a[1]); /* per mm, square to the ends */
    const double sigma = blur_at(scene, &look->way, family, curve->px_per_mm);
    const double sigma_along = blur_at(scene, &look->way, !family, along_px);
    const double still = scene->still_px;
    look->shift = (float)(scene->shift_px * scene->shift_gain[family]);
    look->window = window_of(curve, look->side, sigma, sigma_along);
    if (scene->shaped && edge_scene_moved(scene)) {
        narrow_window(scene, &look->way, look->side, curve, along_px, &look->window);
    }
    side_model_t *model = &look->model;
    model->blur = edge_blur_of(sigma, still);
    model->sigma = (float)sigma;
    model->per_sigma = (float)(1 / sigma);
    model->end_at =
        (float)(BAR_HALF_SQUARE_MM + scene->shift_px * scene->shift_gain[!family] / along_px);
    model->along_scale = (float)(along_px / sigma_along);
    model->lean = (float)(still * still / (sigma * sigma_along) * side_curve_lean(curve));
    model->cells = family ? bar_gap_cells(square, look->side == 3 ? 1 : -1) : 0;
    model->cell_near = (float)(BAR_CELL_GAP_MM * curve->px_per_mm) - 2.f * look->shift;
    model->cell_far = (float)((BAR_CELL_GAP_MM + BAR_CELL_Y_MM) * curve->px_per_mm);
    model->ground_drop = (float)scene->ground_drop;
    model->ground = (float)look->window.ground;
    model->clip = (float)scene->clip;
    model->white_level = (float)scene->view->white_level;
    model->cut_level = (float)scene->cut_level;
    if (scene->shaped) {
        add_shape(scene, &look->way, look->side, curve, along_px, model);
    }
}

/** Which lines of pixels cross the side; 0 if too few. */
static int lines_of(const edge_scene_t *scene, side_look_t *look)
{
    const side_curve_t *curve = look->curve;
    const view_t *view = scene->view;
    const int m = curve->along_axis, main_size = m == 0 ? view->width : view->height;
    const double *p0 = curve->p0, *p1 = curve->p1, *p2 = curve->p2;
    const double reach = 1.0 - look->window.trim;
    const double a = p0[m] - reach * p1[m] + reach * reach * p2[m];
    const double b = p0[m] + reach * p1[m] + reach * reach * p2[m];
    const double low = larger(lesser(a, b), 0), high = lesser(larger(a, b), main_size - 1);
    if (!(high >= low)) {
        return 0;
    }
    const int from = (int)low + (low > (int)low), to = (int)high;
    look->from = from;
    const int most = (to - from) / SCOUTING_LINES;
    look->step = scene->scouting && most > 1 ? most : 1;
    look->count = (to - from) / look->step + 1;
    look->across_size = m == 0 ? view->height : view->width;
    look->per_length = 1 / p1[m];
    look->bend = p2[m] * look->per_length;
    look->s_step = curve->sign * curve->cosine;
    /* Whichever way a line runs, from the inside to the outside or back. */
    const double per_cosine = 1 / curve->cosine, shift = (double)look->shift;
    look->span = (look->window.inside + look->window.outside) * per_cosine;
    look->before = curve->sign > 0 ? (look->window.inside - shift) * per_cosine
                                   : (look->window.outside + shift) * per_cosine;
    for (int i = 0; i < 2; ++i) {
        look->lines[i].wide = view->wide;
        look->lines[i].pixel_bytes = m == 0 ? view->stride : (view->wide ? 2 : 1);
    }
    return look->count >= 2;
}

/** Keep the positions along the side within the window: `low` to `high`, px from the edge. */
static void limit_along(const side_window_t *window, double at_edge, double per_px, double *low,
                        double *high)
{
    if (window->along_most < ANYWHERE_MM && per_px != 0) {
        const double a = (-window->along_most - at_edge) / per_px;
        const double b = (window->along_most - at_edge) / per_px;
        *low = larger(*low, lesser(a, b));
        *high = lesser(*high, larger(a, b));
    }
}

/** One line of pixels; 0 where its window leaves the picture. */
static int line_at(const side_look_t *look, int main, double tau, fit_line_t *line)
{
    const side_curve_t *curve = look->curve;
    const view_t *view = look->scene->view;
    const int m = curve->along_axis, c = 1 - m;
    const double edge = curve->p0[c] + tau * (curve->p1[c] + tau * curve->p2[c]);
    const double along_mm = curve->along_mm[c] + tau * curve->along_turn[c];
    double low = -look->before, high = look->span - look->before;
    limit_along(&look->window, BAR_HALF_SQUARE_MM * tau, along_mm, &low, &high);
    const double start = edge + low, end = edge + high;
    if (!(start > 0 && start < look->across_size && end > 0)) {
        return 0;
    }
    const int first = (int)start + (start > (int)start), last = (int)end;
    if (first < 1 || last > look->across_size - 2 || last < first ||
        last - first >= LINE_PIXELS_MAX) {
        return 0;
    }
    const double from_edge = first - edge;
    const ptrdiff_t pixel = view->wide ? 2 : 1;
    line->first = m == 1 ? view->base + main * view->stride + first * pixel
                         : view->base + first * view->stride + main * pixel;
    line->count = last - first + 1;
    line->in_row = m == 1 && !view->wide &&
                   first + (line->count + FIT_LINE_SPARE) <= look->across_size;
    line->s_step = (float)look->s_step;
    line->s_first = (float)(look->s_step * from_edge) - look->shift;
    line->along_step = (float)along_mm;
    line->along_first = (float)(BAR_HALF_SQUARE_MM * tau + along_mm * from_edge);
    return 1;
}

/** Gather the lines from number `from` to the one before `to`; returns the mean of their tau. */
static double gather_lines(const side_look_t *look, int from, int to, fit_lines_t *lines)
{
    const double p0 = look->curve->p0[look->curve->along_axis];
    double sum = 0;
    lines->count = 0;
    for (int k = from; k < to && lines->count < STRETCH_LINES_MAX; ++k) {
        const int main = look->from + k * look->step;
        const double t = (main - p0) * look->per_length;
        const double tau = t - look->bend * t * t;
        if (line_at(look, main, tau, &lines->line[lines->count])) {
            sum += tau;
            ++lines->count;
        }
    }
    return lines->count > 0 ? sum / lines->count : 0;
}

/** Where the stretch lies, around `tau`. */
static void place_stretch(const side_curve_t *curve, int square, int side, double tau,
                          stretch_t *out)
{
    out->square = (int16_t)square;
    out->side = (int16_t)side;
    out->along_mm = (float)(BAR_HALF_SQUARE_MM * tau);
    for (int axis = 0; axis < 2; ++axis) {
        out->predicted[axis] =
            (float)(curve->p0[axis] + tau * (curve->p1[axis] + tau * curve->p2[axis]));
        out->normal[axis] = (float)curve->normal[axis];
    }
    out->px_per_mm = (float)curve->px_per_mm;
}

/** How many stretches the side is measured in: enough to lose little of it to a blade of grass. */
static int parts_of(const side_look_t *look)
{
    const int most = OPMS_BAR_EDGES_PER_SIDE, count = look->count;
    int parts;
    if (look->scene->shaped) {
        parts = (count + LINES_A_STRETCH_SHAPED / 2) / LINES_A_STRETCH_SHAPED;
    } else {
        const int short_ones = (count + LINES_A_STRETCH - 1) / LINES_A_STRETCH;
        const int long_ones = (count + LINES_A_STRETCH_MOST - 1) / LINES_A_STRETCH_MOST;
        const int enough = short_ones < PARTS_ENOUGH ? short_ones : PARTS_ENOUGH;
        parts = enough > long_ones ? enough : long_ones + long_ones % 2;
    }
    return parts < 1 ? 1 : parts > most ? most : parts;
}

/** The first line of a stretch. Lines are summed up LINES_A_STRETCH at once, of two stretches side
 * by side: for few places to stay empty, each has one such group or more, and those around the
 * middle have those left over. */
static int first_line(const side_look_t *look, int part, int parts)
{
    const int groups = (look->count + LINES_A_STRETCH - 1) / LINES_A_STRETCH;
    const int each = groups / parts, more = groups % parts, from = (parts - more) / 2;
    const int before = part < from ? 0 : part > from + more ? more : part - from;
    return look->count * (part * each + before) / groups;
}

/** Stretch `part` and the one as far from the other end: so those with a corner in reach are
 * together. Returns how many have an edge. */
static int fit_two(side_look_t *look, int square, int part, int parts, const grey_levels_t *levels,
                   const stretch_place_t *out)
{
    double tau[2];
    stretch_t *stretch[2];
    fit_sums_t *sums[2];
    for (int i = 0; i < 2; ++i) {
        const int number = i == 0 ? part : parts - 1 - part;
        const int twice = i == 1 && number == part;
        const int from = first_line(look, number, parts);
        const int to = twice ? from : first_line(look, number + 1, parts);
        tau[i] = gather_lines(look, from, to, &look->lines[i]);
        stretch[i] = &out->stretch[i];
        sums[i] = &out->sums[i];
        stretch[i]->expected_px = look->shift;
    }
    look->scene->kernel->sum(&look->model, look->lines, stretch, sums);
    int found = 0;
    for (int i = 0; i < 2; ++i) {
        if (look->lines[i].count == 0 || !stretch_solve(levels, sums[i], stretch[i])) {
            continue;
        }
        place_stretch(look->curve, square, look->side, tau[i], stretch[i]);
        if (found < i) {
            out->stretch[found] = *stretch[i];
            out->sums[found] = *sums[i];
        }
        ++found;
    }
    return found;
}

/** One stretch of a picture whose white saturates; returns whether it has an edge. */
static int fit_shaped(side_look_t *look, int square, int part, int parts,
                       const grey_levels_t *levels, const stretch_place_t *out)
{
    if (look->scene->clip >= 1) {
        look->model.levels = *levels;
    }
    const int from = look->count * part / parts, to = look->count * (part + 1) / parts;
    const double tau = gather_lines(look, from, to, &look->lines[0]);
    out->stretch->expected_px = look->shift;
    if (look->lines[0].count == 0 ||
        !look->scene->kernel->fit_shaped(&look->model, &look->lines[0], out->stretch, out->shape)) {
        return 0;
    }
    out->stretch->offset_px -= look->sag;
    place_stretch(look->curve, square, look->side, tau, out->stretch);
    return 1;
}

static int fit_side(side_look_t *look, int square, const grey_levels_t *levels,
                    const stretch_place_t *out)
{
    model_of(look->scene, square, look);
    if (!lines_of(look->scene, look)) {
        return 0;
    }
    const int parts = parts_of(look), shaped = look->scene->shaped;
    int found = 0;
    for (int part = 0; part < (shaped ? parts : (parts + 1) / 2); ++part) {
        const stretch_place_t place = {out->stretch + found, out->sums + found, out->shape + found};
        found += shaped ? fit_shaped(look, square, part, parts, levels, &place)
                         : fit_two(look, square, part, parts, levels, &place);
    }
    return found;
}

int edge_fit_square(const edge_scene_t *scene, int square, const grey_levels_t *levels,
                    const stretch_place_t *out)
{
    side_curve_t curve[4];
    side_curves(&scene->map, scene->lens, scene->ray_limit, square, curve);
    side_look_t look;
    look.scene = scene;
    stretch_place_t place = *out;
    int count = 0;
    for (int side = 0; side < 4; ++side) {
        if (!curve[side].seen) {
            continue;
        }
        look.curve = &curve[side];
        look.side = side;
        look.way = side_way_of(scene, square, side);
        look.sag = (float)side_way_sag(scene, &look.way, look.curve->normal);
        const int found = fit_side(&look, square, levels, &place);
        place.stretch += found;
        place.sums += found;
        place.shape += found;
        count += found;
    }
    return count;
}
