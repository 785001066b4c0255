/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/map_refine.h"

#include <math.h>
#include <string.h>

#include "bar/bar_code.h"
#include "bar/solve_spd.h"

/* Passes of: measure the stretches where the map expects them, throw out those that cannot be a
 * side of this bar, fit map and common shift to the rest (Tukey's weights), take over the blur that
 * the profiles ask for. The first passes scout with a few squares spread over the range that is
 * known; the range grows with what has been confirmed, so that the map is never asked for more than
 * it knows. Then all squares are measured, once if nothing moves any more. */

#define UNKNOWNS 9
#define SCOUTING_MOST 14
#define SCOUTING_SQUARES 6
#define SCOUTING_STEP 2     /* lines of pixels */
#define SCOUTED_PX 0.12f     /* movement after which all squares are measured */
#define SHAPED 0.04f        /* change of blur (px) or clip that counts as none */
#define SCOUTED_BLUR 0.06f
#define UNSHAPED 0.1f       /* such a change at the end means that nothing settles */
#define PASSES_MOST 5
#define SETTLED_PX 0.02f    /* movement after which no further pass is needed */
#define BORDER_REACH_PX 40.0 /* a square's middle may lie this far outside and a side be seen */
#define SCALE_SAMPLE 160
#define TUKEY 4.685f
#define GOOD_LEAST 12
#define BLUR_LEAST 0.25
#define SHARED_BLUR 0.12      /* relative difference of the families' blurs that counts as none */
#define LEVEL_SCATTER_LEAST 0.12f /* of black and white over the picture, in noises */
#define CLIP_LEAST 0.15
#define CLIP_OF_STILL 0.58
#define CLIP_OF_MOTION 0.35
#define SHIFT_OF_STILL_PX 0.8
#define MOTION_RATIO 1.3
#define SATURATED_LEAST 0.05 /* part of the pixels next to the sides that makes white saturated */
#define BLUR_MOST 4.0

/** Median by selection, in place: a few of the values end up in order, the rest does not. */
static float median(float *values, int count)
{
    const int rank = count / 2;
    int low = 0, high = count - 1;
    while (low < high) {
        const float pivot = values[(low + high) / 2];
        int i = low, j = high;
        while (i <= j) {
            while (values[i] < pivot) {
                ++i;
            }
            while (values[j] > pivot) {
                --j;
            }
            if (i <= j) {
                const float kept = values[i];
                values[i++] = values[j];
                values[j--] = kept;
            }
        }
        if (rank <= j) {
            high = j;
        } else if (rank >= i) {
            low = i;
        } else {
            break;
        }
    }
    return values[rank];
}

/** Squares of a range that can be seen, at most `most` of them, evenly spread with both ends. */
static int visible_squares(const edge_scene_t *scene, int from, int to, int most, int *index)
{
    int seen[OPMS_BAR_SQUARES], n = 0;
    for (int k = from; k <= to; ++k) {
        double px[2];
        if (plane_map_project(&scene->map, scene->lens, scene->ray_limit, 0,
                              BAR_PITCH_MM * (k - OPMS_BAR_ORIGIN), px, NULL) &&
            view_holds(scene->view, px[0], px[1], -BORDER_REACH_PX)) {
            seen[n++] = k;
        }
    }
    const int count = n < most ? n : most;
    for (int i = 0; i < count; ++i) {
        index[i] = count == n ? seen[i] : seen[i * (n - 1) / (count - 1)];
    }
    return count;
}

static void measure(const edge_scene_t *scene, const int *index, int count, bar_fit_t *fit)
{
    fit->count = 0;
    for (int i = 0; i < count; ++i) {
        fit->count += edge_fit_square(scene, index[i], &fit->levels, &fit->stretch[fit->count]);
    }
}

static float expected_shift(const edge_scene_t *scene, const stretch_t *s)
{
    return (float)(scene->shift_px * scene->shift_gain[s->side & 1]);
}

