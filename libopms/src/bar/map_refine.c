/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/map_refine.h"

#include <math.h>
#include <string.h>

#include "bar/bar_code.h"
#include "bar/clip_fit.h"
#include "bar/correlation.h"
#include "bar/fetch_square.h"
#include "bar/map_fit.h"
#include "algebra/median.h"
#include "bar/picture_shape.h"
#include "bar/stretch_scatter.h"

/* Passes of: measure the stretches where the map expects them, throw out those that cannot be a
 * side of this bar, fit map and common shift to the rest (Tukey's weights), take over the blur that
 * the profiles ask for. The first passes scout with a few squares spread over the range that is
 * known; the range grows with what has been confirmed, so that the map is never asked for more than
 * it knows. Then all squares are measured, once if nothing moves any more. */

#define SCOUTING_MOST 14
#define SCOUTING_CLIPPED 9
#define SCOUTING_SQUARES 6
#define CLIP_CLEAR 0.6
#define SCOUTED_PX 0.2f      /* movement after which all squares are measured */
#define SHAPED 0.04f        /* change of blur (px) or clip that counts as none */
#define SCOUTED_BLUR 0.06f
#define SURE_PX 0.3f         /* movement of a range from which its surroundings are well foretold */
#define UNSHAPED 0.1f       /* such a change at the end means that nothing settles */
#define PASSES_MOST 5
#define SETTLED_PX 0.02f    /* movement after which no further pass is needed */
#define LINEAR_PX 0.045f     /* and where the offsets answer a movement to first order */
#define LINEAR_BLUR 0.01f
#define BORDER_REACH_PX 40.0 /* a square's middle may lie this far outside and a side be seen */
#define GOOD_LEAST 12
#define SEEN_PX 0.5f         /* from where a side is expected, for it to be there at all */
#define ROUNDING 0.08f      /* 1 / 12 */
#define CUT_LOWER 0.75      /* of the contrast that saturation left */
#define LEVEL_SCATTER_LEAST 0.12f /* of black and white over the picture, in noises */
#define SATURATED_LEAST 0.05 /* part of the pixels next to the sides that makes white saturated */

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
        index[i] = count == n || count == 1 ? seen[i] : seen[i * (n - 1) / (count - 1)];
    }
    return count;
}

static void measure(const edge_scene_t *scene, const int *index, int count, bar_fit_t *fit)
{
    fit->count = 0;
    for (int i = 0; i < count; ++i) {
        if (i + 1 < count) {
            fetch_square(scene, index[i + 1]);
        }
        const int n = fit->count;
        const stretch_place_t next = {&fit->stretch[n], &fit->sums[n], &fit->clip[n]};
        fit->count += edge_fit_square(scene, index[i], &fit->levels, &next);
    }
}

/** The mean of variances of so many pixels each, whose median is below it: chi-square is skewed
 * (Wilson and Hilferty 1931). At least what rounding to whole grey levels makes. */
static float mean_of_median(float median, float pixels)
{
    const float root = 1.f - 2.f / (9.f * pixels);
    return median / (root * root * root) + ROUNDING;
}

/** Mark the stretches that look like this bar's sides; returns how many. */
static int select_good(bar_fit_t *fit, float contrast_least, float offset_most,
                       const edge_scene_t *scene)
{
    static const float variance_most =
        9.f; /* times the median: grass, a cell that was not foreseen */
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
    fit->contrast = median_of(scratch, n);
    n = 0;
    float pixels = 0;
    for (int i = 0; i < fit->count; ++i) {
        const stretch_t *s = &fit->stretch[i];
        const float off = fabsf(s->offset_px - map_expected_shift(scene, s));
        fit->good[i] = fit->good[i] && s->contrast > 0.3f * fit->contrast &&
                       s->contrast < 3.f * fit->contrast && off < offset_most;
        fit->seen[i] = fit->good[i] && off < SEEN_PX;
        if (fit->good[i]) {
            pixels += (float)s->pixels;
            scratch[n++] = s->variance;
        }
    }
    if (n < GOOD_LEAST) {
        return 0;
    }
    const float variance = mean_of_median(median_of(scratch, n), pixels / (float)n);
    fit->noise = sqrtf(variance);
    n = 0;
    for (int i = 0; i < fit->count; ++i) {
        const stretch_t *s = &fit->stretch[i];
        if (!fit->good[i] || s->variance > variance_most * variance) {
            fit->good[i] = 0;
            continue;
        }
        fit->sigma[i] =
            s->sigma_unit * sqrtf(stretch_scatter(s->variance, (float)s->pixels, variance));
        ++n;
    }
    return n;
}

