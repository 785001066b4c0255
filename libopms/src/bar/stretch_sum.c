/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/stretch_fit.h"

#include "bar/bar_code.h"
#include "bar/edge_wide.h"
#include "bar/line_pixels.h"

/* The regressors of all pixels of a stretch (stretch_fit.c says which), summed up as they are made:
 * none is ever stored. Two stretches are summed up side by side, four lines of each at a time, a
 * line a lane. So pixels equally far from the edge are together, and only those that the code
 * cells, the side's end or the ground reach have these in their model. */

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

/** Eight lines, four of each stretch; the first pixel of each comes first. */
typedef struct line_lanes {
    wide_t s, along, along_step, count;
    int ranks;                       /**< pixels of the longest line */
    float s_step, s_high;            /**< s_high: of the first pixels */
    uint16_t grey[LINE_PIXELS_MAX][WIDE];
} line_lanes_t;

/** What the model has within reach of these lines. */
typedef struct stretch_parts {
    int end, cells, cells_far, ground;
    float cells_from, ground_from; /**< distances from the edge from where on they count */
    cell_ends_t cell_ends;
} stretch_parts_t;

/** Fill one lane with a line's grey levels. */
WIDE_INLINE void load_grey(const fit_lines_t *lines, const fit_line_t *line, int lane,
                           line_lanes_t *to)
{
    const uint8_t *at = line->first;
    const ptrdiff_t step = lines->pixel_bytes;
    int k = 0;
    if (lines->wide) {
        for (; k < line->count; ++k, at += step) {
            to->grey[k][lane] = *(const uint16_t *)(const void *)at;
        }
    } else {
        for (; k < line->count; ++k, at += step) {
            to->grey[k][lane] = *at;
        }
    }
    for (; k < to->ranks; ++k) {
        to->grey[k][lane] = 0;
    }
}

/** Gather the lines from number `from` on. */
WIDE_INLINE void load_lines(const fit_lines_t lines[2], int from, float *low, float *high,
                            line_lanes_t *to)
{
    static const fit_line_t none = {.count = 0};
    const fit_line_t *line[WIDE];
    float s[WIDE], along[WIDE], along_step[WIDE], count[WIDE];
    to->ranks = 0;
    to->s_high = *high = -1e30f;
    to->s_step = 0.f;
    *low = 1e30f;
    for (int lane = 0; lane < WIDE; ++lane) {
        const fit_lines_t *of = &lines[lane >= WIDE / 2];
        const int number = from + lane % (WIDE / 2);
        const fit_line_t *l = number < of->count ? &of->line[number] : &none;
        line[lane] = l;
        s[lane] = l->s_first;
        along[lane] = l->along_first;
        along_step[lane] = l->along_step;
        count[lane] = (float)l->count;
        if (l->count > 0) {
            const float last = l->along_first + (count[lane] - 1.f) * l->along_step;
            to->ranks = l->count > to->ranks ? l->count : to->ranks;
            to->s_high = larger_of(to->s_high, l->s_first);
            to->s_step = l->s_step;
            *low = -larger_of(-*low, larger_of(-l->along_first, -last));
            *high = larger_of(*high, larger_of(l->along_first, last));
        }
    }
    for (int lane = 0; lane < WIDE; ++lane) {
        load_grey(&lines[lane >= WIDE / 2], line[lane], lane, to);
    }
    to->s = wide_load(s);
    to->along = wide_load(along);
    to->along_step = wide_load(along_step);
    to->count = wide_load(count);
}

