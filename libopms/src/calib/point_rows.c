/* SPDX-License-Identifier: Apache-2.0 */
/* Four points side by side. */
#include "calib/point_rows.h"

#include "algebra/quad_lanes.h"
#include "calib/cockle_powers.h"

/* Points, one quantity after the other. */
typedef struct point_block {
    double X[GRAM_ROWS], Y[GRAM_ROWS], u[GRAM_ROWS], v[GRAM_ROWS], per_sigma[GRAM_ROWS];
} point_block_t;

/* Four of them as the camera sees them. */
typedef struct seen_points {
    quad_t terms[OPMS_CALIB_COCKLE_TERMS];
    quad_t camera[3];
    quad_t x, y, r2, round, tilt; /* round: radial gain; tilt: of the tangential distortion */
    quad_t xd, yd;
    quad_t off_u, off_v; /* measured less model, px */
    quad_t rest;         /* square root of Tukey's weight */
} seen_points_t;

/* Rows without a point repeat the first one and count nothing. */
static int fill_block(const opms_calib_point_t *points, uint32_t stride, int n,
                      point_block_t *block)
{
    const int whole = (n + QUAD - 1) / QUAD * QUAD;
    for (int i = 0; i < whole; ++i) {
        const opms_calib_point_t *point = &points[i < n ? (uint32_t)i * stride : 0];
        block->X[i] = point->target_m[0];
        block->Y[i] = point->target_m[1];
        block->u[i] = point->px[0];
        block->v[i] = point->px[1];
        block->per_sigma[i] = i < n ? 1.0 / point->sigma_px : 0.0;
    }
    return whole;
}

/* Height of the target, and its terms. */
WIDE_INLINE quad_t raise(const point_view_t *view, const quad_t *X, const quad_t *Y,
                         seen_points_t *seen)
{
    quad_t x[COCKLE_DEGREE + 1], y[COCKLE_DEGREE + 1], height = {0.0};
    x[0] = y[0] = (quad_t){1.0, 1.0, 1.0, 1.0};
    for (int i = 1; i <= COCKLE_DEGREE; ++i) {
        x[i] = x[i - 1] * *X / view->cockle_scale_m;
        y[i] = y[i - 1] * *Y / view->cockle_scale_m;
    }
    for (int k = 0; k < OPMS_CALIB_COCKLE_TERMS; ++k) {
        seen->terms[k] = x[COCKLE_POWERS[k][0]] * y[COCKLE_POWERS[k][1]];
        height += view->cockle[k] * seen->terms[k];
    }
    return height;
}

/* What does not count must not spoil sums by not being finite: it goes to the optical axis. */
WIDE_INLINE void hide(const quad_int_t *counts, seen_points_t *seen)
{
    quad_t *const values[] = {&seen->camera[0], &seen->camera[1], &seen->camera[2], &seen->x,
                              &seen->y,         &seen->r2,        &seen->round,     &seen->tilt,
                              &seen->xd,        &seen->yd,        &seen->off_u,     &seen->off_v,
                              &seen->rest};
    for (unsigned k = 0; k < sizeof values / sizeof *values; ++k) {
        quad_keep_where(counts, values[k]);
    }
    const quad_t one = {1.0, 1.0, 1.0, 1.0};
    seen->camera[2] += (quad_t)(~*counts & (quad_int_t)one);
}