/** Drop what lies far from the fitted map, and find the range of squares that is confirmed. */
static int confirm(bar_fit_t *fit, float scale, int *first, int *last)
{
    int seen[OPMS_BAR_SQUARES] = {0}, n = 0;
    for (int i = 0; i < fit->count; ++i) {
        if (fit->good[i] && fabsf(fit->residual[i]) > MAP_FIT_TUKEY * scale * fit->sigma[i]) {
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
                                     map_expected_shift(scene, &fit->stretch[i]));
            most = moved > most ? moved : most;
        }
    }
    return most;
}

static int clamp_index(int k)
{
    return k < 0 ? 0 : k >= OPMS_BAR_SQUARES ? OPMS_BAR_SQUARES - 1 : k;
}

/** Learn black and white from the stretches of a pass and solve these again with both. Their
 * scatter, light and shade included, says how far they may be believed in any one place. */
static void learn_levels(bar_fit_t *fit)
{
    grey_levels_t levels;
    for (int white = 0; white < 2; ++white) {
        int n = 0;
        float own = 0;
        for (int i = 0; i < fit->count; ++i) {
            const stretch_t *s = &fit->stretch[i];
            if (fit->good[i]) {
                fit->residual[n++] = s->black + (white ? s->contrast : 0.f);
                own += s->level_variance[white];
            }
        }
        if (n < GOOD_LEAST) {
            return;
        }
        own *= fit->noise * fit->noise / (float)n;
        const float middle = median_of(fit->residual, n);
        for (int i = 0; i < n; ++i) {
            fit->residual[i] = fabsf(fit->residual[i] - middle);
        }
        /* Of what they scatter, their own noise says nothing of the light. */
        const float scatter = 1.4826f * median_of(fit->residual, n);
        const float least = LEVEL_SCATTER_LEAST * fit->noise;
        const float light = fmaxf(scatter * scatter - own, least * least);
        levels.grey[white] = middle;
        levels.weight[white] = fit->noise * fit->noise / light;
    }
    fit->levels = levels;
    for (int i = 0; i < fit->count; ++i) {
        if (!stretch_solve(&fit->levels, &fit->sums[i], &fit->stretch[i])) {
            fit->stretch[i].contrast = 0; /* no edge: the selection leaves it out */
        }
    }
}

/** By how much a pass moved the edges and changed the blur, and the range it confirmed. */
typedef struct pass_result {
    float moved_px, blurred_px;
    int low, high;
} pass_result_t;

/** Range of squares that was scouted, and how it ended. */
typedef struct scouting {
    int from, to;
    int settled;
    pass_result_t result;
} scouting_t;

/** Take over the blur that the profiles ask for, and what it changes of the offsets: they are then
 * as if they had been measured with it. */
static void correct_blur(edge_scene_t *scene, bar_fit_t *fit)
{
    const double before[2] = {scene->blur_px[0], scene->blur_px[1]};
    shape_update_blur(scene, fit);
    for (int i = 0; i < fit->count; ++i) {
        stretch_t *s = &fit->stretch[i];
        const int family = s->side & 1;
        s->offset_px -= s->by_blur * (float)(scene->blur_px[family] - before[family]);
    }
}