WIDE_INLINE void parts_of(const side_model_t *model, const line_lanes_t *lines, float low,
                          float high, stretch_parts_t *parts)
{
    const float reach = REACH * model->sigma;
    const float s_most = larger_of(
        lines->s_high, lines->s_high + (float)(lines->ranks - 1) * lines->s_step);
    parts->end = (model->end_at - larger_of(high, -low)) * model->along_scale < REACH;
    parts->cells_from = model->cell_near - reach;
    parts->cells = parts->cells_far = parts->cell_ends.count = 0;
    parts->cell_ends.base = 0.f;
    parts->ground = model->ground > 0.f;
    parts->ground_from = model->ground - NORMAL_WIDE_REACH * model->sigma;
    if (model->cells && s_most > parts->cells_from) {
        stretch_cell_ends(model, low, high, &parts->cell_ends);
        parts->cells = parts->cell_ends.count > 0 || parts->cell_ends.base > 0.f;
        parts->cells_far = s_most > model->cell_far - reach;
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
    normal_wide_t across = {wide_of(0.f), wide_of(0.f)};
    for (int far = 0; far <= parts->cells_far; ++far) {
        const float at = far ? model->cell_far : model->cell_near, sign = far ? -1.f : 1.f;
        const normal_wide_t border = edge_wide_blurred(&model->blur, s - at);
        across.step += sign * border.step;
        across.pulse += sign * border.pulse;
    }
    wide_t ends;
    const wide_t cells = cells_at(model, &parts->cell_ends, along, &ends);
    of->white -= cells * across.step;
    of->white -= ends * across.pulse * (model->lean * model->sigma);
    of->cells_slope = cells * across.pulse;
}

/** Lanes of the sums of edge_fit.h. */
typedef struct lane_sums {
    wide_t i, ii, w, wi, ww, g, gi, gw, gg, h, hi, hw, hg, hh;
    wide_t c, cw, cg, k, ki, kw, kg, kh, kk;
    wide_int_t saturated;
} lane_sums_t;

WIDE_INLINE void add_edge(wide_t i, wide_t w, wide_t g, wide_t h, lane_sums_t *sum)
{
    sum->i += i;
    sum->ii += i * i;
    sum->w += w;
    sum->wi += w * i;
    sum->ww += w * w;
    sum->g += g;
    sum->gi += g * i;
    sum->gw += g * w;
    sum->gg += g * g;
    sum->h += h;
    sum->hi += h * i;
    sum->hw += h * w;
    sum->hg += h * g;
    sum->hh += h * h;
}

WIDE_INLINE void add_ground(wide_t k, wide_t i, wide_t w, wide_t g, wide_t h, lane_sums_t *sum)
{
    sum->k += k;
    sum->ki += k * i;
    sum->kw += k * w;
    sum->kg += k * g;
    sum->kh += k * h;
    sum->kk += k * k;
}

/** Sum up eight lines. */
WIDE_INLINE void sum_lines(const side_model_t *model, const stretch_parts_t *parts,
                           const line_lanes_t *lines, lane_sums_t *sum)
{
    const wide_t nearly_white = wide_of(model->white_level - 0.5f);
    for (int rank = 0; rank < lines->ranks; ++rank) {
        const float n = (float)rank;
        const wide_int_t used = wide_less(wide_of(n), lines->count);
        const wide_t s = lines->s + n * lines->s_step, i = wide_load_short(lines->grey[rank]);
        const float s_high = lines->s_high + n * lines->s_step;
        const normal_wide_t edge = edge_wide_blurred(&model->blur, s);
        coverage_t of = {edge.step, edge.pulse, wide_of(0.f)};
        const int at_cells = parts->cells && s_high > parts->cells_from;
        const wide_t along = lines->along + n * lines->along_step;
        if (parts->end) {
            add_end(model, s, along, &of);
        }
        if (at_cells) {
            add_cells(model, parts, s, along, &of);
        }
        const wide_t w = wide_where(used, of.white), g = wide_where(used, of.slope);
        const wide_t h = s * g * -model->per_sigma;
        add_edge(i, w, g, h, sum);
        sum->saturated += wide_less(nearly_white, i);
        if (at_cells) {
            const wide_t c = wide_where(used, of.cells_slope);
            sum->c += c;
            sum->cw += c * w;
            sum->cg += c * g;
        }
        if (parts->ground && s_high > parts->ground_from) {
            const wide_t ground = edge_wide_blurred(&model->blur, s - model->ground).step;
            add_ground(wide_where(used, ground), i, w, g, h, sum);
        }
    }
}

WIDE_INLINE void write_four(wide_t a, wide_t b, wide_t c, wide_t d, int first,
                            fit_sums_t *const sums[2])
{
    const wide_t four[4] = {a, b, c, d};
    wide_half_sums(four, &sums[0]->of[first], &sums[1]->of[first]);
}

WIDE_INLINE void write_sums(const lane_sums_t *sum, int others, fit_sums_t *const sums[2])
{
    const wide_t none = wide_of(0.f);
    write_four(sum->i, sum->ii, sum->w, sum->wi, SUM_I, sums);
    write_four(sum->ww, sum->g, sum->gi, sum->gw, SUM_WW, sums);
    write_four(sum->gg, sum->h, sum->hi, sum->hw, SUM_GG, sums);
    write_four(sum->hg, sum->hh, none, none, SUM_HG, sums);
    if (others) {
        write_four(sum->c, sum->cw, sum->cg, none, SUM_C, sums);
        write_four(sum->k, sum->ki, sum->kw, sum->kg, SUM_K, sums);
        write_four(sum->kh, sum->kk, none, none, SUM_KH, sums);
    }
}

static int pixels_of(const fit_lines_t *lines)
{
    int pixels = 0;
    for (int i = 0; i < lines->count; ++i) {
        pixels += lines->line[i].count;
    }
    return pixels;
}

WIDE_INLINE void sum_two(const side_model_t *model, const fit_lines_t lines[2],
                         stretch_t *const out[2], fit_sums_t *const sums[2])
{
    const int most = lines[0].count > lines[1].count ? lines[0].count : lines[1].count;
    lane_sums_t sum;
    memset(&sum, 0, sizeof sum);
    int others = 0, cells = 0;
    for (int from = 0; from < most; from += WIDE / 2) {
        line_lanes_t eight;
        stretch_parts_t parts;
        float low, high;
        load_lines(lines, from, &low, &high, &eight);
        parts_of(model, &eight, low, high, &parts);
        cells |= parts.cells;
        others |= parts.end || parts.cells || parts.ground;
        sum_lines(model, &parts, &eight, &sum);
    }
    write_sums(&sum, others, sums);
    for (int half = 0; half < 2; ++half) {
        int saturated = 0;
        for (int lane = 0; lane < WIDE / 2; ++lane) {
            saturated -= sum.saturated[half * (WIDE / 2) + lane];
        }
        sums[half]->n = (float)pixels_of(&lines[half]);
        out[half]->saturated = (uint16_t)saturated;
        out[half]->shaped = 0;
        out[half]->ground = model->ground > 0.f;
        out[half]->cells = (uint8_t)cells;
    }
}

void stretch_sum_plain(const side_model_t *model, const fit_lines_t lines[2],
                       stretch_t *const out[2], fit_sums_t *const sums[2])
{
    sum_two(model, lines, out, sums);
}

WIDE_AVX2 void stretch_sum_avx2(const side_model_t *model, const fit_lines_t lines[2],
                                stretch_t *const out[2], fit_sums_t *const sums[2])
{
    sum_two(model, lines, out, sums);
}
