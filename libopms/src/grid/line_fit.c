/* SPDX-License-Identifier: Apache-2.0 */
/* Least squares on raw pixels, linear about where the line is expected:
 *
 *   grey = c0 + c1 x + c2 s - A (T(x) - T'(x) (off + turn s))
 *
 * x px across and s px along the line, T a line of the given width under Gaussian blur and the
 * pixel's own size. Whole rows are read where the line is steep, else whole columns: no pixel is
 * interpolated. White that changes across or along the line is part of the model, so uneven light
 * does not pull the line. What the bending of the line does to `off` comes from a second right-hand
 * side. */
#include "grid/line_fit.h"

#include <string.h>

#include "algebra/spd.h"

#define N 6
#define PIVOT_LEAST 1e-7
#define ROWS_LEAST 2 /* in all */

/* Products of (1, x, T, T') of one row of pixels, four pixels side by side. */
#define LANES 4
#define PRODUCTS 15 /* of the four among each other, with the grey levels, and of those squared */

typedef struct row_sums {
    float lane[PRODUCTS][LANES];
    int pixels;
} row_sums_t;

/* Sums of all rows, with powers of s. */
typedef struct sums {
    double matrix[N * N]; /* lower triangle */
    double right[N], bend[N], yy;
    int pixels, rows;
} sums_t;

/* Four pixels: (1, x, T, T', grey), all zero where there is none. */
typedef struct quartet {
    float basis[5][LANES];
} quartet_t;

static void add_quartet(row_sums_t *row, const quartet_t *quartet)
{
    int place = 0;
    for (int a = 0; a < 5; ++a) {
        for (int b = a; b < 5; ++b, ++place) {
            for (int l = 0; l < LANES; ++l) {
                row->lane[place][l] += quartet->basis[a][l] * quartet->basis[b][l];
            }
        }
    }
}

static double lane_sum(const row_sums_t *row, int place)
{
    const float *lane = row->lane[place];
    return (double)((lane[0] + lane[1]) + (lane[2] + lane[3]));
}

/* Unknowns: 0 white, 1 across, 2 depth, 3 shift, then with s: 4 white, 5 shift. */
static void add_row(sums_t *sums, const row_sums_t *row, float s)
{
    static const int base[N] = {0, 1, 2, 3, 0, 3};
    /* Place of the product of two of (1, x, T, T', grey) in the lanes. */
    static const int at[5][5] = {{0, 1, 2, 3, 4},
                                 {1, 5, 6, 7, 8},
                                 {2, 6, 9, 10, 11},
                                 {3, 7, 10, 12, 13},
                                 {4, 8, 11, 13, 14}};
    const double power[N] = {1, 1, 1, 1, s, s};
    double total[PRODUCTS];
    for (int i = 0; i < PRODUCTS; ++i) {
        total[i] = lane_sum(row, i);
    }
    for (int a = 0; a < N; ++a) {
        sums->right[a] += power[a] * total[at[base[a]][4]];
        sums->bend[a] += power[a] * 0.5 * (double)(s * s) * total[at[base[a]][3]];
        for (int b = 0; b <= a; ++b) {
            sums->matrix[a * N + b] += power[a] * power[b] * total[at[base[a]][base[b]]];
        }
    }
    sums->yy += total[14];
    sums->pixels += row->pixels;
    ++sums->rows;
}

/* Rows of the picture, or its columns: `u` runs within one, `v` counts them. */
typedef struct raster {
    const view_t *view;
    const line_profile_t *profile; /* of the line, smeared by the pixels' height, too */
    int columns;
    int u_end, v_end;
} raster_t;

static float grey_at(const raster_t *raster, int u, int v)
{
    return (float)(raster->columns ? view_at(raster->view, v, u) : view_at(raster->view, u, v));
}

/* One row: pixels within reach of the line. The grey levels count from the middle of the row, so
 * that float sums keep their digits. */
