/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/follow.h"

#include <math.h>
#include <stdlib.h>

#include "bar/bar_code.h"
#include "bar/bar_settle.h"
#include "bar/chain.h"
#include "bar/line_search.h"

/* A first square is sought on a few short lines around the middle of the bar as the hint has it.
 * Where it lies says how the bar has moved in its own plane; squares on both sides of it, as far
 * away as the picture has them, are then looked at directly, each where those found before let it
 * be expected. Three squares so far apart give a map that is good over the whole bar, and what
 * follows is the same as for a bar that was searched for. The codes have to say that the squares
 * are those of the hint; otherwise nothing of this is used. */

#define ROWS 5            /* through a square and its neighbourhood */
#define ROW_STEP 0.6      /* of a square's side: no square lies between two rows */
#define ROW_REACH 2.5     /* of a square's side, to both sides */
#define ROW_REACH_PX 40.0
#define ROW_PIXELS_MAX 2048
#define RUNS_MAX 6        /* of a row that are looked at */
#define SHORTEST_RUN_PX 4
#define TRACES_MOST 10    /* contours followed for the first square */
#define STARTS 3          /* squares of the hint that are tried as the first */
#define TRIES 3           /* each at half the distance, where a far square is hidden */
#define AREA_LEAST 0.6      /* of a first square, over what the hint expects */
#define AREA_MOST 1.7
#define FOUND_LEAST 3
#define SPAN_LEAST 4      /* from the first square found to the last */

/** How far a square lies from where the hint has it, in the bar's plane. */
typedef struct found_square {
    int index;
    double x_mm, y_mm;
    point_t corner[4];
} found_square_t;

typedef struct follower {
    opms_bar_detector_t *d;
    plane_map_t map; /* the hint's */
    int low, high;   /* squares that the hint has in the picture */
    int least_contrast;
    float contrast;  /* least, from the first square */
    int traces;      /* left for the first square */
    int count;
    found_square_t found[FOUND_LEAST + 2 * TRIES];
} follower_t;

/** The hint as a map, and the squares that it has in the picture; 0 if they are too few. */
static int map_of_hint(const opms_transform_t *hint, follower_t *f)
{
    const opms_bar_detector_t *d = f->d;
    const double *R = hint->R, *t_m = hint->t_m;
    double column[3][3]; /* of X and Y in mm, and 1 */
    for (int i = 0; i < 3; ++i) {
        column[0][i] = R[i];
        column[1][i] = R[3 + i];
        column[2][i] = -1e3 * (R[i] * t_m[0] + R[3 + i] * t_m[1] + R[6 + i] * t_m[2]);
    }
    f->low = OPMS_BAR_SQUARES;
    f->high = -1;
    for (int k = 0; k < OPMS_BAR_SQUARES; ++k) {
        const double y = BAR_PITCH_MM * (k - OPMS_BAR_ORIGIN);
        const double depth = column[2][2] + y * column[1][2];
        if (!(depth > 1)) {
            continue;
        }
        plane_map_t *map = &f->map;
        map->y0_mm = y;
        map->scale_mm = BAR_PITCH_MM * OPMS_BAR_ORIGIN;
        for (int i = 0; i < 3; ++i) {
            map->h[3 * i] = column[0][i] * BAR_HALF_SQUARE_MM / depth;
            map->h[3 * i + 1] = column[1][i] * map->scale_mm / depth;
            map->h[3 * i + 2] = (column[2][i] + y * column[1][i]) / depth;
        }
        double px[2];
        if (plane_map_project(map, &d->local_lens, d->ray_limit, 0, y, px, NULL) &&
            view_holds(&d->view, px[0], px[1], 2)) {
            f->low = k < f->low ? k : f->low;
            f->high = k;
        }
    }
    return f->high - f->low >= SPAN_LEAST;
}

