/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/map_fit.h"

#include <math.h>
#include <string.h>

#include "algebra/spd.h"
#include "bar/bar_code.h"
#include "bar/clip_fit.h"
#include "algebra/median.h"

#define SCALE_SAMPLE 160
#define TUKEY MAP_FIT_TUKEY
#define ROUNDS 3
#define SETTLED_SCALE 0.01f /* of itself; another round would then change nothing */

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
            fit->row[i][k] =
                (float)((double)s->normal[0] * grad[k] + (double)s->normal[1] * grad[8 + k]);
        }
        fit->row[i][MAP_UNKNOWNS] = (float)scene->shift_gain[s->side & 1];
        if (scene->clip < 1) {
            clip_row(&fit->clip[i], &fit->row[i][MAP_UNKNOWNS]);
        }
    }
}

/** Residuals of the good stretches for a change of the map; returns their robust scale in sigmas.
 */
static inline float residuals_of(bar_fit_t *fit, const double *change, int unknowns)
{
    float scratch[OPMS_BAR_EDGES_MAX];
    int n = 0;
    for (int i = 0; i < fit->count; ++i) {
        if (!fit->good[i]) {
            continue;
        }
        double model = 0;
        for (int k = 0; k < unknowns; ++k) {
            model += (double)fit->row[i][k] * change[k];
        }
        fit->residual[i] = fit->stretch[i].offset_px - (float)model;
        if (n < SCALE_SAMPLE || i % 4 == 0) {
            scratch[n++] = fabsf(fit->residual[i]) / fit->sigma[i];
        }
    }
    const float scale = 1.4826f * median_of(scratch, n);
    return scale < 1.f ? 1.f : scale;
}

/** Code cells lie where map and shift have them, and pull at the sides next to them as these do: by
 * the map they move with the side, by the shift towards it. So an offset answers either by somewhat
 * less or more than in full. Here the rows are made to say so. */
static void answer_cells(const edge_scene_t *scene, bar_fit_t *fit)
{
    for (int i = 0; i < fit->count; ++i) {
        stretch_t *s = &fit->stretch[i];
        s->offset_px += s->by_cells * map_expected_shift(scene, s);
        for (int k = 0; k < MAP_UNKNOWNS; ++k) {
            fit->row[i][k] *= 1.f - s->by_cells;
        }
        fit->row[i][MAP_UNKNOWNS] *= 1.f + s->by_cells;
    }
}

/** Make the offsets what they would be with the cells in their true places. The residuals are. */
static void correct_cells(const edge_scene_t *scene, const double change[FIT_UNKNOWNS_MOST],
                          bar_fit_t *fit)
{
    for (int i = 0; i < fit->count; ++i) {
        stretch_t *s = &fit->stretch[i];
        if (!fit->good[i]) {
            continue;
        }
        const float gain = (float)scene->shift_gain[s->side & 1];
        const float full = 1.f / (1.f - s->by_cells);
        double moved = (double)gain * change[MAP_UNKNOWNS];
        for (int k = 0; k < MAP_UNKNOWNS; ++k) {
            fit->row[i][k] *= full;
            moved += (double)fit->row[i][k] * change[k];
        }
        fit->row[i][MAP_UNKNOWNS] = gain;
        s->offset_px = fit->residual[i] + (float)moved;
    }
}

/** The number of unknowns that most fits have, as a constant for the compiler to unroll. */
#define USUAL_UNKNOWNS (MAP_UNKNOWNS + 1)

static float residuals(bar_fit_t *fit, const double *change)
{
    return fit->unknowns == USUAL_UNKNOWNS ? residuals_of(fit, change, USUAL_UNKNOWNS)
                                           : residuals_of(fit, change, fit->unknowns);
}

/** Normal equations, lower triangle, with Tukey's weights for residuals of a scale in sigmas. */
static inline void sum_normal_of(const bar_fit_t *fit, float scale, double *normal, double *rhs,
                                 int n)
{
    for (int i = 0; i < fit->count; ++i) {
        if (!fit->good[i]) {
            continue;
        }
        const float z = fit->residual[i] / (fit->sigma[i] * scale * TUKEY);
        if (z * z >= 1.f) {
            continue;
        }
        const float w = (1.f - z * z) * (1.f - z * z) / (fit->sigma[i] * fit->sigma[i]);
        double row[FIT_UNKNOWNS_MOST];
        for (int k = 0; k < n; ++k) {
            row[k] = (double)fit->row[i][k];
        }
        for (int j = 0; j < n; ++j) {
            const double wr = (double)w * row[j];
            for (int k = 0; k <= j; ++k) {
                normal[n * j + k] += wr * row[k];
            }
            rhs[j] += wr * (double)fit->stretch[i].offset_px;
        }
    }
}

static void sum_normal(const bar_fit_t *fit, float scale, double *normal, double *rhs)
{
    if (fit->unknowns == USUAL_UNKNOWNS) {
        sum_normal_of(fit, scale, normal, rhs, USUAL_UNKNOWNS);
    } else {
        sum_normal_of(fit, scale, normal, rhs, fit->unknowns);
    }
}

/** Robust linear fit of the map and what is unknown of the picture; 0 when singular. */
static int fit_robustly(const edge_scene_t *scene, bar_fit_t *fit,
                        double change[FIT_UNKNOWNS_MOST], float *scale)
{
    const int n = fit->unknowns;
    *scale = residuals(fit, change) * 3.f; /* wide at first */
    for (int round = 0; round < ROUNDS; ++round) {
        double normal[FIT_UNKNOWNS_MOST * FIT_UNKNOWNS_MOST] = {0}, rhs[FIT_UNKNOWNS_MOST] = {0};
        sum_normal(fit, *scale, normal, rhs);
        if (scene->clip < 1) {
            clip_know(scene, fit, normal, rhs, n);
        }
        for (int j = 0; j < n; ++j) {
            normal[n * j + j] *= 1 + 1e-9;
        }
        if (!spd_factor(normal, n, SPD_PIVOT_LEAST)) {
            return 0;
        }
        spd_solve(normal, n, rhs);
        memcpy(change, rhs, sizeof rhs);
        const float before = *scale;
        *scale = residuals(fit, change);
        if (round > 0 && fabsf(*scale - before) < SETTLED_SCALE * before) {
            break;
        }
    }
    return 1;
}

int map_fit(const edge_scene_t *scene, bar_fit_t *fit, double change[FIT_UNKNOWNS_MOST],
            float *scale)
{
    linearise(scene, fit);
    if (scene->clip < 1) {
        return fit_robustly(scene, fit, change, scale);
    }
    answer_cells(scene, fit);
    if (!fit_robustly(scene, fit, change, scale)) {
        return 0;
    }
    correct_cells(scene, change, fit);
    return 1;
}
