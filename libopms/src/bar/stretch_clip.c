/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/stretch_fit.h"

#include <math.h>
#include <string.h>

#include "bar/bar_code.h"
#include "bar/edge_wide.h"
#include "bar/line_pixels.h"

/* Where white saturates, the coverage of a blurred edge is cut at the part `clip` of the true
 * contrast, and w is what is left, scaled to 1: grey = black + contrast w. Solved for are black,
 * contrast and position; how the profile's shape enters, by clip and blur, is handed on. */

#define PIXELS_LEAST 10
#define NOISY_LEAST 5
#define SATURATED_PART 0.02f /* of a stretch's pixels, from which on its white is cut */
#define REACH STRETCH_REACH
#define CUT_REACH 4.f        /* noises below the cut from where on it has none */

enum { C_W, C_G, C_SHAPE, C_GREY = C_SHAPE + CLIP_SHAPE, COLUMNS };

typedef struct clip_columns {
    int count, cut;
    float x[COLUMNS][PIXELS_MAX];
} clip_columns_t;

/** A profile with its derivatives by place, by its box and by its Gaussian. */
typedef struct shaped_profile {
    wide_t step, pulse, by_box, by_gauss;
    wide_t by_cross; /* of the step, by the covariance of motion across and along */
} shaped_profile_t;

WIDE_INLINE shaped_profile_t shaped_at(const edge_blur_t *blur, wide_t s)
{
    shaped_profile_t p;
    box_ends_t ends;
    box_ends_at(blur, s, &ends);
    const wide_t low = ends.z[0], high = ends.z[1];
    const normal_wide_t a = ends.at[0];
    p.by_cross = wide_of(0.f);
    if (blur->box <= 0.f) {
        p.step = a.step;
        p.pulse = a.pulse * blur->per_gauss;
        p.by_box = wide_of(0.f);
        p.by_gauss = -low * p.pulse;
        return p;
    }
    /* As edge_wide_blurred(). */
    const normal_wide_t b = ends.at[1];
    p.step = ((high * b.step + b.pulse) - (low * a.step + a.pulse)) *
             (blur->gauss * blur->per_box);
    p.pulse = (b.step - a.step) * blur->per_box;
    p.by_box = (0.5f * (a.step + b.step) - p.step) * blur->per_box;
    p.by_gauss = (b.pulse - a.pulse) * blur->per_box;
    return p;
}

/** How much of the code cells beyond the side is black at a position along it, under the blur;
 * `ends` gets what the lean adds to that. */
WIDE_INLINE wide_t cells_at(const side_model_t *model, const cell_ends_t *near, wide_t along,
                               wide_t *ends)
{
    const float along_sigma = model->along_px / model->along_scale;
    wide_t sum = wide_of(near->base);
    *ends = wide_of(0.f);
    for (int i = 0; i < near->count; ++i) {
        const wide_t from = (along - near->at_mm[i]) * model->along_px;
        const normal_wide_t end = edge_wide_blurred(&model->blur_along, from);
        sum += near->sign[i] * end.step;
        *ends -= near->sign[i] * end.pulse * along_sigma;
    }
    return sum;
}

/** How the middle of the exposure's part in light goes with the place: for a box a parabola of the
 * same area as the pulse. */
WIDE_INLINE wide_t cross_pulse(const edge_blur_t *blur, wide_t s, wide_t pulse)
{
    if (blur->box <= 0.f) {
        return pulse;
    }
    const wide_t part = s * blur->per_box;
    return wide_max(wide_of(0.f), (1.5f - 6.f * part * part) * blur->per_box);
}

/** What the model has within reach of a stretch. */
typedef struct stretch_parts {
    int end, cells, cells_far;
    cell_ends_t cell_ends;
} stretch_parts_t;

WIDE_INLINE void parts_of(const side_model_t *model, const line_pixels_t *pixels,
                          stretch_parts_t *parts)
{
    const float low = pixels->along_low, high = pixels->along_high;
    parts->end = (model->end_at - larger_of(high, -low)) * model->along_scale < REACH;
    parts->cells = parts->cells_far = parts->cell_ends.count = 0;
    parts->cell_ends.base = 0.f;
    if (model->cells && (pixels->s_high - model->cell_near) * model->per_sigma > -REACH) {
        stretch_cell_ends(model, low, high, &parts->cell_ends);
        parts->cells = parts->cell_ends.count > 0 || parts->cell_ends.base > 0.f;
        parts->cells_far = (pixels->s_high - model->cell_far) * model->per_sigma > -REACH;
    }
}