/** One pass over the given squares; 0 when too little agrees. */
static int run_pass(edge_scene_t *scene, const int *index, int count, float contrast,
                    float reach_px, bar_fit_t *fit, pass_result_t *result)
{
    fit->levels.weight[0] = fit->levels.weight[1] = 0;
    measure(scene, index, count, fit);
    if (select_good(fit, contrast * 0.5f, reach_px, scene) < GOOD_LEAST) {
        return 0;
    }
    if (!scene->scouting && shape_saturated_part(fit) < SATURATED_LEAST) {
        learn_levels(fit);
        if (select_good(fit, contrast * 0.5f, reach_px, scene) < GOOD_LEAST) {
            return 0;
        }
    }
    fit->unknowns = scene->clip < 1 ? MAP_UNKNOWNS + CLIP_UNKNOWNS : MAP_UNKNOWNS + 1;
    const double blur[2] = {scene->blur_px[0], scene->blur_px[1]}, clip = scene->clip;
    if (clip >= 1) {
        correct_blur(scene, fit);
    }
    double change[FIT_UNKNOWNS_MOST] = {0};
    float scale;
    change[MAP_UNKNOWNS] = scene->shift_px;
    if (!map_fit(scene, fit, change, &scale)) {
        return 0;
    }
    result->moved_px = largest_change(fit, scene);
    if (clip < 1) {
        clip_take(scene, &change[MAP_UNKNOWNS]);
        scene->cut_noise = (double)(fit->noise / fit->contrast);
        shape_scale(scene, fit);
    } else {
        shape_update_gain(scene, fit);
        scene->shift_px = change[MAP_UNKNOWNS];
    }
    if (confirm(fit, scale, &result->low, &result->high) < GOOD_LEAST ||
        result->high <= result->low) {
        return 0;
    }
    for (int k = 0; k < 8; ++k) {
        scene->map.h[k] += change[k];
    }
    result->blurred_px =
        (float)fmax(fabs(scene->clip - clip),
                    fmax(fabs(scene->blur_px[0] - blur[0]), fabs(scene->blur_px[1] - blur[1])));
    return 1;
}

/** Widen the range by a part of what a pass has confirmed; returns whether the pass speaks for all
 * that can be seen of it. */
static int widen(const edge_scene_t *scene, int parts, scouting_t *scouting)
{
    int index[OPMS_BAR_SQUARES];
    const int span = 1 + (scouting->result.high - scouting->result.low);
    const int from = clamp_index(scouting->result.low - parts * span);
    const int to = clamp_index(scouting->result.high + parts * span);
    const int beyond = visible_squares(scene, from, scouting->from - 1, 1, index) +
                       visible_squares(scene, scouting->to + 1, to, 1, index);
    scouting->from = from < scouting->from ? from : scouting->from;
    scouting->to = to > scouting->to ? to : scouting->to;
    return beyond == 0;
}

/** Passes over few squares, until the range stands still and the blur is known, or, `until_cut`,
 * white is seen to be cut. 0 where too little agrees. */
static int scout(edge_scene_t *scene, int passes, int until_cut, float contrast, bar_fit_t *fit,
                 scouting_t *scouting)
{
    pass_result_t *result = &scouting->result;
    edge_scene_t before = *scene; /* and the range to return to where a wide one finds too little */
    scouting_t narrow = *scouting;
    int index[OPMS_BAR_SQUARES], wide = 0;
    scouting->settled = 0;
    for (int pass = 0; pass < passes && !scouting->settled; ++pass) {
        const int count =
            visible_squares(scene, scouting->from, scouting->to, SCOUTING_SQUARES, index);
        if (!run_pass(scene, index, count, contrast, 3.f, fit, result)) {
            if (!wide) {
                return 0;
            }
            *scene = before;
            *scouting = narrow;
            wide = 0;
            continue;
        }
        before = *scene;
        narrow = *scouting;
        widen(scene, 1, &narrow);
        wide = result->moved_px < SURE_PX;
        const int known = widen(scene, wide ? 2 : 1, scouting);
        if (until_cut && shape_saturated_part(fit) > SATURATED_LEAST) {
            scouting->settled = result->blurred_px < SCOUTED_BLUR || pass >= 5;
            continue;
        }
        scouting->settled =
            known && result->moved_px < SCOUTED_PX && result->blurred_px < SCOUTED_BLUR;
    }
    return 1;
}

