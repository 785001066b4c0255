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

#include "algebra/lanes.h"
#include "algebra/spd.h"

#define N 6
#define PIVOT_LEAST 1e-7
#define ROWS_LEAST 2 /* in all */

typedef struct equations {
    double matrix[N * N]; /* lower triangle */
    double right[N], bend[N], yy;
} equations_t;

/* Products of (1, x, T, T', grey) among each other, four pixels side by side. */
#define BASIS 5
#define PRODUCTS 15
#define PRODUCT(a, b) ((a) * (9 - (a)) / 2 + (b)) /* place of one, a <= b */
#define POWERS 4 /* of s, and 1 */

/* Sums over all rows, weighted by powers of s; of the third only what bending asks for. */
typedef struct row_sums {
    lanes_t by_power[POWERS][PRODUCTS];
    int pixels, rows;
} row_sums_t;

static void add_quartet(lanes_t row[PRODUCTS], const lanes_t basis[BASIS])
{
    int place = 0;
    for (int a = 0; a < BASIS; ++a) {
        for (int b = a; b < BASIS; ++b, ++place) {
            row[place] += basis[a] * basis[b];
        }
    }
}

static void add_row(row_sums_t *sums, const lanes_t row[PRODUCTS], float s)
{
    for (int i = 0; i < PRODUCTS; ++i) {
        const lanes_t once = s * row[i];
        sums->by_power[0][i] += row[i];
        sums->by_power[1][i] += once;
        sums->by_power[2][i] += s * once;
    }
    sums->by_power[3][PRODUCT(0, 3)] += s * s * s * row[PRODUCT(0, 3)];
    sums->by_power[3][PRODUCT(3, 3)] += s * s * s * row[PRODUCT(3, 3)];
    ++sums->rows;
}

/* Rows of the picture, or its columns: `u` runs within one, `v` counts them. */
typedef struct raster {
    const view_t *view;
    const line_profile_t *profile; /* of the line, smeared by the pixels' height, too */
    int columns;
    int u_end, v_end;
} raster_t;

/* One row of it while it is read. */
typedef struct scan {
    const uint8_t *pixels;    /* the first of the row */
    ptrdiff_t step;           /* bytes to the next */
    int wide;                 /* 16 bit */
    lanes_t x;                /* px across the line, of the next four pixels */
    float slope;              /* px across the line a pixel */
    lanes_t area, level;      /* of the line at the border before them, in the last lane */
} scan_t;

static lanes_t four_greys(const scan_t *scan, int u)
{
    const uint8_t *at = scan->pixels + u * scan->step;
    if (scan->wide) {
        uint16_t grey[LANES];
        for (int l = 0; l < LANES; ++l) {
            memcpy(&grey[l], at + l * scan->step, sizeof grey[l]);
        }
        return (lanes_t){grey[0], grey[1], grey[2], grey[3]};
    }
    const uint8_t grey[LANES] = {at[0], at[scan->step], at[2 * scan->step], at[3 * scan->step]};
    return (lanes_t){grey[0], grey[1], grey[2], grey[3]};
}

/* Less than four are left: the others count nothing and are not read. */
static lanes_t some_greys(const scan_t *scan, int u, int n)
{
    lanes_t greys = lanes_of(0.f);
    for (int l = 0; l < n; ++l) {
        const uint8_t *at = scan->pixels + (u + l) * scan->step;
        uint16_t wide;
        memcpy(&wide, at, scan->wide ? sizeof wide : 1);
        greys[l] = scan->wide ? wide : *at;
    }
    return greys;
}

/* The four pixels of the line that follow. A pixel sees the mean over its own width: what lies
 * between its borders. */
static void next_basis(const line_profile_t *profile, scan_t *scan, lanes_t basis[BASIS - 1])
{
    const border_lanes_t right = border_lanes_at(profile, scan->x + 0.5f * scan->slope);
    const lanes_t area = {scan->area[3], right.area[0], right.area[1], right.area[2]};
    const lanes_t level = {scan->level[3], right.level[0], right.level[1], right.level[2]};
    const float per_width = 1.f / scan->slope;
    basis[0] = lanes_of(1.f);
    basis[1] = scan->x;
    basis[2] = (right.area - area) * per_width;
    basis[3] = (right.level - level) * per_width;
    scan->area = right.area;
    scan->level = right.level;
    scan->x += (float)LANES * scan->slope;
}

static void mask_basis(lanes_t basis[BASIS], int n)
{
    const lanes_int_t number = {0, 1, 2, 3}, counts = number < n;
    for (int a = 0; a < BASIS; ++a) {
        basis[a] = (lanes_t)((lanes_int_t)basis[a] & counts);
    }
}