/** The side's end, beyond which there is white. */
WIDE_INLINE void add_end(const side_model_t *model, wide_t s, wide_t along,
                           shaped_profile_t *w)
{
    const wide_t to_end = (model->end_at - wide_abs(along)) * model->along_scale;
    const float along_sigma = model->along_px / model->along_scale;
    const normal_wide_t there = edge_wide_blurred(&model->blur_along, to_end * along_sigma);
    const wide_t way = wide_signed(wide_of(1.f), along);
    const wide_t lean = way * model->lean, z = s * model->per_sigma;
    const wide_t density = there.pulse * along_sigma;
    w->step = 1.f - (1.f - w->step) * there.step -
              corner_excess(lean, -z, w->pulse / model->per_sigma, to_end, density);
    /* To first order in the lesser part of the motion. */
    w->by_cross = -way * there.pulse * cross_pulse(&model->blur, s, w->pulse);
    w->step += model->cross * w->by_cross;
    w->pulse *= there.step + lean * z * density;
    w->by_box *= there.step;
    w->by_gauss *= there.step;
}

/** The code cells beyond the gap. */
WIDE_INLINE void add_cells(const side_model_t *model, const stretch_parts_t *parts, wide_t s,
                             wide_t along, shaped_profile_t *w)
{
    const wide_t none = wide_of(0.f);
    shaped_profile_t across = {none, none, none, none, none};
    wide_t crossed = none;
    for (int far = 0; far <= parts->cells_far; ++far) {
        const float sign = far ? -1.f : 1.f;
        const wide_t from = s - (far ? model->cell_far : model->cell_near);
        const shaped_profile_t border = shaped_at(&model->blur, from);
        across.step += sign * border.step;
        across.pulse += sign * border.pulse;
        across.by_box += sign * border.by_box;
        across.by_gauss += sign * border.by_gauss;
        crossed += sign * cross_pulse(&model->blur, from, border.pulse);
    }
    wide_t ends;
    const wide_t cells = cells_at(model, &parts->cell_ends, along, &ends);
    w->step -= cells * across.step - model->lean * ends * across.pulse / model->per_sigma;
    const wide_t by_cross = ends * (model->along_scale / model->along_px) * crossed;
    w->step += model->cross * by_cross;
    w->by_cross += by_cross;
    w->by_box -= cells * across.by_box;
    w->by_gauss -= cells * across.by_gauss;
}

/** Fill the columns from the pixels' coverages. */
WIDE_INLINE void model_pixels(const side_model_t *model, float clip, const line_pixels_t *pixels,
                              clip_columns_t *columns)
{
    stretch_parts_t parts;
    parts_of(model, pixels, &parts);
    const float scale = 1.f / clip;
    const int own = C_SHAPE + CLIP_BLUR + model->family;
    const int boxed = model->blur.box > 0.f;
    wide_int_t cut = {0};
    for (int k = 0; k < pixels->count; k += WIDE) {
        const wide_t s = wide_load(&pixels->s[k]), along = wide_load(&pixels->along[k]);
        shaped_profile_t w = shaped_at(&model->blur, s);
        if (parts.end) {
            add_end(model, s, along, &w);
        }
        if (parts.cells) {
            add_cells(model, &parts, s, along, &w);
        }
        /* The mean of a noisy level that is cut. */
        const wide_t z = (clip - w.step) * model->per_cut_noise;
        const normal_wide_t open = normal_wide(z);
        const wide_t noisy = w.step * open.step + clip * (1.f - open.step) -
                              open.pulse / model->per_cut_noise;
        const wide_t level = wide_pick(wide_less(wide_of(CUT_REACH), z), w.step, noisy);
        const wide_t by_step = open.step * scale;
        cut += wide_less(z, wide_of(0.f)) & wide_first(pixels->count - k);
        wide_store(&columns->x[C_GREY][k], wide_load(&pixels->grey[k]));
        wide_store(&columns->x[C_W][k], level * scale);
        wide_store(&columns->x[C_G][k], w.pulse * by_step);
        wide_store(&columns->x[C_SHAPE + CLIP_LOG][k], 1.f - open.step - level * scale);
        wide_store(&columns->x[own][k],
                    by_step * (boxed ? w.by_box * model->box_by_total : w.by_gauss));
        wide_store(&columns->x[C_SHAPE + CLIP_BLUR + !model->family][k], wide_of(0.f));
        wide_store(&columns->x[C_SHAPE + CLIP_CROSS][k], by_step * w.by_cross * model->cross_by);
        wide_store(&columns->x[C_SHAPE + CLIP_STILL][k],
                    boxed ? by_step * (w.by_gauss + w.by_box * model->box_by_still)
                          : wide_of(0.f));
    }
    columns->count = pixels->count;
    columns->cut = wide_count(cut);
}

