/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/stretch_fit.h"

#include <math.h>

#include "bar/bar_code.h"

/* grey = black + contrast w(s - offset), to first order in the offset, with w the white coverage
 * and g = dw/ds: linear in black, contrast and contrast times offset. Next to the bar's border the
 * ground begins, of unknown brightness: one more step, k, with a height of its own. One more
 * regressor, h, the derivative of w by the blur, is not solved for here: what it would explain of
 * the residual is handed on, and summed over the picture by the caller. Pictures whose white
 * saturates are left to stretch_clip.c. */

#define PIXELS_LEAST 10

#define LANES 4
#define PIXELS_MAX 1024 /* of a stretch, a multiple of LANES */

typedef float lanes_t __attribute__((vector_size(LANES * sizeof(float))));

/** The regressors and the grey level of each pixel, as columns for the vector unit. */
typedef struct fit_pixels {
    int count;
    float x[REGRESSORS][PIXELS_MAX] __attribute__((aligned(16)));
    float i[PIXELS_MAX] __attribute__((aligned(16)));
} fit_pixels_t;

static inline float total(lanes_t v)
{
    return (v[0] + v[1]) + (v[2] + v[3]);
}

/** Sum up the columns; column K only where there is ground. */
static void sum_pixels(fit_pixels_t *pixels, int ground, fit_sums_t *sums)
{
    int n = pixels->count;
    for (; n % LANES != 0; ++n) {
        pixels->i[n] = 0;
        for (int a = 0; a < REGRESSORS; ++a) {
            pixels->x[a][n] = 0;
        }
    }
    lanes_t i = {0}, ii = {0}, x[REGRESSORS] = {{0}}, xi[REGRESSORS] = {{0}},
            xx[REGRESSORS][REGRESSORS] = {{{0}}};
    for (int k = 0; k < n; k += LANES) {
        const lanes_t grey = *(const lanes_t *)(const void *)&pixels->i[k];
        const lanes_t w = *(const lanes_t *)(const void *)&pixels->x[W][k];
        const lanes_t g = *(const lanes_t *)(const void *)&pixels->x[G][k];
        const lanes_t h = *(const lanes_t *)(const void *)&pixels->x[H][k];
        i += grey;
        ii += grey * grey;
        x[W] += w;
        x[G] += g;
        x[H] += h;
        xi[W] += w * grey;
        xi[G] += g * grey;
        xi[H] += h * grey;
        xx[W][W] += w * w;
        xx[G][W] += g * w;
        xx[G][G] += g * g;
        xx[H][W] += h * w;
        xx[H][G] += h * g;
        xx[H][H] += h * h;
        if (ground) {
            const lanes_t step = *(const lanes_t *)(const void *)&pixels->x[K][k];
            x[K] += step;
            xi[K] += step * grey;
            xx[K][W] += step * w;
            xx[K][K] += step * step;
            xx[G][K] += g * step;
            xx[H][K] += h * step;
        }
    }
    sums->n = (float)pixels->count;
    sums->i = total(i);
    sums->ii = total(ii);
    for (int a = 0; a < REGRESSORS; ++a) {
        sums->x[a] = total(x[a]);
        sums->xi[a] = total(xi[a]);
        for (int b = 0; b <= a; ++b) {
            sums->xx[a][b] = total(xx[a][b]);
        }
    }
}

/** What the whole picture says of black and white, as if seen by so many pixels of this stretch. */
static void add_levels(fit_sums_t *sums, const grey_levels_t *levels)
{
    for (int white = 0; white < 2; ++white) {
        const float weight = levels->weight[white], i = levels->grey[white];
        sums->n += weight;
        sums->i += weight * i;
        sums->ii += weight * i * i;
        if (white) {
            sums->x[W] += weight;
            sums->xi[W] += weight * i;
            sums->xx[W][W] += weight;
        }
    }
}

/** How much of the code cells beyond the side is black at a position along it, under the blur;
 * `ends` gets what the lean adds to that. */
static float cells_at(const side_model_t *model, float along, float *ends)
{
    float sum = 0;
    *ends = 0;
    for (int i = 0; i < BAR_CELLS;) {
        if (!(model->cells >> i & 1u)) {
            ++i;
            continue;
        }
        int j = i;
        while (j < BAR_CELLS && (model->cells >> j & 1u)) {
            ++j;
        }
        const float from = (along - (float)BAR_CELL_X_MM * (float)(i - 3)) * model->along_scale;
        const float to = (along - (float)BAR_CELL_X_MM * (float)(j - 3)) * model->along_scale;
        const edge_profile_t a = edge_profile(from), b = edge_profile(to);
        sum += a.step - b.step;
        *ends += b.pulse - a.pulse;
        i = j;
    }
    return sum;
}

/** White coverage of a pixel, and its slope along the side's normal. */
static inline float coverage(const side_model_t *model, float s, float along, float *slope)
{
    const edge_profile_t edge = edge_profile_blurred(&model->blur, s);
    const float to_end = (model->end_at - fabsf(along)) * model->along_scale;
    float w = edge.step;
    *slope = edge.pulse;
    if (to_end < 3.5f) {
        const edge_profile_t there = edge_profile(to_end);
        const float lean = along < 0.f ? -model->lean : model->lean, z = s * model->per_sigma;
        w = 1.f - (1.f - w) * there.step -
            corner_excess(lean, -z, edge.pulse / model->per_sigma, to_end, there.pulse);
        *slope *= there.step + lean * z * there.pulse;
    }
    if (model->cells && (s - model->cell_near) * model->per_sigma > -3.5f) {
        const edge_profile_t near = edge_profile_blurred(&model->blur, s - model->cell_near),
                             far = edge_profile_blurred(&model->blur, s - model->cell_far);
        float ends;
        const float cells = cells_at(model, along, &ends);
        w -= cells * (near.step - far.step) +
             model->lean * ends * (far.pulse - near.pulse) / model->per_sigma;
    }
    return w;
}

