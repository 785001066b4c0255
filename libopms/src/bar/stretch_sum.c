/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/stretch_fit.h"

#include "bar/bar_code.h"
#include "bar/edge_wide.h"
#include "bar/line_pixels.h"

/* The regressors of all pixels of a stretch (stretch_fit.c says which), summed up as they are made:
 * none is ever stored. Half of the stretches lie away from the side's ends, from the code cells and
 * from the ground; theirs is a loop of its own. */

#define REACH STRETCH_REACH

/** How much of the code cells is black at positions along the side, under the blur; `ends` gets
 * what the lean adds to that. */
WIDE_INLINE wide_t cells_at(const side_model_t *model, const cell_ends_t *near, wide_t along,
                            wide_t *ends)
{
    wide_t sum = wide_of(near->base);
    *ends = wide_of(0.f);
    for (int i = 0; i < near->count; ++i) {
        const normal_wide_t end = normal_wide((along - near->at_mm[i]) * model->along_scale);
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

WIDE_INLINE void parts_of(const side_model_t *model, const line_pixels_t *pixels,
                          stretch_parts_t *parts)
{
    const float low = pixels->along_low, high = pixels->along_high;
    parts->end = (model->end_at - larger_of(high, -low)) * model->along_scale < REACH;
    parts->cells = parts->cells_far = parts->cell_ends.count = 0;
    parts->cell_ends.base = 0.f;
    parts->ground = model->ground > 0.f;
    if (model->cells && (pixels->s_high - model->cell_near) * model->per_sigma > -REACH) {
        stretch_cell_ends(model, low, high, &parts->cell_ends);
        parts->cells = parts->cell_ends.count > 0 || parts->cell_ends.base > 0.f;
        parts->cells_far = (pixels->s_high - model->cell_far) * model->per_sigma > -REACH;
    }
}

/** White coverage of pixels, its slope along the side's normal, and that of the code cells' borders
 * alone. */
typedef struct coverage {
    wide_t white, slope, cells_slope;
} coverage_t;

/** The side's end, beyond which there is white. */
WIDE_INLINE void add_end(const side_model_t *model, wide_t s, wide_t along, coverage_t *of)
{
    const wide_t to_end = (model->end_at - wide_abs(along)) * model->along_scale;
    const normal_wide_t there = normal_wide(to_end);
    const wide_t lean = wide_signed(wide_of(model->lean), along);
    const wide_t z = s * model->per_sigma;
    of->white = 1.f - (1.f - of->white) * there.step -
                corner_excess(lean, -z, of->slope * model->sigma, to_end, there.pulse);
    of->slope *= there.step + lean * z * there.pulse;
}

/** The code cells beyond the gap. */
WIDE_INLINE void add_cells(const side_model_t *model, const stretch_parts_t *parts, wide_t s,
                           wide_t along, coverage_t *of)
{
    normal_wide_t across = edge_wide_blurred(&model->blur, s - model->cell_near);
    if (parts->cells_far) {
        const normal_wide_t far = edge_wide_blurred(&model->blur, s - model->cell_far);
        across.step -= far.step;
        across.pulse -= far.pulse;
    }
    wide_t ends;
    const wide_t cells = cells_at(model, &parts->cell_ends, along, &ends);
    of->white -= cells * across.step;
    of->white -= ends * across.pulse * (model->lean * model->sigma);
    of->cells_slope = cells * across.pulse;
}

/** The sums of all pixels. `alone` is a constant: nothing but the edge is within reach of them. */
WIDE_INLINE int sum_pixels(const side_model_t *model, const stretch_parts_t *parts,
                           const line_pixels_t *pixels, int alone, float sums[SUMS])
{
    const wide_t nearly_white = wide_of(model->white_level - 0.5f);
    wide_t sum[SUMS] = {{0}};
    wide_int_t saturated = {0};
    for (int k = 0; k < pixels->count; k += WIDE) {
        const wide_int_t used = wide_first(pixels->count - k);
        const wide_t s = wide_load(&pixels->s[k]), i = wide_load(&pixels->grey[k]);
        const normal_wide_t edge = edge_wide_blurred(&model->blur, s);
        coverage_t of = {edge.step, edge.pulse, wide_of(0.f)};
        if (!alone) {
            const wide_t along = wide_load(&pixels->along[k]);
            if (parts->end) {
                add_end(model, s, along, &of);
            }
            if (parts->cells) {
                add_cells(model, parts, s, along, &of);
                const wide_t c = wide_where(used, of.cells_slope);
                sum[SUM_C] += c;
                sum[SUM_CW] += c * of.white;
                sum[SUM_CG] += c * of.slope;
            }
        }
        const wide_t w = wide_where(used, of.white), g = wide_where(used, of.slope);
        const wide_t h = s * g * -model->per_sigma;
        saturated += wide_less(nearly_white, i);
        sum[SUM_I] += i;
        sum[SUM_II] += i * i;
        sum[SUM_W] += w;
        sum[SUM_WI] += w * i;
        sum[SUM_WW] += w * w;
        sum[SUM_G] += g;
        sum[SUM_GI] += g * i;
        sum[SUM_GW] += g * w;
        sum[SUM_GG] += g * g;
        sum[SUM_H] += h;
        sum[SUM_HI] += h * i;
        sum[SUM_HW] += h * w;
        sum[SUM_HG] += h * g;
        sum[SUM_HH] += h * h;
        if (!alone && parts->ground) {
            const wide_t ground = edge_wide_blurred(&model->blur, s - model->ground).step;
            const wide_t step = wide_where(used, ground);
            sum[SUM_K] += step;
            sum[SUM_KI] += step * i;
            sum[SUM_KW] += step * w;
            sum[SUM_KG] += step * g;
            sum[SUM_KH] += step * h;
            sum[SUM_KK] += step * step;
        }
    }
    for (int a = 0; a < SUMS; a += 4) {
        wide_sums(&sum[a], &sums[a]);
    }
    return wide_count(saturated);
}

WIDE_INLINE void sum_stretch(const side_model_t *model, const fit_lines_t *lines, stretch_t *out,
                             fit_sums_t *sums)
{
    line_pixels_t pixels;
    stretch_parts_t parts;
    line_pixels_gather(&pixels, lines);
    parts_of(model, &pixels, &parts);
    const int alone = !parts.end && !parts.cells && !parts.ground;
    const int saturated = alone ? sum_pixels(model, &parts, &pixels, 1, sums->of)
                                : sum_pixels(model, &parts, &pixels, 0, sums->of);
    sums->n = (float)pixels.count;
    out->saturated = (uint16_t)saturated;
    out->clipped = 0;
    out->ground = (uint8_t)parts.ground;
    out->cells = (uint8_t)parts.cells;
}

void stretch_sum_plain(const side_model_t *model, const fit_lines_t *lines, stretch_t *out,
                       fit_sums_t *sums)
{
    sum_stretch(model, lines, out, sums);
}

WIDE_AVX2 void stretch_sum_avx2(const side_model_t *model, const fit_lines_t *lines,
                                stretch_t *out, fit_sums_t *sums)
{
    sum_stretch(model, lines, out, sums);
}