/** Mark the stretches that look like this bar's sides; returns how many. */
static int select_good(bar_fit_t *fit, float contrast_least, float offset_most, const edge_scene_t *scene)
{
    static const float variance_most = 9.f; /* times the median: grass, a cell that was not foreseen */
    float *scratch = fit->residual;
    int n = 0;
    for (int i = 0; i < fit->count; ++i) {
        fit->good[i] = fit->stretch[i].contrast >= contrast_least;
        if (fit->good[i]) {
            scratch[n++] = fit->stretch[i].contrast;
        }
    }
    if (n < GOOD_LEAST) {
        return 0;
    }
    fit->contrast = median(scratch, n);
    n = 0;
    for (int i = 0; i < fit->count; ++i) {
        fit->good[i] = fit->good[i] && fit->stretch[i].contrast > 0.3f * fit->contrast &&
                       fit->stretch[i].contrast < 3.f * fit->contrast &&
                       fabsf(fit->stretch[i].offset_px - expected_shift(scene, &fit->stretch[i])) < offset_most;
        if (fit->good[i]) {
            scratch[n++] = fit->stretch[i].variance;
        }
    }
    if (n < GOOD_LEAST) {
        return 0;
    }
    const float variance = median(scratch, n) + 0.08f; /* quantisation at the least */
    fit->noise = sqrtf(variance);
    n = 0;
    for (int i = 0; i < fit->count; ++i) {
        const stretch_t *s = &fit->stretch[i];
        if (!fit->good[i] || s->variance > variance_most * variance) {
            fit->good[i] = 0;
            continue;
        }
        /* A stretch's own variance, drawn towards the picture's by as much weight again. */
        const float own = (float)s->pixels;
        const float mixed = (own * s->variance + 20.f * variance) / (own + 20.f);
        fit->sigma[i] = s->sigma_unit * sqrtf(mixed > variance ? mixed : variance);
        ++n;
    }
    return n;
}

static void linearise(const edge_scene_t *scene, bar_fit_t *fit)
{
    for (int i = 0; i < fit->count; ++i) {
        if (!fit->good[i]) {
            continue;
        }
        const stretch_t *s = &fit->stretch[i];
        const double square_y = BAR_PITCH_MM * (s->square - OPMS_BAR_ORIGIN);
        const int along_y = s->side == 0 || s->side == 2;
        const double at = (s->side < 2 ? -BAR_HALF_SQUARE_MM : BAR_HALF_SQUARE_MM);
        double px[2], grad[16];
        plane_map_gradient(&scene->map, scene->lens, along_y ? at : (double)s->along_mm,
                           square_y + (along_y ? (double)s->along_mm : at), px, grad);
        for (int k = 0; k < 8; ++k) {
            fit->row[i][k] = (float)((double)s->normal[0] * grad[k] + (double)s->normal[1] * grad[8 + k]);
        }
        fit->row[i][8] = (float)scene->shift_gain[s->side & 1];
    }
}

/** Residuals of the good stretches for a change of the map; returns their robust scale in sigmas. */
static float residuals(bar_fit_t *fit, const double change[UNKNOWNS], float *scratch)
{
    int n = 0;
    for (int i = 0; i < fit->count; ++i) {
        if (!fit->good[i]) {
            continue;
        }
        double model = 0;
        for (int k = 0; k < UNKNOWNS; ++k) {
            model += (double)fit->row[i][k] * change[k];
        }
        fit->residual[i] = fit->stretch[i].offset_px - (float)model;
        if (n < SCALE_SAMPLE || i % 4 == 0) {
            scratch[n++] = fabsf(fit->residual[i]) / fit->sigma[i];
        }
    }
    const float scale = 1.4826f * median(scratch, n);
    return scale < 1.f ? 1.f : scale;
}

