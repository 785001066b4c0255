/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/stretch_fit.h"

#include <math.h>

#include "bar/bar_code.h"
#include "bar/edge_lanes.h"
#include "bar/line_pixels.h"

/* grey = black + contrast w(s - offset), to first order in the offset, with w the white coverage
 * and g = dw/ds: linear in black, contrast and contrast times offset. Next to the bar's border the
 * ground begins, of unknown brightness: one more step, k, with a height of its own. One more
 * regressor, h, the derivative of w by the blur, is not solved for here: what it would explain of
 * the residual is handed on, and summed over the picture by the caller. So is what an error of the
 * blur, and of the place of the code cells, makes of the offset. Pictures whose white
 * saturates are left to stretch_clip.c. */

#define PIXELS_LEAST 10

#define REACH STRETCH_REACH

/** The pixels of a stretch, and the regressors of its fit. */
typedef struct fit_pixels {
    line_pixels_t of;
    float x[REGRESSORS][PIXELS_MAX];
} fit_pixels_t;

/** Sum up the columns; column K only where there is ground, C where there are cells. */
static void sum_pixels(const fit_pixels_t *pixels, int ground, int cells, fit_sums_t *sums)
{
    lanes_t i = {0}, ii = {0}, x[REGRESSORS] = {{0}}, xi[REGRESSORS] = {{0}},
            xx[REGRESSORS][REGRESSORS] = {{{0}}};
    for (int k = 0; k < pixels->of.count; k += LANES) {
        const lanes_t grey = lanes_load(&pixels->of.grey[k]);
        const lanes_t w = lanes_load(&pixels->x[W][k]), g = lanes_load(&pixels->x[G][k]);
        const lanes_t h = lanes_load(&pixels->x[H][k]);
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
            const lanes_t step = lanes_load(&pixels->x[K][k]);
            x[K] += step;
            xi[K] += step * grey;
            xx[K][W] += step * w;
            xx[K][K] += step * step;
            xx[G][K] += g * step;
            xx[H][K] += h * step;
        }
        if (cells) {
            const lanes_t c = lanes_load(&pixels->x[C][k]);
            x[C] += c;
            xx[C][W] += c * w;
            xx[C][G] += c * g;
        }
    }
    sums->n = (float)pixels->of.count;
    sums->i = lanes_sum(i);
    sums->ii = lanes_sum(ii);
    for (int a = 0; a < REGRESSORS; ++a) {
        sums->x[a] = lanes_sum(x[a]);
        sums->xi[a] = lanes_sum(xi[a]);
        for (int b = 0; b <= a; ++b) {
            sums->xx[a][b] = lanes_sum(xx[a][b]);
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

cell_ends_t stretch_cell_ends(const side_model_t *model, float low, float high)
{
    cell_ends_t ends = {.count = 0};
    const float reach = REACH / model->along_scale;
    unsigned before = 0;
    for (int i = 0; i <= BAR_CELLS; ++i) {
        const unsigned black = i < BAR_CELLS ? model->cells >> i & 1u : 0;
        const float at = (float)BAR_CELL_X_MM * (float)(i - 3), sign = (float)black - (float)before;
        if (black == before || at > high + reach) {
            continue;
        }
        if (at < low - reach) {
            ends.base += sign;
        } else {
            ends.at_mm[ends.count] = at;
            ends.sign[ends.count++] = sign;
        }
        before = black;
    }
    return ends;
}

/** How much of the code cells is black at positions along the side, under the blur; `ends` gets
 * what the lean adds to that. */
static inline lanes_t cells_at(const side_model_t *model, const cell_ends_t *near, lanes_t along,
                               lanes_t *ends)
{
    lanes_t sum = lanes_of(near->base);
    *ends = lanes_of(0.f);
    for (int i = 0; i < near->count; ++i) {
        const normal_lanes_t end = normal_lanes((along - near->at_mm[i]) * model->along_scale);
        sum += near->sign[i] * end.step;
        *ends += near->sign[i] * end.pulse;
    }
    return sum;
}

/** What the model has within reach of a stretch. */
typedef struct stretch_parts {
    int end, cells, cells_far, ground;
    cell_ends_t cell_ends;
} stretch_parts_t;

static stretch_parts_t parts_of(const side_model_t *model, const fit_pixels_t *pixels)
{
    const float low = pixels->of.along_low, high = pixels->of.along_high;
    stretch_parts_t parts = {.end = 0};
    parts.end = (model->end_at - (high > -low ? high : -low)) * model->along_scale < REACH;
    if (model->cells && (pixels->of.s_high - model->cell_near) * model->per_sigma > -REACH) {
        parts.cell_ends = stretch_cell_ends(model, low, high);
        parts.cells = parts.cell_ends.count > 0 || parts.cell_ends.base > 0.f;
        parts.cells_far = (pixels->of.s_high - model->cell_far) * model->per_sigma > -REACH;
    }
    return parts;
}

/** White coverage of pixels, its slope along the side's normal, and that of the code cells' borders
 * alone. */
typedef struct coverage {
    lanes_t white, slope, cells_slope;
} coverage_t;

static inline coverage_t coverage(const side_model_t *model, const stretch_parts_t *parts,
                                  lanes_t s, lanes_t along)
{
    const normal_lanes_t edge = edge_lanes_blurred(&model->blur, s);
    const float sigma = 1.f / model->per_sigma;
    coverage_t of = {edge.step, edge.pulse, lanes_of(0.f)};
    if (parts->end) {
        const lanes_t to_end = (model->end_at - lanes_abs(along)) * model->along_scale;
        const normal_lanes_t there = normal_lanes(to_end);
        const lanes_t lean =
            lanes_pick(along < 0.f, lanes_of(-model->lean), lanes_of(model->lean));
        const lanes_t z = s * model->per_sigma;
        of.white = 1.f - (1.f - edge.step) * there.step -
                   corner_excess(lean, -z, edge.pulse * sigma, to_end, there.pulse);
        of.slope *= there.step + lean * z * there.pulse;
    }
    if (parts->cells) {
        normal_lanes_t across = edge_lanes_blurred(&model->blur, s - model->cell_near);
        if (parts->cells_far) {
            const normal_lanes_t far = edge_lanes_blurred(&model->blur, s - model->cell_far);
            across.step -= far.step;
            across.pulse -= far.pulse;
        }
        lanes_t ends;
        const lanes_t cells = cells_at(model, &parts->cell_ends, along, &ends);
        of.white -= cells * across.step;
        of.white -= ends * across.pulse * (model->lean * sigma);
        of.cells_slope = cells * across.pulse;
    }
    return of;
}

/** The regressors of all pixels. */
static void model_pixels(const side_model_t *model, const stretch_parts_t *parts,
                         fit_pixels_t *pixels)
{
    for (int k = 0; k < pixels->of.count; k += LANES) {
        const lanes_t s = lanes_load(&pixels->of.s[k]), along = lanes_load(&pixels->of.along[k]);
        const coverage_t of = coverage(model, parts, s, along);
        lanes_store(&pixels->x[W][k], of.white);
        lanes_store(&pixels->x[G][k], of.slope);
        lanes_store(&pixels->x[H][k], s * of.slope * -model->per_sigma);
        if (parts->cells) {
            lanes_store(&pixels->x[C][k], of.cells_slope);
        }
        if (parts->ground) {
            lanes_store(&pixels->x[K][k],
                        edge_lanes_blurred(&model->blur, s - model->ground).step);
        }
    }
    for (int k = pixels->of.count; k % LANES != 0; ++k) { /* what fills up counts for nothing */
        for (int a = 0; a < REGRESSORS; ++a) {
            pixels->x[a][k] = 0.f;
        }
    }
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
    const double by_blur = xx[H][G] / xx[G][G], by_cells = xx[C][G] / xx[G][G];
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
    /* H is swept of G by now: what was taken out is what the blur moves. */
    out->by_blur = (float)-by_blur;
    out->by_cells = (float)by_cells;
    return 1;
}

void stretch_sum(const side_model_t *model, const fit_line_t *lines, int count, stretch_t *out)
{
    fit_pixels_t pixels;
    line_pixels_gather(&pixels.of, lines, count);
    out->saturated = (uint16_t)line_pixels_saturated(&pixels.of, model->white_level - 0.5f);
    out->clipped = 0;
    out->ground = model->ground > 0.f;
    stretch_parts_t parts = parts_of(model, &pixels);
    parts.ground = out->ground;
    model_pixels(model, &parts, &pixels);
    sum_pixels(&pixels, out->ground, parts.cells, &out->sums);
}