WIDE_INLINE void see(const point_view_t *view, const point_block_t *block, int i,
                     seen_points_t *seen, int *in_front)
{
    const opms_lens_t *lens = &view->lens;
    quad_t X, Y, u, v, per_sigma;
    quad_load(block->X + i, &X);
    quad_load(block->Y + i, &Y);
    quad_load(block->u + i, &u);
    quad_load(block->v + i, &v);
    quad_load(block->per_sigma + i, &per_sigma);
    for (int k = 0; k < 3; ++k) {
        seen->camera[k] = view->R[3 * k] * X + view->R[3 * k + 1] * Y + view->origin[k];
    }
    if (view->cockle_scale_m > 0.0) {
        const quad_t height = raise(view, &X, &Y, seen);
        for (int k = 0; k < 3; ++k) {
            seen->camera[k] += view->R[3 * k + 2] * height;
        }
    }
    const quad_t x = seen->x = seen->camera[0] / seen->camera[2];
    const quad_t y = seen->y = seen->camera[1] / seen->camera[2];
    seen->r2 = x * x + y * y;
    seen->round = 1.0 + seen->r2 * (lens->k1 + seen->r2 * lens->k2);
    seen->tilt = 2.0 * (lens->p1 * y + lens->p2 * x);
    seen->xd = x * (seen->round + seen->tilt) + lens->p2 * seen->r2;
    seen->yd = y * (seen->round + seen->tilt) + lens->p1 * seen->r2;
    seen->off_u = u - (lens->fx_px * seen->xd + lens->cx_px);
    seen->off_v = v - (lens->fy_px * seen->yd + lens->cy_px);
    seen->rest = 1.0 - (seen->off_u * seen->off_u + seen->off_v * seen->off_v) * per_sigma *
                           per_sigma / view->window2;
    const quad_int_t counts = (quad_int_t)(seen->rest > 0.0);
    const quad_int_t before = (quad_int_t)(seen->camera[2] > 0.0);
    *in_front = *in_front && before[0] && before[1] && before[2] && before[3];
    hide(&counts, seen);
}

/* Tukey's cost of four points, in thirds of the window. */
WIDE_INLINE double four_costs(const seen_points_t *seen)
{
    const quad_t cost = 1.0 - seen->rest * seen->rest * seen->rest;
    return quad_sum(&cost);
}

/* d(coordinate)/d(camera point), times the root of the point's information, gives the pose's
 * columns and the cockle's: the point moves by p x w and by -R d. */
WIDE_INLINE void put_geometry(const point_view_t *view, const seen_points_t *seen,
                              const quad_t g[3], double *column)
{
    const quad_t *p = seen->camera;
    const double *R = view->R;
    const quad_t turn[3] = {g[1] * p[2] - g[2] * p[1], g[2] * p[0] - g[0] * p[2],
                            g[0] * p[1] - g[1] * p[0]};
    quad_t shift[3];
    for (int k = 0; k < 3; ++k) {
        shift[k] = -(R[k] * g[0] + R[3 + k] * g[1] + R[6 + k] * g[2]);
    }
    for (int k = 0; k < view->cockle_columns; ++k, column += GRAM_ROWS) {
        const quad_t raised = -shift[2] * seen->terms[k];
        quad_store(column, &raised);
    }
    for (int k = 0; k < 3; ++k) {
        quad_store(column + k * GRAM_ROWS, &turn[k]);
        quad_store(column + (3 + k) * GRAM_ROWS, &shift[k]);
    }
}

WIDE_INLINE void put_lens(const quad_t value[LENS_COLUMNS], double *column)
{
    for (int k = 0; k < LENS_COLUMNS; ++k) {
        quad_store(column + k * GRAM_ROWS, &value[k]);
    }
}