/** Robust linear fit of map and shift; 0 when singular. */
static int fit_map(bar_fit_t *fit, double change[UNKNOWNS], float *scale)
{
    float scratch[OPMS_BAR_EDGES_MAX];
    *scale = residuals(fit, change, scratch) * 3.f; /* wide at first */
    for (int round = 0; round < 3; ++round) {
        double normal[UNKNOWNS * UNKNOWNS] = {0}, rhs[UNKNOWNS] = {0};
        for (int i = 0; i < fit->count; ++i) {
            if (!fit->good[i]) {
                continue;
            }
            const float z = fit->residual[i] / (fit->sigma[i] * *scale * TUKEY);
            if (z * z >= 1.f) {
                continue;
            }
            const float w = (1.f - z * z) * (1.f - z * z) / (fit->sigma[i] * fit->sigma[i]);
            for (int j = 0; j < UNKNOWNS; ++j) {
                const double wr = (double)(w * fit->row[i][j]);
                for (int k = 0; k <= j; ++k) {
                    normal[UNKNOWNS * j + k] += wr * (double)fit->row[i][k];
                }
                rhs[j] += wr * (double)fit->stretch[i].offset_px;
            }
        }
        for (int j = 0; j < UNKNOWNS; ++j) {
            normal[UNKNOWNS * j + j] *= 1 + 1e-9;
        }
        if (!spd_factor(normal, UNKNOWNS)) {
            return 0;
        }
        spd_solve(normal, UNKNOWNS, rhs);
        memcpy(change, rhs, sizeof rhs);
        *scale = residuals(fit, change, scratch);
    }
    return 1;
}

/** Take over the blur that the profiles ask for. Both families share one, the lens's, unless they
 * differ for certain: then the picture moved. */
static void update_blur(edge_scene_t *scene, const bar_fit_t *fit)
{
    double slope[2] = {0, 0}, weight[2] = {0, 0}, scale[2] = {0, 0}, blur[2];
    for (int i = 0; i < fit->count; ++i) {
        const stretch_t *s = &fit->stretch[i];
        if (fit->good[i]) {
            const int family = s->side & 1;
            slope[family] += (double)s->blur_slope;
            weight[family] += (double)s->blur_weight;
            scale[family] += (double)(s->blur_weight * s->px_per_mm);
        }
    }
    if (!(weight[0] > 0 && weight[1] > 0)) {
        return;
    }
    for (int family = 0; family < 2; ++family) {
        blur[family] = scene->blur_px[family] + fmax(-0.4, fmin(0.6, slope[family] / weight[family]));
        scene->blur_scale[family] = scale[family] / weight[family];
    }
    const double mean = (weight[0] * blur[0] + weight[1] * blur[1]) / (weight[0] + weight[1]);
    const double sigma = (double)fit->noise * sqrt(1 / weight[0] + 1 / weight[1]);
    const int shared = scene->still || fabs(blur[0] - blur[1]) < fmax(SHARED_BLUR * mean, 4 * sigma);
    for (int family = 0; family < 2; ++family) {
        scene->blur_px[family] = fmin(BLUR_MOST, fmax(BLUR_LEAST, shared ? mean : blur[family]));
    }
}

static double saturated_part(const bar_fit_t *fit)
{
    double pixels = 0, saturated = 0;
    for (int i = 0; i < fit->count; ++i) {
        if (fit->good[i]) {
            pixels += fit->stretch[i].pixels;
            saturated += fit->stretch[i].saturated;
        }
    }
    return pixels > 0 ? saturated / pixels : 0;
}

/** By how many true blurs a Gaussian step that is cut at `clip` seems shifted into the light. */
static double shift_of_clip(double clip)
{
    /* A fit to the least-squares shift of a plain step fitted to a cut one, 0.2 to 1. */
    const double open = 1 - clip;
    return open * (1.1543 + open * (1.1761 + open * (-2.3947 + open * 2.0922)));
}

