/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/stretch_fit.h"

#include <math.h>
#include <string.h>

#include "bar/bar_code.h"
#include "bar/edge_wide.h"
#include "bar/line_pixels.h"

/* Where white saturates, the coverage of a blurred edge is cut at the part `clip` of the true
 * contrast, and w is what is left, scaled to 1: grey = black + contrast w. Where the picture moved,
 * the coverage is the mean over the way. Solved for are black, contrast and position; how the
 * profile's shape enters, by clip, blur and way, is handed on. */

#define PIXELS_LEAST 10
#define NOISY_LEAST 5
#define SATURATED_PART 0.02f /* of a stretch's pixels, from which on its white is cut */
#define REACH STRETCH_REACH
#define GROUND_LEAST 0.001 /* of its column, for the ground to be in a stretch */
#define CUT_REACH 4.f        /* noises below the cut from where on it has none */

enum { C_GROUND, C_W, C_G, C_SHAPE, C_GREY = C_SHAPE + SHAPES, COLUMNS };

/** The ground beyond the bar's border: out of reach, a column with a brightness of its own, or,
 * where white is cut, part of the coverage. */
typedef enum ground_part { GROUND_NONE, GROUND_COLUMN, GROUND_DROP } ground_part_t;

typedef struct shape_columns {
    int count, cut;
    float white;  /**< what the column of the coverage has for white */
    ground_part_t ground;
    int straight; /**< neither an end nor cells are in reach */
    float x[COLUMNS][PIXELS_MAX];
} shape_columns_t;

/** White coverage, its slope along the side's normal, and its derivatives by the blur and by the
 * ways across the side and along it, both per unit of these. */
typedef struct shaped_profile {
    wide_t step, pulse, by_blur, by_across, by_along, ground;
} shaped_profile_t;

/** A straight edge that moved, in closed form. */
WIDE_INLINE shaped_profile_t straight_at(const edge_blur_t *blur, wide_t s)
{
    shaped_profile_t p;
    box_ends_t ends;
    box_ends_at(blur, s, &ends);
    const wide_t low = ends.z[0], high = ends.z[1];
    const normal_wide_t a = ends.at[0];
    p.by_along = wide_of(0.f);
    if (blur->box <= 0.f) {
        p.step = a.step;
        p.pulse = a.pulse * blur->per_gauss;
        p.by_across = wide_of(0.f);
        p.by_blur = -low * p.pulse;
        return p;
    }
    /* As edge_wide_blurred(). */
    const normal_wide_t b = ends.at[1];
    p.step = ((high * b.step + b.pulse) - (low * a.step + a.pulse)) *
             (blur->gauss * blur->per_box);
    p.pulse = (b.step - a.step) * blur->per_box;
    p.by_across = (0.5f * (a.step + b.step) - p.step) * blur->per_box;
    p.by_blur = (b.pulse - a.pulse) * blur->per_box;
    return p;
}

/** What the model has within reach of a stretch. */
typedef struct stretch_parts {
    int end, cells, cells_far;
    cell_ends_t cell_ends;
} stretch_parts_t;

WIDE_INLINE void parts_of(const side_model_t *model, const line_pixels_t *pixels,
                          stretch_parts_t *parts)
{
    const float across = 0.5f * fabsf(model->way_px), along = 0.5f * fabsf(model->way_mm);
    const float low = pixels->along_low - along, high = pixels->along_high + along;
    const float s_high = pixels->s_high + across;
    parts->end = (model->end_at - larger_of(high, -low)) * model->along_scale < REACH;
    parts->cells = parts->cells_far = parts->cell_ends.count = 0;
    parts->cell_ends.base = 0.f;
    if (model->cells && (s_high - model->cell_near) * model->per_sigma > -REACH) {
        stretch_cell_ends(model, low, high, &parts->cell_ends);
        parts->cells = parts->cell_ends.count > 0 || parts->cell_ends.base > 0.f;
        parts->cells_far = (s_high - model->cell_far) * model->per_sigma > -REACH;
    }
}