static scan_t begin_scan(const raster_t *raster, float x_first, float slope, int v)
{
    const view_t *view = raster->view;
    const ptrdiff_t size = view->wide ? 2 : 1;
    const border_lanes_t start =
        border_lanes_at(raster->profile, lanes_of(x_first - 0.5f * slope));
    const scan_t scan = {view->base + v * (raster->columns ? size : view->stride),
                         raster->columns ? view->stride : size,
                         view->wide,
                         {x_first, x_first + slope, x_first + 2.f * slope, x_first + 3.f * slope},
                         slope,
                         start.area,
                         start.level};
    return scan;
}

/* One row: pixels within reach of the line. The grey levels count from the middle of the row, so
 * that float sums keep their digits. */
static void sum_row(const raster_t *raster, const line_stretch_t *stretch, vec2_t at, vec2_t along,
                    int v, float origin, row_sums_t *sums)
{
    const float s_row = ((float)v - at.y) / along.y;
    const float u_line = at.x + s_row * along.x;
    const float slope = fabsf(along.y);
    const float span = stretch->reach / slope;
    const int first = (int)ceilf(u_line - span), last = (int)floorf(u_line + span);
    if (first < 0 || last >= raster->u_end) {
        return;
    }
    scan_t scan = begin_scan(raster, ((float)first - u_line) * slope, slope, v);
    lanes_t row[PRODUCTS] = {{0.f}}, basis[BASIS];
    int u = first;
    for (; u + LANES - 1 <= last; u += LANES) {
        next_basis(raster->profile, &scan, basis);
        basis[BASIS - 1] = four_greys(&scan, u) - origin;
        add_quartet(row, basis);
    }
    if (u <= last) {
        next_basis(raster->profile, &scan, basis);
        basis[BASIS - 1] = some_greys(&scan, u, last - u + 1) - origin;
        mask_basis(basis, last - u + 1);
        add_quartet(row, basis);
    }
    sums->pixels += last - first + 1;
    add_row(sums, row, s_row);
}

static void sum_arm(const raster_t *raster, const line_stretch_t *stretch, vec2_t at, vec2_t along,
                    float from, float to, float origin, row_sums_t *sums)
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

/* Unknowns: 0 white, 1 across, 2 depth, 3 shift, then with s: 4 white, 5 shift. */
static void write_equations(const row_sums_t *rows, equations_t *equations)
{
    static const int base[N] = {0, 1, 2, 3, 0, 3}, power[N] = {0, 0, 0, 0, 1, 1};
    float total[POWERS][PRODUCTS];
    for (int p = 0; p < POWERS; ++p) {
        for (int i = 0; i < PRODUCTS; ++i) {
            total[p][i] = lanes_sum(rows->by_power[p][i]);
        }
    }
    for (int a = 0; a < N; ++a) {
        const int low = base[a] < 3 ? base[a] : 3;
        equations->right[a] = (double)total[power[a]][PRODUCT(base[a], 4)];
        equations->bend[a] = 0.5 * (double)total[power[a] + 2][PRODUCT(low, 3)];
        for (int b = 0; b <= a; ++b) {
            const int first = base[a] < base[b] ? base[a] : base[b];
            const int second = base[a] + base[b] - first;
            equations->matrix[a * N + b] =
                (double)total[power[a] + power[b]][PRODUCT(first, second)];
        }
    }
    equations->yy = (double)total[0][PRODUCT(4, 4)];
}

static int solve_sums(const line_stretch_t *stretch, const row_sums_t *rows, line_fit_t *fit)
{
    double unit[N] = {0, 0, 0, 1, 0, 0}, x[N];
    equations_t equations;
    write_equations(rows, &equations);
    equations.matrix[5 * N + 5] += stretch->turn_weight;
    memcpy(x, equations.right, sizeof x);
    if (rows->rows < ROWS_LEAST || rows->pixels < 3 * N ||
        !spd_factor(equations.matrix, N, PIVOT_LEAST)) {
        return 0;
    }
    spd_solve(equations.matrix, N, x);
    spd_solve(equations.matrix, N, equations.bend);
    spd_solve(equations.matrix, N, unit);
    double rest = equations.yy;
    for (int i = 0; i < N; ++i) {
        rest -= x[i] * equations.right[i];
    }
    const double contrast = -x[2];
    if (!(contrast > 0.0)) {
        return 0;
    }
    fit->contrast = (float)contrast;
    fit->off = (float)(x[3] / contrast);
    fit->variance = (float)(unit[3] / (contrast * contrast));
    fit->bend = (float)equations.bend[3];
    fit->pixels = rows->pixels;
    fit->noise = (float)sqrt(fmax(0.0, rest) / (rows->pixels - N));
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
    row_sums_t sums;
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