/** The clip at which a Gaussian step seems shifted by that much; the inverse of shift_of_clip(). */
static double clip_of_shift(double shift)
{
    double low = CLIP_LEAST, high = 1;
    for (int i = 0; i < 20; ++i) {
        const double middle = 0.5 * (low + high);
        if (shift_of_clip(middle) > shift) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return 0.5 * (low + high);
}

/** First guess of the clip from a fit without it: a profile that is cut seems shifted into the light
 * and narrower. The table is that fit to a cut Gaussian step. */
static void guess_clip(edge_scene_t *scene)
{
    static const struct {
        double shift, clip, narrowing; /* shift in apparent blurs; apparent blur over true blur */
    } table[] = {{0, 1, 1},           {0.142, 0.9, 0.864}, {0.348, 0.8, 0.758},
                 {0.598, 0.7, 0.677}, {0.902, 0.6, 0.609}, {1.279, 0.5, 0.549},
                 {1.760, 0.4, 0.495}, {2.409, 0.3, 0.442}, {3.382, 0.2, 0.386}};
    const double shift = -scene->shift_px * scene->shift_gain[1] / scene->blur_px[1];
    size_t k = 1;
    while (k + 1 < sizeof table / sizeof table[0] && table[k].shift < shift) {
        ++k;
    }
    double part = (shift - table[k - 1].shift) / (table[k].shift - table[k - 1].shift);
    part = fmin(1, fmax(0.05, part));
    scene->clip = table[k - 1].clip + part * (table[k].clip - table[k - 1].clip);
    const double narrowing = table[k - 1].narrowing + part * (table[k].narrowing - table[k - 1].narrowing);
    for (int family = 0; family < 2; ++family) {
        scene->blur_px[family] = fmin(BLUR_MOST, scene->blur_px[family] / narrowing);
    }
    scene->shift_px = 0;
}

/** Where little is left of the profiles and all sides are cut alike, since the picture is still, the
 * common shift does better than a model of the part that is missing: go back to it. */
static int drop_clip(edge_scene_t *scene)
{
    const double ratio = scene->blur_px[0] / scene->blur_px[1];
    if (scene->clip >= CLIP_OF_STILL || ratio > MOTION_RATIO || ratio < 1 / MOTION_RATIO) {
        return 0;
    }
    scene->shift_px = -scene->blur_px[1] * shift_of_clip(scene->clip);
    scene->blur_px[0] = scene->blur_px[1] = 0.55 * scene->blur_px[1];
    scene->still = 1;
    scene->clip = 1;
    return 1;
}

/** Choose the clip that leaves no common shift: the shift of the sides along X is certain, because
 * the pitch of the squares is known, and what saturation does not explain of it (print, exposure) is small. */
static void update_clip(edge_scene_t *scene)
{
    const double shift = shift_of_clip(scene->clip) - scene->shift_px * scene->shift_gain[1] / scene->blur_px[1];
    const double clip = clip_of_shift(fmax(0, shift));
    scene->clip += fmax(-0.15, fmin(0.15, clip - scene->clip));
    scene->clip = fmin(0.995, fmax(CLIP_LEAST, scene->clip));
    scene->shift_px = 0;
}

/** What the clip leaves of a shift goes with the blur: motion blurs two of the four sides more than
 * the others. Without saturation all sides shift alike (print, exposure). */
static void update_gain(edge_scene_t *scene, const bar_fit_t *fit)
{
    const double part = fmin(1, saturated_part(fit) / 0.05);
    const double mean = 0.5 * (scene->blur_px[0] + scene->blur_px[1]);
    for (int family = 0; family < 2; ++family) {
        scene->shift_gain[family] = 1 + part * (scene->blur_px[family] / mean - 1);
    }
}

/** Drop what lies far from the fitted map, and find the range of squares that is confirmed. */
static int confirm(bar_fit_t *fit, float scale, int *first, int *last)
{
    int seen[OPMS_BAR_SQUARES] = {0}, n = 0;
    for (int i = 0; i < fit->count; ++i) {
        if (fit->good[i] && fabsf(fit->residual[i]) > TUKEY * scale * fit->sigma[i]) {
            fit->good[i] = 0;
        }
        if (fit->good[i]) {
            seen[fit->stretch[i].square] |= 1 << fit->stretch[i].side;
            ++n;
        }
    }
    int low = OPMS_BAR_SQUARES, high = -1;
    for (int k = 0; k < OPMS_BAR_SQUARES; ++k) {
        /* At least two sides, one of them across the bar. */
        if ((seen[k] & 5) && (seen[k] & 10)) {
            low = low < k ? low : k;
            high = k;
        }
    }
    *first = low;
    *last = high;
    return n;
}

static float largest_change(const bar_fit_t *fit, const edge_scene_t *scene)
{
    float most = 0;
    for (int i = 0; i < fit->count; ++i) {
        if (fit->good[i]) {
            const float moved = fabsf(fit->stretch[i].offset_px - fit->residual[i] -
                                     expected_shift(scene, &fit->stretch[i]));
            most = moved > most ? moved : most;
        }
    }
    return most;
}

static int clamp_index(int k)
{
    return k < 0 ? 0 : k >= OPMS_BAR_SQUARES ? OPMS_BAR_SQUARES - 1 : k;
}

/** Learn black and white from the stretches of a pass and solve these again with both. Their scatter, light
 * and shade included, says how far they may be believed in any one place. */
static void learn_levels(bar_fit_t *fit)
{
    grey_levels_t levels;
    for (int white = 0; white < 2; ++white) {
        int n = 0;
        for (int i = 0; i < fit->count; ++i) {
            const stretch_t *s = &fit->stretch[i];
            if (fit->good[i]) {
                fit->residual[n++] = s->black + (white ? s->contrast : 0.f);
            }
        }
        if (n < GOOD_LEAST) {
            return;
        }
        const float middle = median(fit->residual, n);
        for (int i = 0; i < n; ++i) {
            fit->residual[i] = fabsf(fit->residual[i] - middle);
        }
        const float scatter = fmaxf(1.4826f * median(fit->residual, n), LEVEL_SCATTER_LEAST * fit->noise);
        levels.grey[white] = middle;
        levels.weight[white] = fit->noise * fit->noise / (scatter * scatter);
    }
    fit->levels = levels;
    for (int i = 0; i < fit->count; ++i) {
        if (!stretch_solve(&fit->levels, &fit->stretch[i])) {
            fit->stretch[i].contrast = 0; /* no edge: the selection leaves it out */
        }
    }
}

/** Mean square of the residuals of groups of stretches, in units of what independent errors give: one
 * group for each side of so many neighbouring squares. */
static float group_excess(const bar_fit_t *fit, int squares)
{
    float sum[OPMS_BAR_SQUARES][4] = {{0}}, weight[OPMS_BAR_SQUARES][4] = {{0}};
    for (int i = 0; i < fit->count; ++i) {
        if (fit->good[i]) {
            const stretch_t *s = &fit->stretch[i];
            const float w = 1.f / (fit->sigma[i] * fit->sigma[i]);
            sum[s->square / squares][s->side] += w * fit->residual[i];
            weight[s->square / squares][s->side] += w;
        }
    }
    float total = 0;
    int groups = 0;
    for (int k = 0; k < OPMS_BAR_SQUARES; ++k) {
        for (int side = 0; side < 4; ++side) {
            if (weight[k][side] > 0.f) {
                total += fminf(sum[k][side] * sum[k][side] / weight[k][side], 25.f);
                ++groups;
            }
        }
    }
    return groups > UNKNOWNS ? total / (float)(groups - UNKNOWNS) : 1.f;
}

/** State larger standard deviations where errors run alike along a side or along the bar, as shade and
 * grass make them: what is averaged does then not grow more certain by as much. */
static void state_correlation(bar_fit_t *fit)
{
    const float along_side = group_excess(fit, 1) / 1.1f, along_bar = group_excess(fit, 4) / 1.3f;
    const float excess = fmaxf(1.f, fmaxf(along_side, along_bar));
    for (int i = 0; i < fit->count; ++i) {
        fit->sigma[i] *= sqrtf(excess);
    }
}

/** One pass over the given squares; 0 when too little agrees. Returns by how much the edges moved
 * and the blur changed, and the range that was confirmed. */
typedef struct pass_result {
    float moved_px, blurred_px;
    int low, high;
} pass_result_t;

static int run_pass(edge_scene_t *scene, const int *index, int count, float contrast, float reach_px,
                    bar_fit_t *fit, pass_result_t *result)
{
    fit->levels.weight[0] = fit->levels.weight[1] = 0;
    measure(scene, index, count, fit);
    if (select_good(fit, contrast * 0.5f, reach_px, scene) < GOOD_LEAST) {
        return 0;
    }
    if (scene->line_step == 1 && saturated_part(fit) < SATURATED_LEAST) {
        learn_levels(fit);
        if (select_good(fit, contrast * 0.5f, reach_px, scene) < GOOD_LEAST) {
            return 0;
        }
    }
    linearise(scene, fit);
    double change[UNKNOWNS] = {0};
    float scale;
    change[8] = scene->shift_px;
    if (!fit_map(fit, change, &scale)) {
        return 0;
    }
    result->moved_px = largest_change(fit, scene);
    const double blur[2] = {scene->blur_px[0], scene->blur_px[1]}, clip = scene->clip;
    update_blur(scene, fit);
    update_gain(scene, fit);
    if (confirm(fit, scale, &result->low, &result->high) < GOOD_LEAST || result->high <= result->low) {
        return 0;
    }
    for (int k = 0; k < 8; ++k) {
        scene->map.h[k] += change[k];
    }
    scene->shift_px = change[8];
    if (clip < 1) {
        update_clip(scene);
    }
    result->blurred_px = (float)fmax(fabs(scene->clip - clip), fmax(fabs(scene->blur_px[0] - blur[0]),
                                                                    fabs(scene->blur_px[1] - blur[1])));
    return 1;
}

map_verdict_t map_refine(edge_scene_t *scene, int first, int last, float contrast, bar_fit_t *fit)
{
    int from = clamp_index(first), to = clamp_index(last);
    int index[OPMS_BAR_SQUARES];
    pass_result_t result = {0, 0, from, to};
    scene->line_step = SCOUTING_STEP;
    int plain = 0; /* saturated, but better measured as if it were not */
    /* Scouting: few squares, until the range stands still and the blur is known. */
    for (int pass = 0; pass < SCOUTING_MOST; ++pass) {
        const int count = visible_squares(scene, from, to, SCOUTING_SQUARES, index);
        if (!run_pass(scene, index, count, contrast, 3.f, fit, &result)) {
            return MAP_LOST;
        }
        const int grow = 1 + (result.high - result.low) / 2;
        const int next_from = clamp_index(result.low - grow), next_to = clamp_index(result.high + grow);
        const int known = next_from >= from && next_to <= to;
        from = next_from < from ? next_from : from;
        to = next_to > to ? next_to : to;
        if (!plain && scene->clip >= 1 && saturated_part(fit) > SATURATED_LEAST) {
            if (result.blurred_px < 0.06f || pass >= 5) {
                guess_clip(scene);
            }
            continue;
        }
        if (known && result.moved_px < SCOUTED_PX && result.blurred_px < SCOUTED_BLUR) {
            if (!plain && drop_clip(scene)) {
                plain = 1;
                continue;
            }
            break;
        }
        if (pass >= SCOUTING_MOST / 2 && scene->clip < 1) {
            plain = drop_clip(scene) || plain; /* it does not settle */
        }
    }
    scene->line_step = 1;
    for (int pass = 0; pass < PASSES_MOST; ++pass) {
        const int count = visible_squares(scene, from, to, OPMS_BAR_SQUARES, index);
        if (!run_pass(scene, index, count, contrast, 2.f, fit, &result)) {
            return MAP_LOST;
        }
        if (result.moved_px < SETTLED_PX && result.blurred_px < SHAPED) {
            break;
        }
    }
    state_correlation(fit);
    const int cut_too_low = scene->clip < CLIP_OF_MOTION;
    const int shifted_too_far = plain && fabs(scene->shift_px) > SHIFT_OF_STILL_PX;
    return cut_too_low || shifted_too_far || result.blurred_px >= UNSHAPED ? MAP_UNSURE : MAP_FIRM;
}