/** Scout once more with saturated white in the model, from several starts; the best one stays. */
static int scout_clipped(edge_scene_t *scene, float contrast, bar_fit_t *fit,
                         scouting_t *scouting)
{
    const edge_scene_t plain = *scene;
    const scouting_t before = *scouting;
    edge_scene_t best = plain;
    scouting_t best_scouting = before;
    float least = 0;
    int found = 0;
    for (int start = 0; start < CLIP_STARTS; ++start) {
        edge_scene_t trial = plain;
        scouting_t trying = before;
        if (!clip_start(&trial, start)) {
            continue;
        }
        if (!scout(&trial, SCOUTING_CLIPPED, 0, contrast, fit, &trying)) {
            continue;
        }
        if (!found || fit->noise < least) {
            found = 1;
            least = fit->noise;
            best = trial;
            best_scouting = trying;
        }
        if (trying.settled && trial.clip > CLIP_CLEAR) {
            break; /* enough is left of the profiles to know */
        }
    }
    *scene = best;
    *scouting = best_scouting;
    return found;
}

/** Cut profiles lower than saturation did: resampling, uneven motion and stray light in the lens
 * round the corner at which the camera cut them, as none of the model's shapes has it. */
static void cut_lower(edge_scene_t *scene, bar_fit_t *fit)
{
    int n = 0;
    for (int i = 0; i < fit->count; ++i) {
        if (fit->good[i]) {
            fit->residual[n++] = fit->stretch[i].black;
        }
    }
    const double black = n > 0 ? (double)median_of(fit->residual, n) : 0;
    scene->cut_level = black + CUT_LOWER * (scene->cut_level - black);
    scene->clip *= CUT_LOWER;
}

/** Is no further pass needed? Offsets of a picture that stood still and is not saturated are right
 * to first order in what a pass finds; in others a pass builds on the last one's shape. */
static int has_settled(const edge_scene_t *scene, const pass_result_t *result)
{
    if (scene->clip >= 1 && !edge_scene_moved(scene)) {
        return result->moved_px < LINEAR_PX && result->blurred_px < LINEAR_BLUR;
    }
    return result->moved_px < SETTLED_PX && result->blurred_px < SHAPED;
}

map_verdict_t map_refine(edge_scene_t *scene, int first, int last, float contrast, bar_fit_t *fit)
{
    scouting_t scouting = {clamp_index(first), clamp_index(last), 0, {0, 0, 0, 0}};
    scene->scouting = 1;
    if (!scout(scene, SCOUTING_MOST, 1, contrast, fit, &scouting)) {
        return MAP_LOST;
    }
    if (shape_saturated_part(fit) > SATURATED_LEAST) {
        if (!scout_clipped(scene, contrast, fit, &scouting)) {
            return MAP_LOST;
        }
        cut_lower(scene, fit);
    }
    scene->scouting = 0;
    pass_result_t result = scouting.result;
    int index[OPMS_BAR_SQUARES];
    for (int pass = 0; pass < PASSES_MOST; ++pass) {
        const int count =
            visible_squares(scene, scouting.from, scouting.to, OPMS_BAR_SQUARES, index);
        if (!run_pass(scene, index, count, contrast, 2.f, fit, &result)) {
            return MAP_LOST;
        }
        if (has_settled(scene, &result)) {
            break;
        }
    }
    if (scene->clip < 1) {
        clip_gains(scene, fit);
        fit->contrast /= (float)CUT_LOWER; /* up to saturation again, for the report */
    }
    correlation_state(scene, fit);
    const int unsure = result.blurred_px >= UNSHAPED || clip_at_bound(scene);
    return unsure ? MAP_UNSURE : MAP_FIRM;
}
