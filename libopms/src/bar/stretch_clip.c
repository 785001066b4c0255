/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/stretch_fit.h"

#include <math.h>
#include <string.h>

#include "bar/bar_code.h"

/* Where white saturates, the coverage of a blurred edge is cut at the part `clip` of the true
 * contrast, and w is what is left, scaled to 1: grey = black + contrast w. Solved for are black,
 * contrast and position; how the profile's shape enters, by clip and blur, is handed on. */

#define PIXELS_LEAST 10
#define NOISY_LEAST 5
#define SATURATED_PART 0.02f /* of a stretch's pixels, from which on its white is cut */
#define LANES 4
#define PIXELS_MAX 1024

enum { C_W, C_G, C_SHAPE, C_GREY = C_SHAPE + CLIP_SHAPE, COLUMNS };

typedef float lanes_t __attribute__((vector_size(LANES * sizeof(float))));

typedef struct clip_columns {
    int count, cut;
    float x[COLUMNS][PIXELS_MAX] __attribute__((aligned(16)));
} clip_columns_t;

/** A profile with its derivatives by place, by its box and by its Gaussian. */
typedef struct shaped_profile {
    float step, pulse, by_box, by_gauss;
    float by_cross; /* of the step, by the covariance of motion across and along */
} shaped_profile_t;

static shaped_profile_t shaped_at(const edge_blur_t *blur, float s)
{
    shaped_profile_t p;
    p.by_cross = 0;
    if (blur->box <= 0.f) {
        const float z = s * blur->per_gauss;
        const edge_profile_t plain = edge_profile(z);
        p.step = plain.step;
        p.pulse = plain.pulse * blur->per_gauss;
        p.by_box = 0;
        p.by_gauss = -z * p.pulse;
        return p;
    }
    /* As edge_profile_blurred(). */
    const float high = (s + 0.5f * blur->box) * blur->per_gauss;
    const float low = (s - 0.5f * blur->box) * blur->per_gauss;
    const edge_profile_t a = edge_profile(low), b = edge_profile(high);
    p.step = ((high * b.step + b.pulse) - (low * a.step + a.pulse)) * blur->gauss * blur->per_box;
    p.pulse = (b.step - a.step) * blur->per_box;
    p.by_box = (0.5f * (a.step + b.step) - p.step) * blur->per_box;
    p.by_gauss = (b.pulse - a.pulse) * blur->per_box;
    return p;
}

/** How much of the code cells beyond the side is black at a position along it, under the blur;
 * `ends` gets what the lean adds to that. */
static float cells_at(const side_model_t *model, float along, float *ends)
{
    const float along_sigma = model->along_px / model->along_scale;
    float sum = 0;
    *ends = 0;
    for (int i = 0; i < BAR_CELLS; ++i) {
        if (model->cells >> i & 1u) {
            const float from = (along - (float)BAR_CELL_X_MM * (float)(i - 3)) * model->along_px;
            const float to = from - (float)BAR_CELL_X_MM * model->along_px;
            const edge_profile_t a = edge_profile_blurred(&model->blur_along, from),
                                 b = edge_profile_blurred(&model->blur_along, to);
            sum += a.step - b.step;
            *ends += (b.pulse - a.pulse) * along_sigma;
        }
    }
    return sum;
}

/** How the middle of the exposure's part in light goes with the place: for a box a parabola of the
 * same area as the pulse. */
static float cross_pulse(const edge_blur_t *blur, float s, float pulse)
{
    if (blur->box <= 0.f) {
        return pulse;
    }
    const float part = s * blur->per_box;
    return fmaxf(0.f, (1.5f - 6.f * part * part) * blur->per_box);
}

