/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/map_fit.h"

#include <math.h>
#include <string.h>

#include "algebra/median.h"
#include "algebra/spd.h"
#include "algebra/wide_doubles.h"
#include "bar/bar_code.h"
#include "bar/shaped_fit.h"
#include "bar/plane_map_wide.h"

#define SCALE_SAMPLE 160
#define TUKEY MAP_FIT_TUKEY
#define ROUNDS 3
#define SETTLED_SCALE 0.01f /* of itself; another round would then change nothing */

/** The part of a stretch in its equation that is not the map's: code cells lie where map and shift
 * have them, and pull at the sides next to them as these do: by the map they move with the side, by
 * the shift towards it. So an offset answers either by somewhat less or more than in full, and its
 * equation says so. */
static void write_equation(const edge_scene_t *scene, const bar_fit_t *fit, int i, int at,
                           fit_columns_t *columns)
{
    const stretch_t *s = &fit->stretch[i];
    const int shaped = scene->shaped;
    const double cells = shaped ? 0 : (double)s->by_cells;
    columns->by[MAP_UNKNOWNS][at] = scene->shift_gain[s->side & 1] * (1 + cells);
    if (shaped) {
        float row[SHAPED_UNKNOWNS];
        shaped_row(&fit->shape[i], row);
        for (int k = 0; k < SHAPED_UNKNOWNS; ++k) {
            columns->by[MAP_UNKNOWNS + k][at] = (double)row[k];
        }
    }
    columns->stretch[at] = (uint16_t)i;
    columns->target[at] = (double)s->offset_px + cells * (double)map_expected_shift(scene, s);
    columns->per_sigma[at] = 1 / (double)fit->sigma[i];
}

/** Where stretches lie on the bar, and their normals times what answers the map. */
typedef struct four_places {
    double x_mm[WIDE_DOUBLES], y_mm[WIDE_DOUBLES], nu[WIDE_DOUBLES], nv[WIDE_DOUBLES];
} four_places_t;

WIDE_INLINE void place_of(const edge_scene_t *scene, const stretch_t *s, int lane,
                          four_places_t *four)
{
    const double square_y = BAR_PITCH_MM * (s->square - OPMS_BAR_ORIGIN);
    const int along_y = s->side == 0 || s->side == 2;
    const double out = (s->side < 2 ? -BAR_HALF_SQUARE_MM : BAR_HALF_SQUARE_MM);
    const double answer = scene->shaped ? 1 : 1 - (double)s->by_cells;
    four->x_mm[lane] = along_y ? out : (double)s->along_mm;
    four->y_mm[lane] = square_y + (along_y ? (double)s->along_mm : out);
    four->nu[lane] = (double)s->normal[0] * answer;
    four->nv[lane] = (double)s->normal[1] * answer;
}

/** The map's part in all equations. */
WIDE_INLINE void write_gradients_lanes(const edge_scene_t *scene, bar_fit_t *fit)
{
    fit_columns_t *columns = &fit->columns;
    for (int at = 0; at < columns->count; at += WIDE_DOUBLES) {
        four_places_t four;
        for (int lane = 0; lane < WIDE_DOUBLES; ++lane) {
            const int some = at + lane < columns->count ? at + lane : at;
            place_of(scene, &fit->stretch[columns->stretch[some]], lane, &four);
        }
        wide_double_t row[MAP_UNKNOWNS];
        plane_map_rows(&scene->map, scene->lens, wide_double_load(four.x_mm),
                       wide_double_load(four.y_mm), wide_double_load(four.nu),
                       wide_double_load(four.nv), row);
        for (int k = 0; k < MAP_UNKNOWNS; ++k) {
            wide_double_store(&columns->by[k][at], row[k]);
        }
    }
}

WIDE_EITHER(write_gradients, (const edge_scene_t *scene, bar_fit_t *fit), (scene, fit))

static void linearise(const edge_scene_t *scene, bar_fit_t *fit)
{
    fit_columns_t *columns = &fit->columns;
    int n = 0;
    for (int i = 0; i < fit->count; ++i) {
        fit->shift_gain[i] = (float)scene->shift_gain[fit->stretch[i].side & 1];
        if (fit->good[i]) {
            write_equation(scene, fit, i, n++, columns);
        }
    }
    columns->count = n;
    for (; n % WIDE_DOUBLES != 0; ++n) { /* what counts for nothing fills up the last lanes */
        for (int k = MAP_UNKNOWNS; k < fit->unknowns; ++k) {
            columns->by[k][n] = 0;
        }
        columns->target[n] = columns->per_sigma[n] = 0;
    }
    write_gradients(scene, fit);
}

/** The number of unknowns that most fits have, as a constant for the compiler to unroll. */
#define USUAL_UNKNOWNS (MAP_UNKNOWNS + 1)

