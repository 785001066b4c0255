/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/stretch_fit.h"

#include <math.h>
#include <string.h>

#include "bar/bar_code.h"
#include "bar/edge_lanes.h"
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
    lanes_t step, pulse, by_box, by_gauss;
    lanes_t by_cross; /* of the step, by the covariance of motion across and along */
} shaped_profile_t;

static inline shaped_profile_t shaped_at(const edge_blur_t *blur, lanes_t s)
{
    shaped_profile_t p;
    p.by_cross = lanes_of(0.f);
    if (blur->box <= 0.f) {
        const lanes_t z = s * blur->per_gauss;
        const normal_lanes_t plain = normal_lanes(z);
        p.step = plain.step;
        p.pulse = plain.pulse * blur->per_gauss;
        p.by_box = lanes_of(0.f);
        p.by_gauss = -z * p.pulse;
        return p;
    }
    /* As edge_lanes_blurred(). */
    const lanes_t high = (s + 0.5f * blur->box) * blur->per_gauss;
    const lanes_t low = (s - 0.5f * blur->box) * blur->per_gauss;
    const normal_lanes_t a = normal_lanes(low), b = normal_lanes(high);
    p.step = ((high * b.step + b.pulse) - (low * a.step + a.pulse)) *
             (blur->gauss * blur->per_box);
    p.pulse = (b.step - a.step) * blur->per_box;
    p.by_box = (0.5f * (a.step + b.step) - p.step) * blur->per_box;
    p.by_gauss = (b.pulse - a.pulse) * blur->per_box;
    return p;
}

/** How much of the code cells beyond the side is black at a position along it, under the blur;
 * `ends` gets what the lean adds to that. */
static inline lanes_t cells_at(const side_model_t *model, const cell_ends_t *near, lanes_t along,
                               lanes_t *ends)
{
    const float along_sigma = model->along_px / model->along_scale;
    lanes_t sum = lanes_of(near->base);
    *ends = lanes_of(0.f);
    for (int i = 0; i < near->count; ++i) {
        const lanes_t from = (along - near->at_mm[i]) * model->along_px;
        const normal_lanes_t end = edge_lanes_blurred(&model->blur_along, from);
        sum += near->sign[i] * end.step;
        *ends -= near->sign[i] * end.pulse * along_sigma;
    }
    return sum;
}

/** How the middle of the exposure's part in light goes with the place: for a box a parabola of the
 * same area as the pulse. */
static inline lanes_t cross_pulse(const edge_blur_t *blur, lanes_t s, lanes_t pulse)
{
    if (blur->box <= 0.f) {
        return pulse;
    }
    const lanes_t part = s * blur->per_box;
    return lanes_max(lanes_of(0.f), (1.5f - 6.f * part * part) * blur->per_box);
}

/** What the model has within reach of a stretch. */
typedef struct stretch_parts {
    int end, cells, cells_far;
    cell_ends_t cell_ends;
} stretch_parts_t;

static stretch_parts_t parts_of(const side_model_t *model, const line_pixels_t *pixels)
{
    const float low = pixels->along_low, high = pixels->along_high;
    stretch_parts_t parts = {.end = 0};
    parts.end = (model->end_at - fmaxf(high, -low)) * model->along_scale < REACH;
    if (model->cells && (pixels->s_high - model->cell_near) * model->per_sigma > -REACH) {
        parts.cell_ends = stretch_cell_ends(model, low, high);
        parts.cells = parts.cell_ends.count > 0 || parts.cell_ends.base > 0.f;
        parts.cells_far = (pixels->s_high - model->cell_far) * model->per_sigma > -REACH;
    }
    return parts;
}

