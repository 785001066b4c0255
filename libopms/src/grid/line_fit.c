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

#include "grid/line_sums.h"

#define N 6
#define PIVOT_LEAST 1e-7
#define ROWS_LEAST 2 /* in all */

/* Rows being taken for a fit, in the raster's own axes. */
typedef struct taking {
    const raster_t *raster;
    vec2_t at, along;
    float s_per_row;
    ptrdiff_t row_bytes, pixel_bytes;
    row_batch_t batch;
    line_sums_t *sums;
} taking_t;

static taking_t begin_taking(const raster_t *raster, const line_stretch_t *stretch,
                             line_sums_t *sums)
{
    const vec2_t at = stretch->at, along = stretch->along;
    const ptrdiff_t size = raster->view->wide ? 2 : 1, stride = raster->view->stride;
    taking_t taking = {raster, at, along, 1.f / along.y, stride, size, {.count = 0}, sums};
    if (raster->columns) {
        taking.at = (vec2_t){at.y, at.x};
        taking.along = (vec2_t){along.y, along.x};
        taking.s_per_row = 1.f / along.x;
        taking.row_bytes = size;
        taking.pixel_bytes = stride;
    }
    memset(sums, 0, sizeof *sums);
    return taking;
}

/* One row: pixels within reach of the line. A row that leaves the picture is left out. */
static void take_row(taking_t *taking, int v)
{
    const raster_t *raster = taking->raster;
    row_batch_t *batch = &taking->batch;
    const float s = ((float)v - taking->at.y) * taking->s_per_row;
    const float u_line = taking->at.x + s * taking->along.x;
    const float before = u_line - 0.5f * (float)raster->row_size;
    if (!(before > -1.f) || !(before + (float)raster->row_size < (float)(raster->u_end - 1))) {
        return;
    }
    const int first = (int)(before + 1.f), l = batch->count++;
    batch->first[l] =
        raster->view->base + v * taking->row_bytes + first * taking->pixel_bytes;
    batch->x[l] = ((float)first - u_line) * raster->slope;
    batch->s[l] = s;
    if (batch->count == LANES) {
        add_rows(raster, batch, taking->sums);
    }
}

/* The rows of an arm, or as many as are asked for, evenly spread. */
static void take_arm(taking_t *taking, float from, float to, int rows)
{
    const float one = taking->at.y + from * taking->along.y;
    const float other = taking->at.y + to * taking->along.y;
    const int first = (int)fmaxf(ceilf(fminf(one, other)), 0.f);
    const int last = (int)fminf(floorf(fmaxf(one, other)), (float)(taking->raster->v_end - 1));
    const int count = last - first + 1;
    const int taken = count < rows ? count : rows;
    const float step = taken > 1 ? (float)(count - 1) / (float)(taken - 1) : 0.f;
    for (int k = 0; k < taken; ++k) {
        take_row(taking, first + (int)((float)k * step + 0.5f));
    }
}

/* Normal equations in the order in which they are solved: 0 white, 1 across, then with s: 2 white
 * and 3 shift, 4 depth, 5 shift. Of the matrix the upper triangle counts; beside it are the
 * right-hand sides: for the grey levels, and for a line that bends. */
#define RIGHT N
#define BEND (N + 1)
#define WIDTH (N + 2)

typedef double row_t __attribute__((vector_size(WIDTH * sizeof(double)), aligned(16)));

typedef struct equations {
    row_t row[N];
    double grey_grey;
} equations_t;

static void sum_lanes(const lanes_t *lanes, int count, double *out)
{
    for (int i = 0; i < count; ++i) {
        out[i] = (double)lanes_sum(lanes[i]);
    }
}

static void write_equations(const line_sums_t *sums, equations_t *e)
{
    double p[PRODUCTS], s[PRODUCTS_ONCE], ss[PRODUCTS_TWICE], sss[PRODUCTS_THRICE];
    sum_lanes(sums->plain, PRODUCTS, p);
    sum_lanes(sums->once, PRODUCTS_ONCE, s);
    sum_lanes(sums->twice, PRODUCTS_TWICE, ss);
    sum_lanes(sums->thrice, PRODUCTS_THRICE, sss);
    const equations_t written = {
        {{p[ONE_ONE], p[ONE_ACROSS], s[ONE_ONE], s[ONE_SHIFT], p[ONE_DEPTH], p[ONE_SHIFT],
          p[ONE_GREY], 0.5 * ss[ONE_SHIFT]},
         {0.0, p[ACROSS_ACROSS], s[ONE_ACROSS], s[ACROSS_SHIFT], p[ACROSS_DEPTH],
          p[ACROSS_SHIFT], p[ACROSS_GREY], 0.5 * ss[ACROSS_SHIFT]},
         {0.0, 0.0, ss[ONE_ONE], ss[ONE_SHIFT], s[ONE_DEPTH], s[ONE_SHIFT], s[ONE_GREY],
          0.5 * sss[ONE_SHIFT]},
         {0.0, 0.0, 0.0, ss[SHIFT_SHIFT], s[DEPTH_SHIFT], s[SHIFT_SHIFT], s[SHIFT_GREY],
          0.5 * sss[SHIFT_SHIFT]},
         {0.0, 0.0, 0.0, 0.0, p[DEPTH_DEPTH], p[DEPTH_SHIFT], p[DEPTH_GREY],
          0.5 * ss[DEPTH_SHIFT]},
         {0.0, 0.0, 0.0, 0.0, 0.0, p[SHIFT_SHIFT], p[SHIFT_GREY], 0.5 * ss[SHIFT_SHIFT]}},
        p[GREY_GREY]};
    *e = written;
}

