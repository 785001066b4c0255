/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/labels.h"

#include <math.h>
#include <string.h>

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

typedef struct row_cells {
    int count; /* squares */
    int place[CHAIN_MAX];
    float value[CHAIN_MAX][BAR_CELLS]; /* by bit of the row's own reading; < -1 if not seen */
} row_cells_t;

static int sample(const view_t *view, const plane_map_t *map, const opms_lens_t *lens,
                  double ray_limit, double x_mm, double y_mm, float *value)
{
    double px[2];
    if (!plane_map_project(map, lens, ray_limit, x_mm, y_mm, px, NULL) ||
        !view_holds(view, px[0], px[1], 1)) {
        return 0;
    }
    *value = view_bilinear(view, (float)px[0], (float)px[1]);
    return 1;
}

/** Mean of a line of samples along Y through a cell's middle: Y is its longer side. */
static int sample_cell(const view_t *view, const plane_map_t *map, const opms_lens_t *lens,
                       double ray_limit, double x_mm, double y_mm, float *value)
{
    float sum = 0;
    for (int i = -1; i <= 1; ++i) {
        float v;
        if (!sample(view, map, lens, ray_limit, x_mm, y_mm + 0.9 * i, &v)) {
            return 0;
        }
        sum += v;
    }
    *value = sum / 3.f;
    return 1;
}

static void read_square(const view_t *view, const plane_map_t *map, const opms_lens_t *lens,
                        double ray_limit, int place, float value[BAR_CELLS])
{
    const double y = BAR_PITCH_MM * place;
    float black = 0, white = 0, v;
    int blacks = 0, whites = 0;
    for (int i = -1; i <= 1; ++i) {
        if (sample(view, map, lens, ray_limit, 4.0 * i, y, &v)) {
            black += v;
            ++blacks;
        }
        for (int side = -1; side <= 1; side += 2) {
            if (sample(view, map, lens, ray_limit, 12.6 * side, y + 5.0 * i, &v)) {
                white += v;
                ++whites;
            }
        }
    }
    for (int bit = 0; bit < BAR_CELLS; ++bit) {
        value[bit] = -2.f;
        if (blacks > 0 && whites > 0 && white * (float)blacks > black * (float)whites &&
            sample_cell(view, map, lens, ray_limit, bar_cell_x_mm[bit], y + bar_cell_y_mm[bit],
                        &v)) {
            const float low = black / (float)blacks, high = white / (float)whites;
            const float soft = (v - low) / (high - low);
            value[bit] = soft < -0.3f ? -0.3f : soft > 1.3f ? 1.3f : soft;
        }
    }
}

/** Black (1) or white (0) at X position 0 (-11.25 mm) to 5 of the gap that holds a cell. */
static float cell_of(unsigned gap, int position)
{
    return position < 0 || position >= BAR_CELLS ? 0.f : (float)(gap >> position & 1u);
}

typedef struct regression {
    int n;
    double rr;         /* of the darkness r = 1 - value, about white */
    double ee, el, ll; /* e: printed black cell, l: black cells next to it */
    double er, lr;
} regression_t;

static void regress(const row_cells_t *cells, int turn, int offset, regression_t *sums)
{
    memset(sums, 0, sizeof *sums);
    for (int i = 0; i < cells->count; ++i) {
        const int index = turn ? offset - cells->place[i] : offset + cells->place[i];
        const unsigned gap[2] = {bar_gap_cells(index, -1), bar_gap_cells(index, 1)};
        for (int bit = 0; bit < BAR_CELLS; ++bit) {
            if (cells->value[i][bit] < -1.f) {
                continue;
            }
            /* Seen from the other end, bit b of a reading is bit 5 - b of the print. */
            const int printed = turn ? BAR_CELLS - 1 - bit : bit;
            const unsigned mask = gap[printed >= 3];
            const int position = BAR_CELLS - 1 - printed;
            const double e = (double)cell_of(mask, position);
            const double l =
                (double)(cell_of(mask, position - 1) + cell_of(mask, position + 1)) - 2 * e;
            const double r = 1.0 - (double)cells->value[i][bit];
            ++sums->n;
            sums->rr += r * r;
            sums->ee += e * e;
            sums->el += e * l;
            sums->ll += l * l;
            sums->er += e * r;
            sums->lr += l * r;
        }
    }
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
    row_cells_t cells = {.count = chain->count};
    int first = chain->square[0].place, last = first;
    for (int i = 0; i < chain->count; ++i) {
        cells.place[i] = chain->square[i].place;
        first = cells.place[i] < first ? cells.place[i] : first;
        last = cells.place[i] > last ? cells.place[i] : last;
        read_square(view, map, lens, ray_limit, cells.place[i], cells.value[i]);
    }
    double best = 1e30, next = 1e30;
    double scatter = 0, depth = 0;
    int values = 0;
    for (int turn = 0; turn < 2; ++turn) {
        for (int offset = 0; offset < 2 * OPMS_BAR_SQUARES; ++offset) {
            const int from = turn ? offset - last : offset + first - OPMS_BAR_SQUARES;
            const int base = turn ? offset : offset - OPMS_BAR_SQUARES;
            if (from < 0 || from + last - first >= OPMS_BAR_SQUARES) {
                continue;
            }
            regression_t sums;
            regress(&cells, turn, base, &sums);
            double cell_depth;
            const double m = misfit(&sums, &cell_depth);
            if (m < best) {
                next = best;
                best = m;
                values = sums.n;
                scatter = sums.rr;
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