static void add_line(fit_pixels_t *pixels, const side_model_t *model, const fit_line_t *line)
{
    int n = pixels->count;
    for (int k = 0; k < line->count; ++k, ++n) {
        const float s = line->s_first + (float)k * line->s_step;
        float slope;
        pixels->x[W][n] =
            coverage(model, s, line->along_first + (float)k * line->along_step, &slope);
        pixels->x[K][n] =
            model->ground > 0.f ? edge_profile_blurred(&model->blur, s - model->ground).step : 0.f;
        pixels->x[G][n] = slope;
        pixels->x[H][n] = -s * model->per_sigma * slope;
        pixels->i[n] = line->grey[k];
    }
    pixels->count = n;
}

/** Take regressor `p` out of the others and of the grey levels. */
static void sweep(double xx[REGRESSORS][REGRESSORS], double xi[REGRESSORS], int p)
{
    for (int a = p + 1; a < REGRESSORS; ++a) {
        const double part = xx[a][p] / xx[p][p];
        for (int b = p + 1; b <= a; ++b) {
            xx[a][b] -= part * xx[b][p];
        }
        xi[a] -= part * xi[p];
    }
}

/** Coefficients of W, K and G by back substitution after the sweeps. */
static void coefficients(double xx[REGRESSORS][REGRESSORS], const double xi[REGRESSORS], int ground,
                         double *contrast, double *slope, double *height)
{
    *slope = xi[G] / xx[G][G];
    *height = ground ? (xi[K] - xx[G][K] * *slope) / xx[K][K] : 0;
    *contrast = (xi[W] - xx[G][W] * *slope - xx[K][W] * *height) / xx[W][W];
}

int stretch_solve(const grey_levels_t *levels, stretch_t *out)
{
    if (out->clipped) {
        return 1; /* solved at once, and no level of white is to be had */
    }
    const int pixels = (int)out->sums.n;
    int ground = out->ground;
    fit_sums_t with_levels = out->sums;
    add_levels(&with_levels, levels);
    const fit_sums_t *sums = &with_levels;
    const double n = (double)sums->n;
    if (pixels < PIXELS_LEAST) {
        return 0;
    }
    double xx[REGRESSORS][REGRESSORS], xi[REGRESSORS];
    for (int a = 0; a < REGRESSORS; ++a) {
        xi[a] = (double)sums->xi[a] - (double)sums->x[a] * (double)sums->i / n;
        for (int b = 0; b <= a; ++b) {
            xx[a][b] = (double)sums->xx[a][b] - (double)sums->x[a] * (double)sums->x[b] / n;
        }
    }
    double rss = (double)sums->ii - (double)sums->i * (double)sums->i / n;
    const double whole[3] = {xx[W][W], xx[K][K], xx[G][G]};
    if (!(whole[0] > 0)) {
        return 0;
    }
    sweep(xx, xi, W);
    rss -= xi[W] * xi[W] / xx[W][W];
    if (ground && !(xx[K][K] > 1e-4 * whole[1])) {
        ground = 0; /* the window does not reach it */
    }
    if (ground) {
        sweep(xx, xi, K);
        rss -= xi[K] * xi[K] / xx[K][K];
    }
    if (!(xx[G][G] > 1e-3 * whole[2])) {
        return 0;
    }
    sweep(xx, xi, G);
    rss -= xi[G] * xi[G] / xx[G][G];
    double contrast, slope, height;
    coefficients(xx, xi, ground, &contrast, &slope, &height);
    if (!(contrast > 0)) {
        return 0;
    }
    out->pixels = (uint16_t)pixels;
    out->black = (float)(((double)sums->i - contrast * (double)sums->x[W] -
                          height * (double)sums->x[K] - slope * (double)sums->x[G]) /
                         n);
    out->contrast = (float)contrast;
    out->offset_px = out->expected_px + (float)(-slope / contrast);
    out->sigma_unit = (float)(1 / (sqrt(xx[G][G]) * contrast));
    /* A level that is known beforehand costs no freedom. */
    const double third = pixels / 3.0;
    const double solved = 1 + (ground ? 1 : 0) + third / (third + (double)levels->weight[0]) +
                          third / (third + (double)levels->weight[1]);
    out->variance = (float)((rss > 0 ? rss : 0) / (pixels - solved));
    /* What of the residual the blur would explain. */
    out->blur_weight = (float)(contrast * contrast * (xx[H][H] > 0 ? xx[H][H] : 0));
    out->blur_slope = (float)(contrast * xi[H]);
    return 1;
}

void stretch_sum(const side_model_t *model, const fit_line_t *lines, int count, stretch_t *out)
{
    int pixels = 0, saturated = 0;
    const float white = model->white_level - 0.5f;
    for (int i = 0; i < count; ++i) {
        pixels += lines[i].count;
        for (int k = 0; k < lines[i].count; ++k) {
            saturated += lines[i].grey[k] >= white;
        }
    }
    out->saturated = (uint16_t)saturated;
    out->clipped = 0;
    out->ground = model->ground > 0.f;
    fit_pixels_t columns;
    columns.count = 0;
    for (int i = 0; i < count && columns.count + lines[i].count <= PIXELS_MAX - LANES; ++i) {
        add_line(&columns, model, &lines[i]);
    }
    sum_pixels(&columns, out->ground, &out->sums);
}