/** The side's end, beyond which there is white. */
static inline void add_end(const side_model_t *model, lanes_t s, lanes_t along,
                           shaped_profile_t *w)
{
    const lanes_t to_end = (model->end_at - lanes_abs(along)) * model->along_scale;
    const float along_sigma = model->along_px / model->along_scale;
    const normal_lanes_t there = edge_lanes_blurred(&model->blur_along, to_end * along_sigma);
    const lanes_t way = lanes_pick(along < 0.f, lanes_of(-1.f), lanes_of(1.f));
    const lanes_t lean = way * model->lean, z = s * model->per_sigma;
    const lanes_t density = there.pulse * along_sigma;
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
static inline void add_cells(const side_model_t *model, const stretch_parts_t *parts, lanes_t s,
                             lanes_t along, shaped_profile_t *w)
{
    const lanes_t from_near = s - model->cell_near;
    shaped_profile_t across = shaped_at(&model->blur, from_near);
    lanes_t crossed = cross_pulse(&model->blur, from_near, across.pulse);
    if (parts->cells_far) {
        const lanes_t from_far = s - model->cell_far;
        const shaped_profile_t far = shaped_at(&model->blur, from_far);
        across.step -= far.step;
        across.pulse -= far.pulse;
        across.by_box -= far.by_box;
        across.by_gauss -= far.by_gauss;
        crossed -= cross_pulse(&model->blur, from_far, far.pulse);
    }
    lanes_t ends;
    const lanes_t cells = cells_at(model, &parts->cell_ends, along, &ends);
    w->step -= cells * across.step - model->lean * ends * across.pulse / model->per_sigma;
    const lanes_t by_cross = ends * (model->along_scale / model->along_px) * crossed;
    w->step += model->cross * by_cross;
    w->by_cross += by_cross;
    w->by_box -= cells * across.by_box;
    w->by_gauss -= cells * across.by_gauss;
}

/** Fill the columns from the pixels' coverages. */
static void model_pixels(const side_model_t *model, float clip, const line_pixels_t *pixels,
                         clip_columns_t *columns)
{
    const stretch_parts_t parts = parts_of(model, pixels);
    const float scale = 1.f / clip;
    const int own = C_SHAPE + CLIP_BLUR + model->family;
    const int boxed = model->blur.box > 0.f;
    lanes_int_t cut = {0};
    const lanes_int_t number = {0, 1, 2, 3};
    for (int k = 0; k < pixels->count; k += LANES) {
        const lanes_t s = lanes_load(&pixels->s[k]), along = lanes_load(&pixels->along[k]);
        shaped_profile_t w = shaped_at(&model->blur, s);
        if (parts.end) {
            add_end(model, s, along, &w);
        }
        if (parts.cells) {
            add_cells(model, &parts, s, along, &w);
        }
        /* The mean of a noisy level that is cut. */
        const lanes_t z = (clip - w.step) * model->per_cut_noise;
        const normal_lanes_t open = normal_lanes(z);
        const lanes_t noisy = w.step * open.step + clip * (1.f - open.step) -
                              open.pulse / model->per_cut_noise;
        const lanes_t level = lanes_pick(z > CUT_REACH, w.step, noisy);
        const lanes_t by_step = open.step * scale;
        cut -= (z < 0.f) & (number < pixels->count - k);
        lanes_store(&columns->x[C_GREY][k], lanes_load(&pixels->grey[k]));
        lanes_store(&columns->x[C_W][k], level * scale);
        lanes_store(&columns->x[C_G][k], w.pulse * by_step);
        lanes_store(&columns->x[C_SHAPE + CLIP_LOG][k], 1.f - open.step - level * scale);
        lanes_store(&columns->x[own][k],
                    by_step * (boxed ? w.by_box * model->box_by_total : w.by_gauss));
        lanes_store(&columns->x[C_SHAPE + CLIP_BLUR + !model->family][k], lanes_of(0.f));
        lanes_store(&columns->x[C_SHAPE + CLIP_CROSS][k], by_step * w.by_cross * model->cross_by);
        lanes_store(&columns->x[C_SHAPE + CLIP_STILL][k],
                    boxed ? by_step * (w.by_gauss + w.by_box * model->box_by_still)
                          : lanes_of(0.f));
    }
    columns->count = pixels->count;
    columns->cut = cut[0] + cut[1] + cut[2] + cut[3];
}

/** Sums of the columns' products about their means. */
static void sum_columns(clip_columns_t *columns, const side_model_t *model, double mean[COLUMNS],
                        double xx[COLUMNS][COLUMNS])
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
    for (; n % LANES != 0; ++n) {
        for (int a = 0; a < COLUMNS; ++a) {
            columns->x[a][n] = 0;
        }
    }
    for (int i = 0; i < count; ++i) {
        const int a = used[i];
        lanes_t sum = {0};
        for (int k = 0; k < n; k += LANES) {
            sum += lanes_load(&columns->x[a][k]);
        }
        mean[a] = (double)lanes_sum(sum) / columns->count;
        for (int j = 0; j <= i; ++j) {
            const int b = used[j];
            lanes_t product = {0};
            for (int k = 0; k < n; k += LANES) {
                product += lanes_load(&columns->x[a][k]) * lanes_load(&columns->x[b][k]);
            }
            xx[a][b] = (double)lanes_sum(product) - mean[a] * mean[b] * columns->count;
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

static int solve(const double mean[COLUMNS], double xx[COLUMNS][COLUMNS], int noisy, stretch_t *out)
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
        out->clip.by[a] = (float)(xx[C_SHAPE + a][C_G] / xx[C_G][C_G]);
        out->clip.slope[a] = (float)(contrast * xx[C_GREY][C_SHAPE + a]);
        for (int b = 0; b <= a; ++b) {
            out->clip.weight[a][b] = (float)(contrast * contrast * xx[C_SHAPE + a][C_SHAPE + b]);
        }
    }
    return 1;
}

int stretch_fit_clipped(const side_model_t *model, const fit_line_t *lines, int count,
                        stretch_t *out)
{
    line_pixels_t pixels;
    line_pixels_gather(&pixels, lines, count);
    const int saturated = line_pixels_saturated(&pixels, model->white_level - 0.5f);
    memset(&out->clip, 0, sizeof out->clip);
    out->clipped = 1;
    out->ground = 0;
    out->saturated = (uint16_t)saturated;
    out->pixels = (uint16_t)pixels.count;
    if (pixels.count < PIXELS_LEAST) {
        return 0;
    }
    /* In the shade white may be below saturation. */
    const float clip =
        (float)saturated > SATURATED_PART * (float)pixels.count ? model->clip : 2.f;
    clip_columns_t columns;
    model_pixels(model, clip, &pixels, &columns);
    double mean[COLUMNS], xx[COLUMNS][COLUMNS];
    sum_columns(&columns, model, mean, xx);
    if (!solve(mean, xx, columns.count - columns.cut, out)) {
        return 0;
    }
    if (clip > 1.f) {
        out->contrast /= clip; /* from black to white, as in the others */
    }
    out->blur_weight = out->clip.weight[CLIP_BLUR + model->family][CLIP_BLUR + model->family];
    return 1;
}