WIDE_INLINE void residuals_of(fit_columns_t *columns, const double *change, int unknowns)
{
    for (int at = 0; at < columns->count; at += WIDE_DOUBLES) {
        wide_double_t left = wide_double_load(&columns->target[at]);
        for (int k = 0; k < unknowns; ++k) {
            left -= wide_double_load(&columns->by[k][at]) * change[k];
        }
        wide_double_store(&columns->residual[at], left);
    }
}

/** Residuals for a change of the map; returns their robust scale in sigmas. */
static float residuals(bar_fit_t *fit, const double *change)
{
    fit_columns_t *columns = &fit->columns;
    if (fit->unknowns == USUAL_UNKNOWNS) {
        residuals_of(columns, change, USUAL_UNKNOWNS);
    } else {
        residuals_of(columns, change, fit->unknowns);
    }
    /* Stretches come side by side, so that one of several stands for all. */
    float sample[SCALE_SAMPLE];
    const int step = 1 + (columns->count - 1) / SCALE_SAMPLE;
    int n = 0;
    for (int at = 0; at < columns->count; at += step) {
        sample[n++] = (float)(fabs(columns->residual[at]) * columns->per_sigma[at]);
    }
    const float scale = 1.4826f * median_of(sample, n);
    return scale < 1.f ? 1.f : scale;
}

/** Normal equations, lower triangle, with Tukey's weights for residuals of a scale in sigmas. */
WIDE_INLINE void sum_normal_of(const fit_columns_t *columns, float scale, double *normal,
                               double *rhs, int n)
{
    const double per_window = 1 / (double)(scale * TUKEY);
    wide_double_t sum[FIT_UNKNOWNS_MOST][FIT_UNKNOWNS_MOST + 1];
    for (int j = 0; j < n; ++j) {
        for (int k = 0; k <= j + 1; ++k) {
            sum[j][k] = (wide_double_t){0, 0, 0, 0};
        }
    }
    for (int at = 0; at < columns->count; at += WIDE_DOUBLES) {
        const wide_double_t per_sigma = wide_double_load(&columns->per_sigma[at]);
        const wide_double_t z =
            wide_double_load(&columns->residual[at]) * per_sigma * per_window;
        const wide_double_t root = wide_double_positive(1.0 - z * z) * per_sigma;
        const wide_double_t weight = root * root;
        const wide_double_t target = wide_double_load(&columns->target[at]);
        for (int j = 0; j < n; ++j) {
            const wide_double_t weighted = weight * wide_double_load(&columns->by[j][at]);
            for (int k = 0; k <= j; ++k) {
                sum[j][k] += weighted * wide_double_load(&columns->by[k][at]);
            }
            sum[j][j + 1] += weighted * target;
        }
    }
    for (int j = 0; j < n; ++j) {
        for (int k = 0; k <= j; ++k) {
            normal[n * j + k] = wide_double_sum(sum[j][k]);
        }
        rhs[j] = wide_double_sum(sum[j][j + 1]);
    }
}

WIDE_INLINE void sum_usual_lanes(const fit_columns_t *columns, float scale, double *normal,
                                 double *rhs)
{
    sum_normal_of(columns, scale, normal, rhs, USUAL_UNKNOWNS);
}

WIDE_EITHER(sum_usual,
            (const fit_columns_t *columns, float scale, double *normal, double *rhs),
            (columns, scale, normal, rhs))

static void sum_normal(const bar_fit_t *fit, float scale, double *normal, double *rhs)
{
    if (fit->unknowns == USUAL_UNKNOWNS) {
        sum_usual(&fit->columns, scale, normal, rhs);
    } else {
        sum_normal_of(&fit->columns, scale, normal, rhs, fit->unknowns);
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
        if (scene->shaped) {
            shaped_know(scene, fit, normal, rhs, n);
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

/** Make the offsets what they would be with the cells in their true places. */
static void correct_cells(const bar_fit_t *fit, const double change[FIT_UNKNOWNS_MOST], int at,
                          stretch_t *s)
{
    const fit_columns_t *columns = &fit->columns;
    const double answer = columns->by[MAP_UNKNOWNS][at] * change[MAP_UNKNOWNS];
    const double shift = (double)fit->shift_gain[columns->stretch[at]] * change[MAP_UNKNOWNS];
    const double by_map = columns->target[at] - columns->residual[at] - answer;
    s->offset_px =
        (float)(columns->residual[at] + shift + by_map / (1 - (double)s->by_cells));
}

int map_fit(const edge_scene_t *scene, bar_fit_t *fit, double change[FIT_UNKNOWNS_MOST],
            float *scale)
{
    linearise(scene, fit);
    if (!fit_robustly(scene, fit, change, scale)) {
        return 0;
    }
    for (int at = 0; at < fit->columns.count; ++at) {
        const int i = fit->columns.stretch[at];
        fit->residual[i] = (float)fit->columns.residual[at];
        if (!scene->shaped) {
            correct_cells(fit, change, at, &fit->stretch[i]);
        }
    }
    return 1;
}
