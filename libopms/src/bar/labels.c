/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/labels.h"

#include <math.h>

#include "bar/bar_code.h"

/* Each cell gives a soft value, 0 black to 1 white, normalised by its own square's black and the
 * white margins next to it. A place of the row on the bar predicts all values; the sum of squared
 * differences is minus twice the log-likelihood times the variance. Neighbouring cells run into one
 * another when they are small in the picture, so the prediction has a leak from each cell to the
 * next along X, which is estimated with each hypothesis (it is one linear unknown). */

#define CELL_SIGMA 0.28      /* of a soft value about its prediction */
#define MARGIN_NEEDED 9.0    /* nats between the best place and the next */
#define MISFIT_ALLOWED 0.11  /* mean squared difference of a value, best place */
#define SQUARES_NEEDED 3
#define LEAK_MOST 0.33

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
        if (!sample(view, map, lens, ray_limit, x_mm, y_mm + 1.2 * i, &v)) {
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
            sample_cell(view, map, lens, ray_limit, bar_cell_x_mm[bit], y + bar_cell_y_mm[bit], &v)) {
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

/** Squared differences of a row from a place of the bar, with the best leak. */
static double misfit(const row_cells_t *cells, int turn, int offset, int *values)
{
    double rr = 0, rl = 0, ll = 0;
    int n = 0;
    for (int i = 0; i < cells->count; ++i) {
        const int index = turn ? offset - cells->place[i] : offset + cells->place[i];
        const unsigned gap[2] = {bar_gap_cells(index, -1), bar_gap_cells(index, 1)};
        for (int bit = 0; bit < BAR_CELLS; ++bit) {
            const float value = cells->value[i][bit];
            if (value < -1.f) {
                continue;
            }
            /* Seen from the other end, bit b of a reading is bit 5 - b of the print. */
            const int printed = turn ? BAR_CELLS - 1 - bit : bit;
            const unsigned mask = gap[printed >= 3];
            const int position = BAR_CELLS - 1 - printed;
            const float here = cell_of(mask, position);
            const float leak = cell_of(mask, position - 1) + cell_of(mask, position + 1) - 2.f * here;
            const float difference = (1.f - value) - here;
            rr += (double)(difference * difference);
            rl += (double)(difference * leak);
            ll += (double)(leak * leak);
            ++n;
        }
    }
    double part = ll > 0 ? rl / ll : 0;
    part = part < 0 ? 0 : part > LEAK_MOST ? LEAK_MOST : part;
    *values = n;
    return rr - 2 * part * rl + part * part * ll;
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
    int values = 0;
    for (int turn = 0; turn < 2; ++turn) {
        for (int offset = 0; offset < 2 * OPMS_BAR_SQUARES; ++offset) {
            const int from = turn ? offset - last : offset + first - OPMS_BAR_SQUARES;
            const int base = turn ? offset : offset - OPMS_BAR_SQUARES;
            if (from < 0 || from + last - first >= OPMS_BAR_SQUARES) {
                continue;
            }
            int n;
            const double m = misfit(&cells, turn, base, &n);
            if (m < best) {
                next = best;
                best = m;
                values = n;
                labels->turn = turn;
                labels->offset = base;
            } else if (m < next) {
                next = m;
            }
        }
    }
    if (values == 0 || chain->count < SQUARES_NEEDED || best > MISFIT_ALLOWED * values) {
        labels->margin = 0;
        return LABELS_NOT_A_BAR;
    }
    labels->margin = (next - best) / (2 * CELL_SIGMA * CELL_SIGMA);
    return labels->margin >= MARGIN_NEEDED ? LABELS_CERTAIN : LABELS_UNDECIDED;
}
