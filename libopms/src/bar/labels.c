/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/labels.h"

#include <math.h>
#include <string.h>

#include "algebra/wide_lanes.h"
#include "bar/bar_code.h"

/* Each cell gives a soft value, 0 black to 1 white, normalised by its own square's black and the
 * white margins next to it. A place of the row on the bar predicts which cells are black; how black
 * they come out is not known beforehand, since blur and saturated white can nearly close a cell,
 * and neighbouring cells run into one another when they are small in the picture. So each
 * hypothesis is a linear regression on the printed cells and on the leak between neighbours, and
 * hypotheses are compared by their likelihood with the noise estimated from the residual, which has
 * a floor. */

#define SIGMA_LEAST 0.025     /* of a soft value about its prediction: what noise alone does */
#define SIGMA_OF_DEPTH 0.075  /* and what an inexact map and blur do, as a part of a cell's depth */
#define MARGIN_NEEDED 9.0     /* nats between the best place and the next */
#define EXPLAINED_LEAST 0.6   /* part of the values' scatter that the best place explains */
#define DEPTH_LEAST 0.08      /* of a black cell below white */
#define SQUARES_NEEDED 3
#define LEAK_MOST 0.4         /* of a cell into each neighbour, relative to its depth */

#define BITS WIDE /* of a square's cells, those beyond BAR_CELLS empty */
#define PATCH_X_MM 12.6
#define PATCH_Y_MM 15.9

typedef struct row_cells {
    int count; /* squares */
    int seen;  /* cells */
    int place[CHAIN_MAX];
    double rr; /* sum of squares of the darkness */
    float dark[CHAIN_MAX][BITS]; /* 1 - value by bit of the row's own reading, 0 where not seen */
    float read[CHAIN_MAX][BITS]; /* 1 where it is seen */
} row_cells_t;

/** Where a square and its cells are in the picture: pixels between four projected points, which
 * over so small a part of the bar differ from the projection by less than matters here. */
typedef struct square_patch {
    float at[2], by_x[2], by_y[2], by_xy[2]; /* px = at + x by_x + y by_y + x y by_xy, mm */
} square_patch_t;

static int patch_of(const plane_map_t *map, const opms_lens_t *lens, double ray_limit, double y,
                    square_patch_t *patch)
{
    double centre[2], jac[4], corner[4][2];
    if (!plane_map_project(map, lens, ray_limit, 0, y, centre, jac)) {
        return 0;
    }
    for (int c = 0; c < 4; ++c) {
        const double dx = c & 1 ? PATCH_X_MM : -PATCH_X_MM, dy = c & 2 ? PATCH_Y_MM : -PATCH_Y_MM;
        if (!plane_map_project(map, lens, ray_limit, dx, y + dy, corner[c], NULL)) {
            corner[c][0] = centre[0] + jac[0] * dx + jac[1] * dy; /* beyond the picture's border */
            corner[c][1] = centre[1] + jac[2] * dx + jac[3] * dy;
        }
    }
    for (int axis = 0; axis < 2; ++axis) {
        const double a = corner[0][axis], b = corner[1][axis], c = corner[2][axis],
                     d = corner[3][axis];
        patch->at[axis] = (float)(0.25 * (a + b + c + d));
        patch->by_x[axis] = (float)((b + d - a - c) * (0.25 / PATCH_X_MM));
        patch->by_y[axis] = (float)((c + d - a - b) * (0.25 / PATCH_Y_MM));
        patch->by_xy[axis] = (float)((a + d - b - c) * (0.25 / (PATCH_X_MM * PATCH_Y_MM)));
    }
    return 1;
}

static int sample(const view_t *view, const square_patch_t *patch, float x, float y, float *value)
{
    float px[2];
    for (int axis = 0; axis < 2; ++axis) {
        px[axis] = patch->at[axis] + x * (patch->by_x[axis] + y * patch->by_xy[axis]) +
                   y * patch->by_y[axis];
    }
    if (!view_holds(view, (double)px[0], (double)px[1], 1)) {
        return 0;
    }
    *value = view_bilinear(view, px[0], px[1]);
    return 1;
}

