/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/chain.h"

#include <string.h>

#include "bar/bar_code.h"
#include "lens/lens_fast.h"

/* A square's neighbour along the bar lies one and a half sides away. Its corners are predicted from
 * the last one or two squares of the row, its threshold is measured at its own middle and margins,
 * and its contour must return corners near the predicted ones. A square that is hidden is jumped.
 */

#define LONGEST_GAP 6           /* squares that may be hidden in a row */
#define CORNER_TOLERANCE 0.38f  /* of the predicted square's sides */

static point_t along(point_t a, point_t b, float part)
{
    const point_t p = {a.x + part * (b.x - a.x), a.y + part * (b.y - a.y)};
    return p;
}

static point_t middle(const point_t corner[4])
{
    const point_t p = {0.25f * (corner[0].x + corner[1].x + corner[2].x + corner[3].x),
                       0.25f * (corner[0].y + corner[1].y + corner[2].y + corner[3].y)};
    return p;
}

static float span(point_t a, point_t b)
{
    return hypotf(a.x - b.x, a.y - b.y);
}

int chain_match_corners(const quad_t *quad, const point_t predicted[4], point_t corner[4])
{
    const float side_y =
        0.5f * (span(predicted[0], predicted[3]) + span(predicted[1], predicted[2]));
    const float side_x =
        0.5f * (span(predicted[0], predicted[1]) + span(predicted[3], predicted[2]));
    const float reach = CORNER_TOLERANCE * (side_x < side_y ? side_x : side_y) +
                        0.08f * (side_x + side_y);
    for (int turn = 0; turn < 4; ++turn) {
        float worst = 0;
        for (int k = 0; k < 4; ++k) {
            corner[k] = quad->corner[(turn + 4 - k) & 3]; /* contours run the other way round */
            const float d = span(corner[k], predicted[k]);
            worst = d > worst ? d : worst;
        }
        if (worst < reach) {
            return 1;
        }
    }
    return 0;
}

int chain_find_square(const view_t *view, const point_t predicted[4], float contrast,
                      const quad_limits_t *limits, point_t *points, point_t corner[4])
{
    const point_t mid = middle(predicted);
    /* The white margins at X = -12.5 and +12.5 mm. */
    const point_t low = along(mid, along(predicted[0], predicted[3], 0.5f), 1.25f);
    const point_t high = along(mid, along(predicted[1], predicted[2], 0.5f), 1.25f);
    if (!view_holds(view, mid.x, mid.y, 3) || !view_holds(view, low.x, low.y, 1) ||
        !view_holds(view, high.x, high.y, 1)) {
        return 0;
    }
    const float black = view_bilinear(view, mid.x, mid.y);
    const float white =
        0.5f * (view_bilinear(view, low.x, low.y) + view_bilinear(view, high.x, high.y));
    if (white - black < contrast) {
        return 0;
    }
    static const float part[2] = {0.5f,
                                  0.3f}; /* the lower one where blur joins a cell to the square */
    for (int i = 0; i < 2; ++i) {
        quad_t quad;
        if (quad_trace(view, (int)(mid.x + 0.5f), (int)(mid.y + 0.5f),
                       black + part[i] * (white - black), limits, points, &quad) &&
            chain_match_corners(&quad, predicted, corner)) {
            return 1;
        }
    }
    return 0;
}

/** Predict the square `steps` places beyond the last one of `row` (rows grow by their ends). */
static void predict(const struct chain_square *last, const struct chain_square *before, int steps,
                    int direction, point_t predicted[4])
{
    const int gap = before ? (last->place - before->place) * direction : 1;
    for (int k = 0; k < 4; ++k) {
        /* Corner k and the corner across the square along Y. */
        const int across = 3 - k;
        const point_t here = last->corner[k];
        float dx, dy;
        if (before) {
            dx = (here.x - before->corner[k].x) / (float)gap;
            dy = (here.y - before->corner[k].y) / (float)gap;
        } else {
            const float sign = (k == 0 || k == 1) ? (float)direction : -(float)direction;
            dx = sign * 1.5f * (last->corner[across].x - here.x);
            dy = sign * 1.5f * (last->corner[across].y - here.y);
        }
        predicted[k].x = here.x + (float)steps * dx;
        predicted[k].y = here.y + (float)steps * dy;
    }
}