/** Corners of a square that lies (x, y) mm from where the hint has it. */
static int expect(const follower_t *f, int index, double x_mm, double y_mm, point_t corner[4])
{
    const opms_bar_detector_t *d = f->d;
    const double square_y = BAR_PITCH_MM * (index - OPMS_BAR_ORIGIN) + y_mm;
    for (int c = 0; c < 4; ++c) {
        double px[2];
        const double x = x_mm + ((c == 1 || c == 2) ? BAR_HALF_SQUARE_MM : -BAR_HALF_SQUARE_MM);
        const double y = square_y + (c >= 2 ? BAR_HALF_SQUARE_MM : -BAR_HALF_SQUARE_MM);
        if (!plane_map_project(&f->map, &d->local_lens, d->ray_limit, x, y, px, NULL) ||
            !view_holds(&d->view, px[0], px[1], 1)) {
            return 0;
        }
        corner[c].x = (float)px[0];
        corner[c].y = (float)px[1];
    }
    return 1;
}

static point_t middle(const point_t corner[4])
{
    const point_t p = {0.25f * (corner[0].x + corner[1].x + corner[2].x + corner[3].x),
                       0.25f * (corner[0].y + corner[1].y + corner[2].y + corner[3].y)};
    return p;
}

/** Keep a square that was seen where `index` was expected (x, y) mm from the hint; which one it is
 * along the bar, the nearest expected one says. 0 where it is none. */
static int keep(follower_t *f, int index, double x_mm, double y_mm, const point_t expected[4],
                const point_t corner[4])
{
    const opms_bar_detector_t *d = f->d;
    double px[2], jac[4];
    const double square_y = BAR_PITCH_MM * (index - OPMS_BAR_ORIGIN) + y_mm;
    if (!plane_map_project(&f->map, &d->local_lens, d->ray_limit, x_mm, square_y, px, jac)) {
        return 0;
    }
    const point_t from = middle(expected), to = middle(corner);
    const double u = (double)(to.x - from.x), v = (double)(to.y - from.y);
    const double det = jac[0] * jac[3] - jac[1] * jac[2];
    const double x = x_mm + (jac[3] * u - jac[1] * v) / det;
    const double y = y_mm + (jac[0] * v - jac[2] * u) / det;
    const double steps = floor((y - y_mm) / BAR_PITCH_MM + 0.5);
    if (!(fabs(steps) < OPMS_BAR_SQUARES)) {
        return 0;
    }
    found_square_t *square = &f->found[f->count];
    square->index = index + (int)steps;
    square->x_mm = x;
    square->y_mm = y - BAR_PITCH_MM * steps;
    for (int c = 0; c < 4; ++c) {
        square->corner[c] = corner[c];
    }
    for (int i = 0; i < f->count; ++i) {
        if (f->found[i].index == square->index) {
            return 0;
        }
    }
    if (square->index < 0 || square->index >= OPMS_BAR_SQUARES) {
        return 0;
    }
    ++f->count;
    return 1;
}

static double area_of(const point_t corner[4])
{
    const point_t a = {corner[2].x - corner[0].x, corner[2].y - corner[0].y};
    const point_t b = {corner[3].x - corner[1].x, corner[3].y - corner[1].y};
    return 0.5 * fabs((double)(a.x * b.y - a.y * b.x));
}

/** Try the square that a dark run may belong to. */
static int try_run(follower_t *f, int index, const point_t expected[4], int x, int y,
                   const dark_run_t *run)
{
    opms_bar_detector_t *d = f->d;
    quad_t quad;
    if (--f->traces < 0 ||
        !quad_trace(&d->view, x, y, 0.5f * (float)(run->black + run->white), &d->limits,
                    d->points, &quad)) {
        return 0;
    }
    const point_t from = middle(expected);
    point_t moved[4], corner[4];
    for (int c = 0; c < 4; ++c) {
        moved[c].x = expected[c].x + quad.centre.x - from.x;
        moved[c].y = expected[c].y + quad.centre.y - from.y;
    }
    const double larger = area_of(quad.corner) / area_of(expected);
    if (!(larger > AREA_LEAST && larger < AREA_MOST) || /* code cells are dark, too */
        !chain_match_corners(&quad, moved, corner) ||
        !keep(f, index, 0, 0, expected, corner)) {
        return 0;
    }
    f->contrast = fmaxf(0.4f * (float)(run->white - run->black), (float)f->least_contrast);
    return 1;
}