static void sum_row(const raster_t *raster, const line_stretch_t *stretch, vec2_t at, vec2_t along,
                    int v, float origin, sums_t *sums)
{
    const float s_row = ((float)v - at.y) / along.y;
    const float u_line = at.x + s_row * along.x;
    const float span = stretch->reach / fabsf(along.y);
    const int first = (int)ceilf(u_line - span), last = (int)floorf(u_line + span);
    if (first < 0 || last >= raster->u_end) {
        return;
    }
    const float slope = fabsf(along.y), per_width = 1.f / slope;
    row_sums_t row;
    memset(&row, 0, sizeof row);
    row.pixels = last - first + 1;
    border_t left = border_at(raster->profile, ((float)first - 0.5f - u_line) * slope);
    for (int u = first; u <= last;) {
        quartet_t quartet = {{{0.f}}};
        /* A pixel sees the mean over its own width: what lies between its borders. */
        for (int l = 0; l < LANES && u <= last; ++l, ++u) {
            const float x = ((float)u - u_line) * slope;
            const border_t right = border_at(raster->profile, x + 0.5f * slope);
            quartet.basis[0][l] = 1.f;
            quartet.basis[1][l] = x;
            quartet.basis[2][l] = (right.area - left.area) * per_width;
            quartet.basis[3][l] = (right.level - left.level) * per_width;
            quartet.basis[4][l] = grey_at(raster, u, v) - origin;
            left = right;
        }
        add_quartet(&row, &quartet);
    }
    add_row(sums, &row, s_row);
}

static void sum_arm(const raster_t *raster, const line_stretch_t *stretch, vec2_t at, vec2_t along,
                    float from, float to, float origin, sums_t *sums)
{
    float low = at.y + from * along.y, high = at.y + to * along.y;
    if (low > high) {
        const float swap = low;
        low = high;
        high = swap;
    }
    const int first = (int)ceilf(low) > 0 ? (int)ceilf(low) : 0;
    const int last = (int)floorf(high) < raster->v_end - 1 ? (int)floorf(high) : raster->v_end - 1;
    const int step = 1 + (last - first) / stretch->rows;
    for (int v = first; v <= last; v += step) {
        sum_row(raster, stretch, at, along, v, origin, sums);
    }
}

static int solve_sums(const line_stretch_t *stretch, sums_t *sums, line_fit_t *fit)
{
    double unit[N] = {0, 0, 0, 1, 0, 0}, x[N];
    sums->matrix[5 * N + 5] += stretch->turn_weight;
    memcpy(x, sums->right, sizeof x);
    if (sums->rows < ROWS_LEAST || sums->pixels < 3 * N ||
        !spd_factor(sums->matrix, N, PIVOT_LEAST)) {
        return 0;
    }
    spd_solve(sums->matrix, N, x);
    spd_solve(sums->matrix, N, sums->bend);
    spd_solve(sums->matrix, N, unit);
    double rest = sums->yy;
    for (int i = 0; i < N; ++i) {
        rest -= x[i] * sums->right[i];
    }
    const double contrast = -x[2];
    if (!(contrast > 0.0)) {
        return 0;
    }
    fit->contrast = (float)contrast;
    fit->off = (float)(x[3] / contrast);
    fit->variance = (float)(unit[3] / (contrast * contrast));
    fit->bend = (float)sums->bend[3];
    fit->pixels = sums->pixels;
    fit->noise = (float)sqrt(fmax(0.0, rest) / (sums->pixels - N));
    return 1;
}

int fit_line(const view_t *view, const line_stretch_t *stretch, line_fit_t *fit)
{
    const int columns = fabsf(stretch->along.x) > fabsf(stretch->along.y);
    const float lean = columns ? stretch->along.y : stretch->along.x;
    const float blur = sqrtf(stretch->blur * stretch->blur + lean * lean / 12.f);
    const raster_t raster = {view, profile_of(stretch->profiles, stretch->width, blur), columns,
                             columns ? view->height : view->width,
                             columns ? view->width : view->height};
    vec2_t at = stretch->at, along = stretch->along;
    if (columns) {
        const vec2_t a = {at.y, at.x}, l = {along.y, along.x};
        at = a;
        along = l;
    }
    const vec2_t white =
        vec2_add(stretch->at, stretch->along, 0.5f * (stretch->from + stretch->to));
    const float origin = view_holds(view, white.x, white.y, 0.0)
        ? view_bilinear(view, white.x, white.y)
        : 0.f;
    sums_t sums;
    memset(&sums, 0, sizeof sums);
    if (stretch->plus) {
        sum_arm(&raster, stretch, at, along, stretch->from, stretch->to, origin, &sums);
    }
    if (stretch->minus) {
        sum_arm(&raster, stretch, at, along, -stretch->to, -stretch->from, origin, &sums);
    }
    if (!solve_sums(stretch, &sums, fit)) {
        return 0;
    }
    /* So far `off` counts towards rising u; to the right of `along` that is, or is not. */
    const float sign = (columns ? -stretch->along.x : stretch->along.y) > 0.f ? -1.f : 1.f;
    fit->off *= sign;
    return 1;
}