static void grow_end(const view_t *view, float contrast, const quad_limits_t *limits,
                     point_t *points, int direction, int most, chain_t *chain)
{
    /* square[0] is the seed; this end's squares are appended as they are found. */
    struct chain_square last = chain->square[0], before = last;
    int has_before = 0;
    for (int i = 1; i < chain->count; ++i) { /* the other end helps to predict */
        if (chain->square[i].place == -direction) {
            before = chain->square[i];
            has_before = 1;
        }
    }
    const int room =
        chain->count + (most - chain->count + (direction > 0)) / (direction > 0 ? 2 : 1);
    while (chain->count < room) {
        const int reach = has_before ? LONGEST_GAP : 2;
        int step = 1;
        for (; step <= reach; ++step) {
            point_t predicted[4];
            predict(&last, has_before ? &before : NULL, step, direction, predicted);
            const point_t mid = middle(predicted);
            if (!view_holds(view, mid.x, mid.y, 0)) {
                return;
            }
            struct chain_square *next = &chain->square[chain->count];
            if (chain_find_square(view, predicted, contrast, limits, points, next->corner)) {
                next->place = last.place + step * direction;
                break;
            }
        }
        if (step > reach) {
            return;
        }
        before = last;
        has_before = 1;
        last = chain->square[chain->count++];
    }
}

static void sort_by_place(chain_t *chain)
{
    for (int i = 1; i < chain->count; ++i) {
        const struct chain_square square = chain->square[i];
        int j = i;
        for (; j > 0 && chain->square[j - 1].place > square.place; --j) {
            chain->square[j] = chain->square[j - 1];
        }
        chain->square[j] = square;
    }
}

int chain_grow(const view_t *view, const quad_t *seed, float contrast, const quad_limits_t *limits,
               point_t *points, int most, chain_t *chain)
{
    chain->count = 0;
    for (int axis = 0; axis < 2; ++axis) {
        chain_t row = {1, {{0, {{0, 0}, {0, 0}, {0, 0}, {0, 0}}}}};
        for (int k = 0; k < 4; ++k) {
            row.square[0].corner[k] = seed->corner[(axis + 4 - k) & 3];
        }
        grow_end(view, contrast, limits, points, 1, most, &row);
        grow_end(view, contrast, limits, points, -1, most, &row);
        if (row.count > chain->count) {
            *chain = row;
        }
        if (chain->count >= 4) {
            break;
        }
    }
    sort_by_place(chain);
    return chain->count;
}

/** Common outward shift of the sides, from the pitch between neighbours: a square is two thirds of
 * it. */
static float shift_of(const chain_t *chain)
{
    float sum = 0;
    int n = 0;
    for (int i = 0; i + 1 < chain->count; ++i) {
        const struct chain_square *a = &chain->square[i], *b = &chain->square[i + 1];
        if (b->place - a->place != 1) {
            continue;
        }
        const point_t ma = middle(a->corner), mb = middle(b->corner);
        const float side =
            0.25f * (span(a->corner[0], a->corner[3]) + span(a->corner[1], a->corner[2]) +
                     span(b->corner[0], b->corner[3]) + span(b->corner[1], b->corner[2]));
        sum += 0.5f * (side - span(ma, mb) * 2.f / 3.f);
        ++n;
    }
    return n ? sum / (float)n : 0;
}

/** Move the four sides of every square by a distance, outwards. */
static void move_sides(chain_t *chain, float outward)
{
    for (int i = 0; i < chain->count; ++i) {
        point_t *c = chain->square[i].corner;
        const float x = 0.5f * (span(c[0], c[1]) + span(c[3], c[2]));
        const float y = 0.5f * (span(c[0], c[3]) + span(c[1], c[2]));
        const point_t ux = {(c[1].x + c[2].x - c[0].x - c[3].x) / (2 * x),
                            (c[1].y + c[2].y - c[0].y - c[3].y) / (2 * x)};
        const point_t uy = {(c[2].x + c[3].x - c[0].x - c[1].x) / (2 * y),
                            (c[2].y + c[3].y - c[0].y - c[1].y) / (2 * y)};
        for (int k = 0; k < 4; ++k) {
            const float sx = (k == 1 || k == 2) ? outward : -outward,
                        sy = k >= 2 ? outward : -outward;
            c[k].x += sx * ux.x + sy * uy.x;
            c[k].y += sx * ux.y + sy * uy.y;
        }
    }
}