/** Mean of a line of samples along Y through a cell's middle: Y is its longer side. */
static int sample_cell(const view_t *view, const square_patch_t *patch, float x, float y,
                       float *value)
{
    float sum = 0;
    for (int i = -1; i <= 1; ++i) {
        float v;
        if (!sample(view, patch, x, y + 0.9f * (float)i, &v)) {
            return 0;
        }
        sum += v;
    }
    *value = sum / 3.f;
    return 1;
}

/** Black of a square and white of the margins next to it; 0 where they are not seen. */
static int read_levels(const view_t *view, const square_patch_t *patch, float *low, float *high)
{
    float black = 0, white = 0, v;
    int blacks = 0, whites = 0;
    for (int i = -1; i <= 1; ++i) {
        if (sample(view, patch, 4.f * (float)i, 0.f, &v)) {
            black += v;
            ++blacks;
        }
        for (int side = -1; side <= 1; side += 2) {
            if (sample(view, patch, 12.6f * (float)side, 5.f * (float)i, &v)) {
                white += v;
                ++whites;
            }
        }
    }
    if (blacks == 0 || whites == 0) {
        return 0;
    }
    *low = black / (float)blacks;
    *high = white / (float)whites;
    return *high > *low;
}

static void read_square(const view_t *view, const plane_map_t *map, const opms_lens_t *lens,
                        double ray_limit, int i, row_cells_t *cells)
{
    square_patch_t patch;
    float low, high, v;
    memset(cells->dark[i], 0, sizeof cells->dark[i]);
    memset(cells->read[i], 0, sizeof cells->read[i]);
    if (!patch_of(map, lens, ray_limit, BAR_PITCH_MM * cells->place[i], &patch) ||
        !read_levels(view, &patch, &low, &high)) {
        return;
    }
    for (int bit = 0; bit < BAR_CELLS; ++bit) {
        if (sample_cell(view, &patch, (float)bar_cell_x_mm[bit], (float)bar_cell_y_mm[bit], &v)) {
            const float soft = (v - low) / (high - low);
            const float dark = 1.f - (soft < -0.3f ? -0.3f : soft > 1.3f ? 1.3f : soft);
            cells->dark[i][bit] = dark;
            cells->read[i][bit] = 1.f;
            cells->rr += (double)(dark * dark);
            ++cells->seen;
        }
    }
}

/** Black (1) or white (0) at X position 0 (-11.25 mm) to 5 of the gap that holds a cell. */
static float cell_of(unsigned gap, int position)
{
    return position < 0 || position >= BAR_CELLS ? 0.f : (float)(gap >> position & 1u);
}

/** What is printed around every square, in the order in which a row that runs with the bar, or
 * against it, reads the cells. */
typedef struct printed_cells {
    float e[OPMS_BAR_SQUARES][BITS]; /* black cells */
    float l[OPMS_BAR_SQUARES][BITS]; /* black cells next to them, less twice their own */
} printed_cells_t;

static void print_cells(int turn, printed_cells_t *printed)
{
    memset(printed, 0, sizeof *printed);
    for (int k = 0; k < OPMS_BAR_SQUARES; ++k) {
        const unsigned gap[2] = {bar_gap_cells(k, -1), bar_gap_cells(k, 1)};
        for (int bit = 0; bit < BAR_CELLS; ++bit) {
            /* Seen from the other end, bit b of a reading is bit 5 - b of the print. */
            const int printed_bit = turn ? BAR_CELLS - 1 - bit : bit;
            const unsigned mask = gap[printed_bit >= 3];
            const int position = BAR_CELLS - 1 - printed_bit;
            const float e = cell_of(mask, position);
            printed->e[k][bit] = e;
            printed->l[k][bit] = cell_of(mask, position - 1) + cell_of(mask, position + 1) - 2 * e;
        }
    }
}

typedef struct regression {
    double rr;         /* of the darkness r = 1 - value, about white */
    double ee, el, ll; /* e: printed black cell, l: black cells next to it */
    double er, lr;
} regression_t;