/** Search one short row for a square, the nearest dark runs first. */
static int search_row(follower_t *f, int index, const point_t expected[4],
                      const search_line_t *line, int centre)
{
    opms_bar_detector_t *d = f->d;
    const int count = line->to - line->from + 1;
    if (count < SHORTEST_RUN_PX) {
        return 0;
    }
    line_load(&d->view, line, d->line);
    int low = d->line[0], high = low;
    for (int i = 1; i < count; ++i) {
        low = d->line[i] < low ? d->line[i] : low;
        high = d->line[i] > high ? d->line[i] : high;
    }
    const int part = (high - low) / 3;
    const int contrast = part > f->least_contrast ? part : f->least_contrast;
    dark_run_t runs[RUNS_MAX];
    int seen = 0, cursor = 0;
    while (seen < RUNS_MAX && line_next_run(d->line, count, contrast, SHORTEST_RUN_PX, count,
                                            &cursor, &runs[seen])) {
        ++seen;
    }
    for (; seen > 0; --seen) {
        int nearest = 0;
        for (int i = 1; i < seen; ++i) {
            nearest = abs(line->from + runs[i].middle - centre) <
                    abs(line->from + runs[nearest].middle - centre)
                ? i
                : nearest;
        }
        if (try_run(f, index, expected, line->from + runs[nearest].middle, line->at,
                    &runs[nearest])) {
            return 1;
        }
        runs[nearest] = runs[seen - 1];
    }
    return 0;
}

/** Find a square around the place where the hint has one. */
static int find_first(follower_t *f, int index)
{
    static const int order[ROWS] = {0, 1, -1, 2, -2};
    const view_t *view = &f->d->view;
    point_t expected[4];
    if (!expect(f, index, 0, 0, expected)) {
        return 0;
    }
    const point_t mid = middle(expected);
    const double side = sqrt(area_of(expected));
    const double reach = fmin(fmax(ROW_REACH * side, ROW_REACH_PX), ROW_PIXELS_MAX / 2 - 1);
    for (int i = 0; i < ROWS; ++i) {
        const int at = (int)((double)mid.y + order[i] * ROW_STEP * side);
        const int from = (int)fmax(0, (double)mid.x - reach);
        const int to = (int)fmin(view->width - 1, (double)mid.x + reach);
        const search_line_t line = {0, at, from, to};
        if (at >= 0 && at < view->height &&
            search_row(f, index, expected, &line, (int)mid.x)) {
            return 1;
        }
    }
    return 0;
}

/** Look at one square where the squares found so far, the last two foremost, let it be expected. */
static int find_square(follower_t *f, int index)
{
    opms_bar_detector_t *d = f->d;
    const found_square_t *near = &f->found[0], *other = NULL;
    for (int i = 1; i < f->count; ++i) {
        const found_square_t *next = &f->found[i];
        if (abs(next->index - index) < abs(near->index - index)) {
            other = near;
            near = next;
        } else if (!other || abs(next->index - index) < abs(other->index - index)) {
            other = next;
        }
    }
    const double part =
        other ? (double)(index - near->index) / (near->index - other->index) : 0;
    const double x_mm = near->x_mm + part * (other ? near->x_mm - other->x_mm : 0);
    const double y_mm = near->y_mm + part * (other ? near->y_mm - other->y_mm : 0);
    point_t expected[4], corner[4];
    if (!expect(f, index, x_mm, y_mm, expected) ||
        !chain_find_square(&d->view, expected, f->contrast, &d->limits, d->points, corner)) {
        return 0;
    }
    return keep(f, index, x_mm, y_mm, expected, corner) && f->found[f->count - 1].index == index;
}