/** The side's end, beyond which there is white. */
WIDE_INLINE void add_end(const side_model_t *model, wide_t s, wide_t along, shaped_profile_t *w)
{
    const wide_t to_end = (model->end_at - wide_abs(along)) * model->along_scale;
    const normal_wide_t there = normal_wide(to_end);
    const wide_t way = wide_signed(wide_of(1.f), along);
    const wide_t lean = way * model->lean, z = s * model->per_sigma;
    w->by_along = way * (1.f - w->step) * there.pulse * model->along_scale;
    w->step = 1.f - (1.f - w->step) * there.step -
              corner_excess(lean, -z, w->pulse * model->sigma, to_end, there.pulse);
    w->pulse *= there.step + lean * z * there.pulse;
    w->by_blur *= there.step;
}

/** The code cells beyond the gap. */
WIDE_INLINE void add_cells(const side_model_t *model, const stretch_parts_t *parts, wide_t s,
                           wide_t along, shaped_profile_t *w)
{
    const wide_t none = wide_of(0.f);
    wide_t step = none, pulse = none, by_blur = none;
    for (int far = 0; far <= parts->cells_far; ++far) {
        const float sign = far ? -1.f : 1.f;
        const wide_t z = (s - (far ? model->cell_far : model->cell_near)) * model->per_sigma;
        const normal_wide_t border = normal_wide(z);
        step += sign * border.step;
        pulse += sign * border.pulse;
        by_blur -= sign * z * border.pulse;
    }
    const cell_ends_t *near = &parts->cell_ends;
    wide_t cells = wide_of(near->base), ends = none;
    for (int i = 0; i < near->count; ++i) {
        const normal_wide_t end = normal_wide((along - near->at_mm[i]) * model->along_scale);
        cells += near->sign[i] * end.step;
        ends += near->sign[i] * end.pulse;
    }
    w->step -= cells * step + ends * pulse * model->lean;
    w->by_along -= ends * step * model->along_scale;
    w->by_blur -= cells * by_blur * model->per_sigma;
}

/** Gauss and Legendre's rule for the mean over an interval of length 1 about 0. */
#define INSTANTS 3
static const float gauss_at[INSTANTS] = {-0.38729833f, 0.f, 0.38729833f};
static const float gauss_weight[INSTANTS] = {5.f / 18, 8.f / 18, 5.f / 18};

/** A moving picture is the mean of still ones: over panels so short that three instants of each
 * tell all. */
WIDE_INLINE shaped_profile_t moving_at(const side_model_t *model, const stretch_parts_t *parts,
                                       wide_t s, wide_t along)
{
    const int panels = model->panels, count = panels > 0 ? INSTANTS * panels : 1;
    const float width = panels > 0 ? 1.f / (float)panels : 0.f;
    const wide_t none = wide_of(0.f);
    shaped_profile_t mean = {none, none, none, none, none, none};
    for (int k = 0; k < count; ++k) {
        const float at = (float)(k / INSTANTS) + 0.5f + gauss_at[k % INSTANTS];
        const float t = panels > 0 ? at * width - 0.5f : 0.f;
        const float part = panels > 0 ? gauss_weight[k % INSTANTS] * width : 1.f;
        const wide_t s_then = s - t * model->way_px, along_then = along - t * model->way_mm;
        const wide_t z = s_then * model->per_sigma;
        const normal_wide_t edge = normal_wide(z);
        const wide_t pulse = edge.pulse * model->per_sigma;
        shaped_profile_t then = {edge.step, pulse, -z * pulse, none, none, none};
        if (parts->end) {
            add_end(model, s_then, along_then, &then);
        }
        if (parts->cells) {
            add_cells(model, parts, s_then, along_then, &then);
        }
        mean.step += then.step * part;
        mean.pulse += then.pulse * part;
        mean.by_blur += then.by_blur * part;
        mean.by_across -= then.pulse * (part * t);
        mean.by_along -= then.by_along * (part * t);
    }
    return mean;
}