static void regress(const row_cells_t *cells, const printed_cells_t *printed, int turn, int offset,
                    regression_t *sums)
{
    wide_t ee = {0}, el = {0}, ll = {0}, er = {0}, lr = {0};
    for (int i = 0; i < cells->count; ++i) {
        const int index = turn ? offset - cells->place[i] : offset + cells->place[i];
        const wide_t read = wide_load(cells->read[i]), r = wide_load(cells->dark[i]);
        const wide_t e = wide_load(printed->e[index]), l = wide_load(printed->l[index]);
        const wide_t e_read = e * read, l_read = l * read;
        ee += e_read * e;
        el += e_read * l;
        ll += l_read * l;
        er += e * r;
        lr += l * r;
    }
    sums->rr = cells->rr;
    sums->ee = (double)wide_sum(ee);
    sums->el = (double)wide_sum(el);
    sums->ll = (double)wide_sum(ll);
    sums->er = (double)wide_sum(er);
    sums->lr = (double)wide_sum(lr);
}

/** Residual sum of squares of a row at a place of the bar, with the best depth and leak. */
static double misfit(const regression_t *f, double *cell_depth)
{
    *cell_depth = 0;
    if (!(f->ee > 0)) {
        return f->rr;
    }
    const double det = f->ee * f->ll - f->el * f->el;
    double depth = f->er / f->ee, leak = 0;
    if (det > 1e-6 * f->ee * f->ll) {
        const double both = (f->ll * f->er - f->el * f->lr) / det;
        leak = (f->ee * f->lr - f->el * f->er) / det;
        leak = leak < 0 ? 0 : leak;
        leak = leak > LEAK_MOST * both ? LEAK_MOST * both : leak;
        if (both > 0) {
            depth = (f->er - leak * f->el) / f->ee;
        } else {
            leak = 0;
        }
    }
    if (depth < DEPTH_LEAST) {
        return f->rr;
    }
    depth = depth > 1.3 ? 1.3 : depth;
    *cell_depth = depth;
    return f->rr - 2 * (depth * f->er + leak * f->lr) + depth * depth * f->ee +
           2 * depth * leak * f->el + leak * leak * f->ll;
}

label_verdict_t labels_decide(const view_t *view, const chain_t *chain, const plane_map_t *map,
                              const opms_lens_t *lens, double ray_limit, labels_t *labels)
{
    row_cells_t cells;
    cells.count = chain->count;
    cells.seen = 0;
    cells.rr = 0;
    int first = chain->square[0].place, last = first;
    for (int i = 0; i < chain->count; ++i) {
        cells.place[i] = chain->square[i].place;
        first = cells.place[i] < first ? cells.place[i] : first;
        last = cells.place[i] > last ? cells.place[i] : last;
        read_square(view, map, lens, ray_limit, i, &cells);
    }
    double best = 1e30, next = 1e30;
    double depth = 0;
    const double scatter = cells.rr;
    const int values = cells.seen;
    for (int turn = 0; turn < 2; ++turn) {
        printed_cells_t printed;
        print_cells(turn, &printed);
        for (int offset = 0; offset < 2 * OPMS_BAR_SQUARES; ++offset) {
            const int from = turn ? offset - last : offset + first - OPMS_BAR_SQUARES;
            const int base = turn ? offset : offset - OPMS_BAR_SQUARES;
            if (from < 0 || from + last - first >= OPMS_BAR_SQUARES) {
                continue;
            }
            regression_t sums;
            regress(&cells, &printed, turn, base, &sums);
            double cell_depth;
            const double m = misfit(&sums, &cell_depth);
            if (m < best) {
                next = best;
                best = m;
                depth = cell_depth;
                labels->turn = turn;
                labels->offset = base;
            } else if (m < next) {
                next = m;
            }
        }
    }
    labels->margin = 0;
    if (values == 0 || chain->count < SQUARES_NEEDED || best > (1 - EXPLAINED_LEAST) * scatter) {
        return LABELS_NOT_A_BAR;
    }
    const double sigma = SIGMA_LEAST + SIGMA_OF_DEPTH * depth;
    const double floor_rss = sigma * sigma * values;
    labels->margin = 0.5 * values * log((fmin(next, scatter) + floor_rss) / (best + floor_rss));
    return labels->margin >= MARGIN_NEEDED ? LABELS_CERTAIN : LABELS_UNDECIDED;
}