/** Sums of the columns' products about their means. */
WIDE_INLINE void sum_columns(clip_columns_t *columns, const side_model_t *model,
                             double mean[COLUMNS], double xx[COLUMNS][COLUMNS])
{
    /* Columns that hold something: no side knows of the other family's blur, few of motion. */
    int used[COLUMNS], count = 0;
    for (int a = 0; a < COLUMNS; ++a) {
        const int shape = a - C_SHAPE;
        if (shape != CLIP_BLUR + !model->family &&
            (shape != CLIP_STILL || model->blur.box > 0.f) &&
            (shape != CLIP_CROSS || fabsf(model->cross_by) > 0.f)) {
            used[count++] = a;
        }
        mean[a] = 0;
        memset(xx[a], 0, sizeof xx[a]);
    }
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
        mean[a] = (double)wide_sum(sum) / columns->count;
        for (int j = 0; j <= i; ++j) {
            const int b = used[j];
            wide_t product = {0};
            for (int k = 0; k < n; k += WIDE) {
                product += wide_load(&columns->x[a][k]) * wide_load(&columns->x[b][k]);
            }
            xx[a][b] = (double)wide_sum(product) - mean[a] * mean[b] * columns->count;
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
                 clip_info_t *shape)
{
    const double whole = xx[C_G][C_G];
    if (!(xx[C_W][C_W] > 0)) {
        return 0;
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
    out->contrast = (float)contrast;
    out->black = (float)(mean[C_GREY] - contrast * mean[C_W] - slope * mean[C_G]);
    out->offset_px = out->expected_px + (float)(-slope / contrast);
    out->sigma_unit = (float)(1 / (sqrt(xx[C_G][C_G]) * contrast));
    const double rss = xx[C_GREY][C_GREY] > 0 ? xx[C_GREY][C_GREY] : 0;
    out->variance = (float)(rss / (noisy - 3 > NOISY_LEAST ? noisy - 3 : NOISY_LEAST));
    for (int a = 0; a < CLIP_SHAPE; ++a) {
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
                            clip_info_t *shape)
{
    line_pixels_t pixels;
    line_pixels_gather(&pixels, lines);
    const int saturated = lighter_pixels(&pixels, model->white_level - 0.5f);
    const int cut = lighter_pixels(&pixels, model->cut_level - 0.5f);
    cut_pixels(&pixels, model->cut_level);
    memset(shape, 0, sizeof *shape);
    out->clipped = 1;
    out->ground = out->cells = 0;
    out->saturated = (uint16_t)saturated;
    out->pixels = (uint16_t)pixels.count;
    if (pixels.count < PIXELS_LEAST) {
        return 0;
    }
    /* In the shade white may be below saturation. */
    const float clip =
        (float)cut > SATURATED_PART * (float)pixels.count ? model->clip : 2.f;
    clip_columns_t columns;
    model_pixels(model, clip, &pixels, &columns);
    double mean[COLUMNS], xx[COLUMNS][COLUMNS];
    sum_columns(&columns, model, mean, xx);
    if (!solve(mean, xx, columns.count - columns.cut, out, shape)) {
        return 0;
    }
    if (clip > 1.f) {
        out->contrast /= clip; /* from black to white, as in the others */
    }
    out->blur_weight = shape->weight[CLIP_BLUR + model->family][CLIP_BLUR + model->family];
    return 1;
}

int stretch_clip_plain(const side_model_t *model, const fit_lines_t *lines, stretch_t *out,
                       clip_info_t *shape)
{
    return fit_stretch(model, lines, out, shape);
}

WIDE_AVX2 int stretch_clip_avx2(const side_model_t *model, const fit_lines_t *lines,
                                stretch_t *out, clip_info_t *shape)
{
    return fit_stretch(model, lines, out, shape);
}