/** Add what runs straight through a stretch: its own edge, if there is nothing else to it, and the
 * bar's border, beyond which the ground is darker than white; one loop for both, since every other
 * copy of straight_at() is a kilobyte. */
WIDE_INLINE void add_straight(const side_model_t *model, int edge, ground_part_t ground, wide_t s,
                              shaped_profile_t *w)
{
    const float drop = ground == GROUND_DROP ? model->ground_drop : 0.f;
    const float way = model->way_px < 0.f ? -1.f : 1.f; /* the closed form is of the box's width */
    for (int at_border = !edge; at_border <= (ground != GROUND_NONE); ++at_border) {
        const float part = at_border ? -drop : 1.f;
        const shaped_profile_t of =
            straight_at(&model->blur, s - (at_border ? model->ground : 0.f));
        w->step += part * of.step;
        w->pulse += part * of.pulse;
        w->by_blur += part * of.by_blur;
        w->by_across += part * way * of.by_across;
        w->ground = of.step;
    }
}

/** Fill the columns from the pixels' coverages. */
WIDE_INLINE void model_pixels(const side_model_t *model, float clip, const line_pixels_t *pixels,
                              shape_columns_t *columns)
{
    stretch_parts_t parts;
    parts_of(model, pixels, &parts);
    const int straight = !parts.end && !parts.cells;
    const float scale = 1.f / clip;
    columns->white = scale;
    columns->ground = !(model->ground > 0.f) ? GROUND_NONE
                      : clip < 1.f           ? GROUND_DROP
                                             : GROUND_COLUMN;
    const int own = C_SHAPE + SHAPE_WAY + model->family;
    const int other = C_SHAPE + SHAPE_WAY + !model->family;
    const wide_t none = wide_of(0.f);
    wide_int_t cut = {0};
    for (int k = 0; k < pixels->count; k += WIDE) {
        const wide_t s = wide_load(&pixels->s[k]), along = wide_load(&pixels->along[k]);
        shaped_profile_t w = {none, none, none, none, none, none};
        if (!straight) {
            w = moving_at(model, &parts, s, along);
        }
        add_straight(model, straight, columns->ground, s, &w);
        wide_t level = w.step, by_step = wide_of(scale);
        if (clip < 1.f) {
            /* The mean of a noisy level that is cut. */
            const wide_t z = (clip - w.step) * model->per_cut_noise;
            const normal_wide_t open = normal_wide(z);
            const wide_t noisy = w.step * open.step + clip * (1.f - open.step) -
                                  open.pulse / model->per_cut_noise;
            level = wide_pick(wide_less(wide_of(CUT_REACH), z), w.step, noisy);
            by_step = open.step * scale;
            wide_store(&columns->x[C_SHAPE + SHAPE_CLIP][k], 1.f - open.step - level * scale);
            cut += wide_less(z, wide_of(0.f)) & wide_first(pixels->count - k);
        }
        if (columns->ground == GROUND_COLUMN) {
            wide_store(&columns->x[C_GROUND][k], w.ground);
        } else if (columns->ground == GROUND_DROP) {
            wide_store(&columns->x[C_SHAPE + SHAPE_GROUND][k], -w.ground * by_step);
        }
        wide_store(&columns->x[C_GREY][k], wide_load(&pixels->grey[k]));
        wide_store(&columns->x[C_W][k], level * scale);
        wide_store(&columns->x[C_G][k], w.pulse * by_step);
        wide_store(&columns->x[C_SHAPE + SHAPE_STILL][k], by_step * w.by_blur);
        const wide_t by_across = by_step * w.by_across * model->way_by;
        const wide_t by_along = by_step * w.by_along;
        wide_store(&columns->x[own][k], by_across);
        wide_store(&columns->x[other][k], by_along);
        wide_store(&columns->x[C_SHAPE + SHAPE_WAY + 2][k],
                   by_across * model->rise_across + by_along * model->rise_along);
    }
    columns->count = pixels->count;
    columns->cut = wide_count(cut);
    columns->straight = straight;
}