/* Four rows of u and of v. */
WIDE_INLINE void put_rows(const point_view_t *view, const seen_points_t *s, const quad_t *root,
                          double *column, int apart)
{
    const opms_lens_t *lens = &view->lens;
    const int geometry = LENS_COLUMNS * GRAM_ROWS;
    const int residual = (LENS_COLUMNS + view->cockle_columns + 6) * GRAM_ROWS;
    const quad_t x = s->x, y = s->y, r2 = s->r2, xy2 = 2.0 * x * y;
    const quad_t fx = *root * lens->fx_px, fy = *root * lens->fy_px;
    const quad_t u[LENS_COLUMNS] = {*root * s->xd,  *root,    fx * x * r2,
                                    fx * x * r2 * r2, fx * xy2, fx * (r2 + 2.0 * x * x)};
    const quad_t v[LENS_COLUMNS] = {*root * s->yd,    *root,                    fy * y * r2,
                                    fy * y * r2 * r2, fy * (r2 + 2.0 * y * y), fy * xy2};
    put_lens(u, column);
    put_lens(v, column + apart);
    /* The distortion is a gradient, so its derivative is symmetric (lens/lens_fast.h). */
    const quad_t steep = 2.0 * lens->k1 + 4.0 * lens->k2 * r2, gain = s->round + s->tilt;
    const quad_t xx = gain + steep * x * x + 4.0 * lens->p2 * x;
    const quad_t yy = gain + steep * y * y + 4.0 * lens->p1 * y;
    const quad_t both = steep * x * y + 2.0 * (lens->p1 * x + lens->p2 * y);
    const quad_t per_x = fx / s->camera[2], per_y = fy / s->camera[2];
    const quad_t gu[3] = {per_x * xx, per_x * both, -per_x * (xx * x + both * y)};
    const quad_t gv[3] = {per_y * both, per_y * yy, -per_y * (both * x + yy * y)};
    put_geometry(view, s, gu, column + geometry);
    put_geometry(view, s, gv, column + apart + geometry);
    const quad_t off_u = *root * s->off_u, off_v = *root * s->off_v;
    quad_store(column + residual, &off_u);
    quad_store(column + apart + residual, &off_v);
}

WIDE_INLINE double rows_of(const point_view_t *view, const point_block_t *block, int whole,
                           double *columns, int apart, int *in_front)
{
    double cost = 0.0;
    for (int i = 0; i < whole; i += QUAD) {
        seen_points_t seen;
        quad_t per_sigma;
        see(view, block, i, &seen, in_front);
        cost += four_costs(&seen);
        if (columns) {
            quad_load(block->per_sigma + i, &per_sigma);
            const quad_int_t inlier = (quad_int_t)(seen.rest >= view->inlier_rest);
            quad_t root = per_sigma * seen.rest;
            if (view->inliers_only) {
                root = per_sigma;
                quad_keep_where(&inlier, &root);
            }
            put_rows(view, &seen, &root, columns + i, apart);
        }
    }
    return cost * view->window2 / 3.0;
}

WIDE_AVX2 static double rows_avx2(const point_view_t *view, const point_block_t *block, int whole,
                                  double *columns, int apart, int *in_front)
{
    return rows_of(view, block, whole, columns, apart, in_front);
}

static double rows_plain(const point_view_t *view, const point_block_t *block, int whole,
                         double *columns, int apart, int *in_front)
{
    return rows_of(view, block, whole, columns, apart, in_front);
}

static double rows_any(const point_view_t *view, const opms_calib_point_t *points,
                       uint32_t stride, int n, double *columns, int apart, int *in_front)
{
    point_block_t block;
    const int whole = fill_block(points, stride, n, &block);
    if (wide_has_avx2()) {
        return rows_avx2(view, &block, whole, columns, apart, in_front);
    }
    return rows_plain(view, &block, whole, columns, apart, in_front);
}

double point_rows(const point_view_t *view, const opms_calib_point_t *points, uint32_t stride,
                  int n, double *columns, int apart, int *in_front)
{
    const int whole = (n + QUAD - 1) / QUAD * QUAD;
    for (int k = 0; k < LENS_COLUMNS + view->cockle_columns + 7 && whole < GRAM_ROWS; ++k) {
        const size_t rest = (size_t)(GRAM_ROWS - whole) * sizeof *columns;
        memset(columns + k * GRAM_ROWS + whole, 0, rest);
        memset(columns + apart + k * GRAM_ROWS + whole, 0, rest);
    }
    return rows_any(view, points, stride, n, columns, apart, in_front);
}

double point_costs(const point_view_t *view, const opms_calib_point_t *points, uint32_t stride,
                   int n, int *in_front)
{
    return rows_any(view, points, stride, n, NULL, 0, in_front);
}