/* Gauss's elimination from the top. What the last unknown is, and what it varies by, is then the
 * last row; of the others only the depth is asked for. Whole rows at a time: what becomes of the
 * lower triangle is not looked at. 0 where an unknown is left open. */
static int eliminate(equations_t *e)
{
    double whole[N];
    for (int j = 0; j < N; ++j) {
        whole[j] = e->row[j][j];
    }
    for (int j = 0; j < N; ++j) {
        const row_t from = e->row[j];
        if (!(from[j] > PIVOT_LEAST * whole[j])) {
            return 0;
        }
        const row_t part = from / from[j];
        for (int i = j + 1; i < N; ++i) {
            e->row[i] -= part[i] * from;
        }
        e->grey_grey -= from[RIGHT] * part[RIGHT];
    }
    return 1;
}

static int solve_sums(const line_stretch_t *stretch, const line_sums_t *sums, int pixels,
                      line_fit_t *fit)
{
    equations_t e;
    write_equations(sums, &e);
    e.row[3][3] += (double)stretch->turn_weight;
    if (sums->rows < ROWS_LEAST || pixels < 3 * N || !eliminate(&e)) {
        return 0;
    }
    const row_t depth = e.row[4], shift = e.row[5];
    const double moved = shift[RIGHT] / shift[5];
    const double contrast = -(depth[RIGHT] - depth[5] * moved) / depth[4];
    if (!(contrast > 0.0)) {
        return 0;
    }
    fit->contrast = (float)contrast;
    fit->off = (float)(moved / contrast);
    fit->variance = (float)(1.0 / (shift[5] * contrast * contrast));
    fit->bend = (float)(shift[BEND] / shift[5]);
    fit->pixels = pixels;
    fit->noise = (float)sqrt(fmax(0.0, e.grey_grey) / (pixels - N));
    return 1;
}

/* What is read, and how, for a line in this direction. */
static raster_t plan_raster(const view_t *view, const line_stretch_t *stretch)
{
    const int columns = fabsf(stretch->along.x) > fabsf(stretch->along.y);
    const float lean = columns ? stretch->along.y : stretch->along.x;
    const float slope = fabsf(columns ? stretch->along.x : stretch->along.y);
    const float blur = sqrtf(stretch->blur * stretch->blur + lean * lean / 12.f);
    const line_profile_t *profile = profile_of(stretch->profiles, stretch->width, blur);
    const float reach = fminf(stretch->reach, profile->reach - PROFILE_BORDER_PX);
    const vec2_t white =
        vec2_add(stretch->at, stretch->along, 0.5f * (stretch->from + stretch->to));
    const raster_t raster = {view,
                             profile,
                             columns,
                             columns ? view->height : view->width,
                             columns ? view->width : view->height,
                             slope,
                             (int)(2.f * reach / slope + 0.5f),
                             view_holds(view, white.x, white.y, 0.0)
                                 ? view_bilinear(view, white.x, white.y)
                                 : 0.f};
    return raster;
}

int fit_line(const view_t *view, const line_stretch_t *stretch, line_fit_t *fit)
{
    const raster_t raster = plan_raster(view, stretch);
    line_sums_t sums;
    taking_t taking = begin_taking(&raster, stretch, &sums);
    if (stretch->plus) {
        take_arm(&taking, stretch->from, stretch->to, stretch->rows);
    }
    if (stretch->minus) {
        take_arm(&taking, -stretch->to, -stretch->from, stretch->rows);
    }
    add_rows(&raster, &taking.batch, &sums);
    if (!solve_sums(stretch, &sums, sums.rows * raster.row_size, fit)) {
        return 0;
    }
    /* So far `off` counts towards rising u; to the right of `along` that is, or is not. */
    const float sign = (raster.columns ? -stretch->along.x : stretch->along.y) > 0.f ? -1.f : 1.f;
    fit->off *= sign;
    return 1;
}
