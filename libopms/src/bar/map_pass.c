/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/map_pass.h"

#include <math.h>

#include "algebra/median.h"
#include "bar/bar_code.h"
#include "bar/fetch_square.h"
#include "bar/map_fit.h"
#include "bar/picture_shape.h"
#include "bar/shaped_fit.h"
#include "bar/stretch_scatter.h"

#define BORDER_REACH_PX 40.0 /* a square's middle may lie this far outside and a side be seen */
#define GOOD_LEAST 12
#define SEEN_PX 0.5f         /* from where a side is expected, for it to be there at all */
#define ROUNDING 0.08f       /* 1 / 12 */
#define LEVEL_SCATTER_LEAST 0.12f /* of black and white over the picture, in noises */

int map_visible_squares(const edge_scene_t *scene, int from, int to, int most, int *index)
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
        const stretch_place_t next = {&fit->stretch[n], &fit->sums[n], &fit->shape[n]};
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

/* Their scatter, light and shade included, says how far black and white may be believed in any one
 * place. */
void map_learn_levels(bar_fit_t *fit, int family)
{
    grey_levels_t levels;
    for (int white = 0; white < 2; ++white) {
        int n = 0;
        float own = 0;
        for (int i = 0; i < fit->count; ++i) {
            const stretch_t *s = &fit->stretch[i];
            if (fit->good[i] && (family < 0 || (s->side & 1) == family)) {
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

double map_misfit(const bar_fit_t *fit)
{
    double sum = 0, pixels = 0;
    for (int i = 0; i < fit->count; ++i) {
        if (fit->good[i]) {
            sum += fit->stretch[i].pixels * log((double)(fit->stretch[i].variance + ROUNDING));
            pixels += fit->stretch[i].pixels;
        }
    }
    return pixels > 0 ? sum / pixels : 0;
}

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

int map_pass(edge_scene_t *scene, const int *index, int count, float contrast,
                    float reach_px, bar_fit_t *fit, pass_result_t *result)
{
    if (!scene->shaped) {
        fit->levels.weight[0] = fit->levels.weight[1] = 0;
    }
    measure(scene, index, count, fit);
    if (select_good(fit, contrast * 0.5f, reach_px, scene) < GOOD_LEAST) {
        return 0;
    }
    if (!scene->scouting && !scene->shaped && shape_saturated_part(fit) < SHAPE_SATURATED_LEAST) {
        map_learn_levels(fit, -1);
        if (select_good(fit, contrast * 0.5f, reach_px, scene) < GOOD_LEAST) {
            return 0;
        }
    }
    fit->unknowns = scene->shaped ? MAP_UNKNOWNS + SHAPED_UNKNOWNS : MAP_UNKNOWNS + 1;
    const double blur[2] = {scene->blur_px[0], scene->blur_px[1]}, clip = scene->clip;
    if (!scene->shaped) {
        correct_blur(scene, fit);
    }
    double change[FIT_UNKNOWNS_MOST] = {0};
    float scale;
    change[MAP_UNKNOWNS] = scene->shift_px;
    if (!map_fit(scene, fit, change, &scale)) {
        return 0;
    }
    result->moved_px = largest_change(fit, scene);
    if (scene->shaped) {
        shaped_take(scene, &change[MAP_UNKNOWNS]);
        scene->cut_noise = (double)(fit->noise / fit->contrast);
        shape_scale(scene, fit);
        shaped_blurs(scene);
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
        (float)fmax(fabs(log(scene->clip / clip)),
                    fmax(fabs(scene->blur_px[0] - blur[0]), fabs(scene->blur_px[1] - blur[1])));
    return 1;
}