/** Find a square towards `end`, as far from the first one as can be. */
static void find_far(follower_t *f, int end)
{
    const int first = f->found[0].index;
    int distance = end - first, tried = 0;
    for (; tried < TRIES && abs(distance) >= 2; ++tried) {
        if (find_square(f, first + distance)) {
            break;
        }
        distance /= 2;
    }
    /* From a nearer square the way on to the far one is known better. */
    if (tried > 0 && tried < TRIES && abs(distance) >= 2) {
        find_square(f, first + (distance + end - first) / 2);
    }
}

/** Sort what was found into a row. */
static void row_of_found(const follower_t *f, chain_t *chain)
{
    chain->count = 0;
    for (int i = 0; i < f->count; ++i) {
        int at = chain->count++;
        const int place = f->found[i].index - OPMS_BAR_ORIGIN;
        for (; at > 0 && chain->square[at - 1].place > place; --at) {
            chain->square[at] = chain->square[at - 1];
        }
        chain->square[at].place = place;
        for (int c = 0; c < 4; ++c) {
            chain->square[at].corner[c] = f->found[i].corner[c];
        }
    }
}

/** Find squares far apart, and their map. */
static int find_row(follower_t *f, bar_start_t *start)
{
    const int middle_square = (f->low + f->high) / 2, apart = (f->high - f->low) / 4;
    const int starts[STARTS] = {middle_square, middle_square - apart, middle_square + apart};
    for (int i = 0; i < STARTS && f->count == 0; ++i) {
        find_first(f, starts[i]);
    }
    if (f->count == 0) {
        return 0;
    }
    /* The outermost squares may be cut by the border. */
    find_far(f, f->high - 1);
    find_far(f, f->low + 1);
    chain_t row;
    row_of_found(f, &row);
    const int span = row.square[row.count - 1].place - row.square[0].place;
    if (row.count == 2 && span >= SPAN_LEAST) {
        find_square(f, row.square[0].place + span / 2 + OPMS_BAR_ORIGIN);
        row_of_found(f, &row);
    }
    const opms_bar_detector_t *d = f->d;
    return row.count >= FOUND_LEAST && span >= SPAN_LEAST &&
           chain_fit_far(&row, &d->local_lens, d->ray_limit, &start->map, &start->shift_px);
}

/** Range of the squares that the map has in the picture; returns how many these are. */
static int see_squares(const opms_bar_detector_t *d, bar_start_t *start)
{
    int count = 0;
    start->first = OPMS_BAR_SQUARES;
    start->last = -1;
    for (int k = 0; k < OPMS_BAR_SQUARES; ++k) {
        double px[2];
        if (plane_map_project(&start->map, &d->local_lens, d->ray_limit, 0,
                              BAR_PITCH_MM * (k - OPMS_BAR_ORIGIN), px, NULL) &&
            view_holds(&d->view, px[0], px[1], 2)) {
            start->first = k < start->first ? k : start->first;
            start->last = k;
            ++count;
        }
    }
    return count;
}

int follow_hint(opms_bar_detector_t *d, const opms_transform_t *hint, int least_contrast,
                const opms_roi_t *roi, opms_bar_summary_t *summary)
{
    follower_t f = {.d = d, .least_contrast = least_contrast, .traces = TRACES_MOST};
    bar_start_t start;
    if (!map_of_hint(hint, &f) || !find_row(&f, &start)) {
        return 0;
    }
    const int seen = see_squares(d, &start);
    /* What hides more than half of the bar is a reason to search for it. */
    start.squares_least = seen / 2;
    if (seen < FOUND_LEAST ||
        bar_settle(d, &start, f.contrast, roi, summary) != OPMS_BAR_LOCATED) {
        d->settled = 0;
        return 0;
    }
    return 1;
}