/** Does a column hold something? */
static int column_used(const shape_columns_t *columns, const side_model_t *model, int column)
{
    const int moved = model->panels > 0;
    switch (column - C_SHAPE) {
    case C_GROUND - C_SHAPE:
        return columns->ground == GROUND_COLUMN;
    case SHAPE_CLIP:
        return columns->cut > 0;
    case SHAPE_GROUND:
        return columns->ground == GROUND_DROP;
    case SHAPE_WAY:
    case SHAPE_WAY + 1:
        return moved && (column == C_SHAPE + SHAPE_WAY + model->family || !columns->straight);
    case SHAPE_WAY + 2:
        return moved;
    default:
        return 1;
    }
}

/** Sums of the columns' products about their means. */
WIDE_INLINE void sum_columns(shape_columns_t *columns, const side_model_t *model,
                             double mean[COLUMNS], double xx[COLUMNS][COLUMNS])
{
    int used[COLUMNS], count = 0;
    for (int a = 0; a < COLUMNS; ++a) {
        if (column_used(columns, model, a)) {
            used[count++] = a;
        }
        mean[a] = 0;
        memset(xx[a], 0, sizeof xx[a]);
    }
    /* What is known of black and white counts as so many pixels of them. */
    const float black = model->levels.weight[0], white = model->levels.weight[1];
    const float black_grey = model->levels.grey[0], white_grey = model->levels.grey[1];
    const double all = (double)((float)columns->count + black + white);
    int n = columns->count;
    for (; n % WIDE != 0; ++n) {
        for (int a = 0; a < COLUMNS; ++a) {
            columns->x[a][n] = 0;
        }
    }
    for (int i = 0; i < count; ++i) {
        const int a = used[i];
        wide_t sum = {0};
        for (int k = 0; k < n; k += WIDE) {
            sum += wide_load(&columns->x[a][k]);
        }
        mean[a] = (double)wide_sum(sum);
        mean[a] += a == C_W ? (double)(white * columns->white)
                   : a == C_GREY ? (double)(black * black_grey + white * white_grey) : 0;
        mean[a] /= all;
        for (int j = 0; j <= i; ++j) {
            const int b = used[j];
            wide_t product = {0};
            for (int k = 0; k < n; k += WIDE) {
                product += wide_load(&columns->x[a][k]) * wide_load(&columns->x[b][k]);
            }
            xx[a][b] = (double)wide_sum(product) - mean[a] * mean[b] * all;
            if (a == C_W && b == C_W) {
                xx[a][b] += (double)(white * columns->white * columns->white);
            } else if (a == C_GREY && b == C_W) {
                xx[a][b] += (double)(white * columns->white * white_grey);
            } else if (a == C_GREY && b == C_GREY) {
                xx[a][b] += (double)(black * black_grey * black_grey +
                                     white * white_grey * white_grey);
            }
        }
    }
}

/** Take column `p` out of all that follow. */
static void sweep(double xx[COLUMNS][COLUMNS], int p)
{
    for (int a = p + 1; a < COLUMNS; ++a) {
        const double part = xx[a][p] / xx[p][p];
        for (int b = p + 1; b <= a; ++b) {
            xx[a][b] -= part * xx[b][p];
        }
    }
}