static int fit_corners(const chain_t *chain, const opms_lens_t *lens, plane_map_t *map)
{
    plane_pair_t pairs[4 * CHAIN_MAX];
    int count = 0;
    for (int i = 0; i < chain->count; ++i) {
        for (int k = 0; k < 4; ++k) {
            plane_pair_t *pair = &pairs[count];
            pair->x_mm = (k == 1 || k == 2) ? BAR_HALF_SQUARE_MM : -BAR_HALF_SQUARE_MM;
            pair->y_mm = BAR_PITCH_MM * chain->square[i].place +
                         (k >= 2 ? BAR_HALF_SQUARE_MM : -BAR_HALF_SQUARE_MM);
            count += lens_unproject_fast(lens, (double)chain->square[i].corner[k].x,
                                         (double)chain->square[i].corner[k].y, &pair->ray[0],
                                         &pair->ray[1]);
        }
    }
    return plane_map_fit(map, pairs, count);
}

/** Largest distance of a square's corners from the map, as a part of its shortest side. */
static double misfit(const struct chain_square *square, const opms_lens_t *lens, double ray_limit,
                     const plane_map_t *map)
{
    double worst = 0;
    for (int k = 0; k < 4; ++k) {
        double px[2];
        const double x = (k == 1 || k == 2) ? BAR_HALF_SQUARE_MM : -BAR_HALF_SQUARE_MM;
        const double y =
            BAR_PITCH_MM * square->place + (k >= 2 ? BAR_HALF_SQUARE_MM : -BAR_HALF_SQUARE_MM);
        if (!plane_map_project(map, lens, ray_limit, x, y, px, NULL)) {
            return 1e9;
        }
        const double d =
            hypot(px[0] - (double)square->corner[k].x, px[1] - (double)square->corner[k].y);
        worst = d > worst ? d : worst;
    }
    const double side = (double)fminf(span(square->corner[0], square->corner[1]),
                                      span(square->corner[1], square->corner[2]));
    const double allowed = 0.8 + 0.04 * side;
    return worst / allowed;
}

int chain_fit(chain_t *chain, const opms_lens_t *lens, double ray_limit, plane_map_t *map,
              double *shift_px)
{
    const float shift = shift_of(chain);
    move_sides(chain, -shift);
    *shift_px = (double)shift;
    while (chain->count >= 2) {
        if (!fit_corners(chain, lens, map)) {
            return 0;
        }
        int worst = -1;
        double most = 1;
        for (int i = 0; i < chain->count; ++i) {
            const double m = misfit(&chain->square[i], lens, ray_limit, map);
            if (m > most) {
                most = m;
                worst = i;
            }
        }
        if (worst < 0) {
            return 1;
        }
        memmove(&chain->square[worst], &chain->square[worst + 1],
                sizeof chain->square[0] * (size_t)(chain->count - worst - 1));
        --chain->count;
    }
    return 0;
}

/** Common outward shift of the sides of squares far apart, which leave the map little to err in. */
static double shift_from_map(const chain_t *chain, const opms_lens_t *lens, double ray_limit,
                             const plane_map_t *map)
{
    double sum = 0;
    for (int i = 0; i < chain->count; ++i) {
        const point_t *c = chain->square[i].corner;
        double px[2][2];
        for (int end = 0; end < 2; ++end) {
            const double y = BAR_PITCH_MM * chain->square[i].place +
                             (end ? BAR_HALF_SQUARE_MM : -BAR_HALF_SQUARE_MM);
            if (!plane_map_project(map, lens, ray_limit, 0, y, px[end], NULL)) {
                return 0;
            }
        }
        const double seen = 0.5 * (double)(span(c[0], c[3]) + span(c[1], c[2]));
        sum += 0.5 * (seen - hypot(px[1][0] - px[0][0], px[1][1] - px[0][1]));
    }
    return sum / chain->count;
}

int chain_fit_far(chain_t *chain, const opms_lens_t *lens, double ray_limit, plane_map_t *map,
                  double *shift_px)
{
    if (!fit_corners(chain, lens, map)) {
        return 0;
    }
    *shift_px = shift_from_map(chain, lens, ray_limit, map);
    move_sides(chain, (float)-*shift_px);
    if (!fit_corners(chain, lens, map)) {
        return 0;
    }
    for (int i = 0; i < chain->count; ++i) {
        if (misfit(&chain->square[i], lens, ray_limit, map) > 1) {
            return 0;
        }
    }
    return 1;
}