/** White coverage of a pixel in `step`, and its derivatives. */
static shaped_profile_t coverage(const side_model_t *model, float s, float along)
{
    shaped_profile_t w = shaped_at(&model->blur, s);
    const float to_end = (model->end_at - fabsf(along)) * model->along_scale;
    if (to_end < 3.5f) {
        const float along_sigma = model->along_px / model->along_scale;
        const edge_profile_t there = edge_profile_blurred(&model->blur_along, to_end * along_sigma);
        const float lean = along < 0.f ? -model->lean : model->lean, z = s * model->per_sigma;
        const float density = there.pulse * along_sigma;
        w.step = 1.f - (1.f - w.step) * there.step -
                 corner_excess(lean, -z, w.pulse / model->per_sigma, to_end, density);
        /* To first order in the lesser part of the motion. */
        w.by_cross =
            -(along < 0.f ? -1.f : 1.f) * there.pulse * cross_pulse(&model->blur, s, w.pulse);
        w.step += model->cross * w.by_cross;
        w.pulse *= there.step + lean * z * density;
        w.by_box *= there.step;
        w.by_gauss *= there.step;
    }
    if (model->cells && (s - model->cell_near) * model->per_sigma > -3.5f) {
        float ends;
        const float cells = cells_at(model, along, &ends);
        const shaped_profile_t near = shaped_at(&model->blur, s - model->cell_near);
        const shaped_profile_t far = shaped_at(&model->blur, s - model->cell_far);
        w.step -= cells * (near.step - far.step) +
                  model->lean * ends * (far.pulse - near.pulse) / model->per_sigma;
        const float by_cross =
            -ends * model->along_scale / model->along_px *
            (cross_pulse(&model->blur, s - model->cell_far, far.pulse) -
             cross_pulse(&model->blur, s - model->cell_near, near.pulse));
        w.step += model->cross * by_cross;
        w.by_cross += by_cross;
        w.by_box -= cells * (near.by_box - far.by_box);
        w.by_gauss -= cells * (near.by_gauss - far.by_gauss);
    }
    return w;
}

static void add_line(clip_columns_t *columns, const side_model_t *model, float clip,
                     const fit_line_t *line)
{
    const float scale = 1.f / clip;
    const int own = C_SHAPE + CLIP_BLUR + model->family;
    const int boxed = model->blur.box > 0.f;
    int n = columns->count;
    for (int k = 0; k < line->count; ++k, ++n) {
        const float s = line->s_first + (float)k * line->s_step;
        const shaped_profile_t w =
            coverage(model, s, line->along_first + (float)k * line->along_step);
        columns->x[C_GREY][n] = line->grey[k];
        /* The mean of a noisy level that is cut. */
        const float z = (clip - w.step) * model->per_cut_noise;
        const edge_profile_t open = edge_profile(z);
        const float level = z > 4.f ? w.step
            : w.step * open.step + clip * (1.f - open.step) - open.pulse / model->per_cut_noise;
        const float by_step = open.step * scale;
        columns->cut += z < 0.f;
        columns->x[C_W][n] = level * scale;
        columns->x[C_G][n] = w.pulse * by_step;
        columns->x[C_SHAPE + CLIP_LOG][n] = 1.f - open.step - level * scale;
        columns->x[own][n] =
            by_step * (boxed ? w.by_box * model->box_by_total : w.by_gauss);
        columns->x[C_SHAPE + CLIP_BLUR + !model->family][n] = 0.f;
        columns->x[C_SHAPE + CLIP_CROSS][n] = by_step * w.by_cross * model->cross_by;
        columns->x[C_SHAPE + CLIP_STILL][n] =
            boxed ? by_step * (w.by_gauss + w.by_box * model->box_by_still) : 0.f;
    }
    columns->count = n;
}

static inline float total(lanes_t v)
{
    return (v[0] + v[1]) + (v[2] + v[3]);
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
            sum += *(const lanes_t *)(const void *)&columns->x[a][k];
        }
        mean[a] = (double)total(sum) / columns->count;
        for (int j = 0; j <= i; ++j) {
            const int b = used[j];
            lanes_t product = {0};
            for (int k = 0; k < n; k += LANES) {
                product += *(const lanes_t *)(const void *)&columns->x[a][k] *
                           *(const lanes_t *)(const void *)&columns->x[b][k];
            }
            xx[a][b] = (double)total(product) - mean[a] * mean[b] * columns->count;
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
    int pixels = 0, saturated = 0;
    const float white = model->white_level - 0.5f;
    for (int i = 0; i < count; ++i) {
        pixels += lines[i].count;
        for (int k = 0; k < lines[i].count; ++k) {
            saturated += lines[i].grey[k] >= white;
        }
    }
    memset(&out->clip, 0, sizeof out->clip);
    out->clipped = 1;
    out->ground = 0;
    out->saturated = (uint16_t)saturated;
    out->pixels = (uint16_t)pixels;
    if (pixels < PIXELS_LEAST) {
        return 0;
    }
    /* In the shade white may be below saturation. */
    const float clip = (float)saturated > SATURATED_PART * (float)pixels ? model->clip : 2.f;
    clip_columns_t columns;
    columns.count = columns.cut = 0;
    for (int i = 0; i < count && columns.count + lines[i].count <= PIXELS_MAX - LANES; ++i) {
        add_line(&columns, model, clip, &lines[i]);
    }
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