static int solve(const double mean[COLUMNS], double xx[COLUMNS][COLUMNS], int noisy, stretch_t *out,
                 shape_info_t *shape)
{
    const double whole = xx[C_G][C_G];
    if (!(xx[C_W][C_W] > 0)) {
        return 0;
    }
    const int ground = xx[C_GROUND][C_GROUND] > GROUND_LEAST;
    if (ground) {
        sweep(xx, C_GROUND);
    }
    sweep(xx, C_W);
    if (!(xx[C_G][C_G] > 1e-3 * whole)) {
        return 0;
    }
    sweep(xx, C_G);
    const double slope = xx[C_GREY][C_G] / xx[C_G][C_G];
    const double contrast = (xx[C_GREY][C_W] - xx[C_G][C_W] * slope) / xx[C_W][C_W];
    if (!(contrast > 0)) {
        return 0;
    }
    const double height = ground ? (xx[C_GREY][C_GROUND] - xx[C_W][C_GROUND] * contrast -
                                    xx[C_G][C_GROUND] * slope) /
                                       xx[C_GROUND][C_GROUND]
                                 : 0;
    out->contrast = (float)contrast;
    out->black = (float)(mean[C_GREY] - contrast * mean[C_W] - slope * mean[C_G] -
                         height * mean[C_GROUND]);
    out->offset_px = out->expected_px + (float)(-slope / contrast);
    out->sigma_unit = (float)(1 / (sqrt(xx[C_G][C_G]) * contrast));
    const double rss = xx[C_GREY][C_GREY] > 0 ? xx[C_GREY][C_GREY] : 0;
    out->variance = (float)(rss / (noisy - 3 > NOISY_LEAST ? noisy - 3 : NOISY_LEAST));
    for (int a = 0; a < SHAPES; ++a) {
        shape->by[a] = (float)(xx[C_SHAPE + a][C_G] / xx[C_G][C_G]);
        shape->slope[a] = (float)(contrast * xx[C_GREY][C_SHAPE + a]);
        for (int b = 0; b <= a; ++b) {
            shape->weight[a][b] = (float)(contrast * contrast * xx[C_SHAPE + a][C_SHAPE + b]);
        }
    }
    return 1;
}

/** Cut what is lighter than `level`. */
WIDE_INLINE void cut_pixels(line_pixels_t *pixels, float level)
{
    for (int k = 0; k < pixels->count; k += WIDE) {
        wide_store(&pixels->grey[k], wide_min(wide_load(&pixels->grey[k]), wide_of(level)));
    }
}

/** How many pixels are lighter than `level`. */
WIDE_INLINE int lighter_pixels(const line_pixels_t *pixels, float level)
{
    wide_int_t count = {0};
    for (int k = 0; k < pixels->count; k += WIDE) {
        count += wide_less(wide_of(level), wide_load(&pixels->grey[k]));
    }
    return wide_count(count);
}

WIDE_INLINE int fit_stretch(const side_model_t *model, const fit_lines_t *lines, stretch_t *out,
                            shape_info_t *shape)
{
    line_pixels_t pixels;
    line_pixels_gather(&pixels, lines);
    const int saturated = lighter_pixels(&pixels, model->white_level - 0.5f);
    const int cut = lighter_pixels(&pixels, model->cut_level - 0.5f);
    cut_pixels(&pixels, model->cut_level);
    memset(shape, 0, sizeof *shape);
    out->shaped = 1;
    out->ground = out->cells = 0;
    out->saturated = (uint16_t)saturated;
    out->pixels = (uint16_t)pixels.count;
    if (pixels.count < PIXELS_LEAST) {
        return 0;
    }
    /* In the shade white may be below saturation. */
    const float clip =
        (float)cut > SATURATED_PART * (float)pixels.count ? model->clip : (float)UNCUT;
    shape_columns_t columns;
    model_pixels(model, clip, &pixels, &columns);
    double mean[COLUMNS], xx[COLUMNS][COLUMNS];
    sum_columns(&columns, model, mean, xx);
    if (!solve(mean, xx, columns.count - columns.cut, out, shape)) {
        return 0;
    }
    if (clip > 1.f) {
        out->contrast /= clip; /* from black to white, as in the others */
    }
    out->blur_weight = shape->weight[SHAPE_STILL][SHAPE_STILL];
    return 1;
}

int stretch_shaped_plain(const side_model_t *model, const fit_lines_t *lines, stretch_t *out,
                       shape_info_t *shape)
{
    return fit_stretch(model, lines, out, shape);
}

WIDE_AVX2 int stretch_shaped_avx2(const side_model_t *model, const fit_lines_t *lines,
                                stretch_t *out, shape_info_t *shape)
{
    return fit_stretch(model, lines, out, shape);
}
