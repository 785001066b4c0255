/* SPDX-License-Identifier: Apache-2.0 */
/* Nothing but its labels tells one part of a grid from the next. Between two pictures taken shortly
 * after one another a node moves little; a label that is wrong by one moves all nodes by a pitch.
 * So all quarter turns and shifts around the likely one are tried: the right one moves the nodes by
 * much less than the pitch, all others by much more, or nothing is certain. */
#include <math.h>
#include <string.h>

#include <opms/grid.h>

#include "base/fail.h"
#include "grid/grid_sheet.h"

#define STAGE "grid"
#define COMMON_LEAST 16
#define COMMON_PART 0.3  /* of the nodes that must be in both pictures */
#define MOVED_MOST 0.3   /* of the pitch, by the right labels */
#define OTHER_LEAST 0.55 /* by any others */

/* Known nodes by label; NULL where there is none. */
typedef struct sheet {
    const opms_node_t *at[OPMS_GRID_NODES_X][OPMS_GRID_NODES_Y];
} sheet_t;

/* Labels of the picture in question to those of the sheet. */
typedef struct guess {
    int turn; /* quarters */
    int shift[2];
    double moved; /* RMS, px; HUGE_VAL where too few nodes are common */
} guess_t;

static const opms_node_t *on_sheet(const sheet_t *sheet, int x, int y)
{
    x += HALF_X - OPMS_GRID_CENTRE;
    y += HALF_Y - OPMS_GRID_CENTRE;
    return x < 0 || y < 0 || x >= OPMS_GRID_NODES_X || y >= OPMS_GRID_NODES_Y ? NULL
                                                                              : sheet->at[x][y];
}

static void turned(int turn, const int32_t label[2], int out[2])
{
    static const int rows[4][4] = {{1, 0, 0, 1}, {0, -1, 1, 0}, {-1, 0, 0, -1}, {0, 1, -1, 0}};
    out[0] = rows[turn][0] * label[0] + rows[turn][1] * label[1];
    out[1] = rows[turn][2] * label[0] + rows[turn][3] * label[1];
}

static void guessed_label(const guess_t *guess, const int32_t label[2], int out[2])
{
    turned(guess->turn, label, out);
    out[0] += guess->shift[0];
    out[1] += guess->shift[1];
}

static double distance(const opms_node_t *a, const opms_node_t *b)
{
    return hypot(a->px[0] - b->px[0], a->px[1] - b->px[1]);
}

static void try_guess(const sheet_t *sheet, const opms_node_t *nodes, uint32_t count,
                      guess_t *guess)
{
    double sum = 0.0;
    uint32_t common = 0;
    for (uint32_t i = 0; i < count; ++i) {
        int label[2];
        guessed_label(guess, nodes[i].label, label);
        const opms_node_t *known = on_sheet(sheet, label[0], label[1]);
        if (known) {
            const double moved = distance(known, &nodes[i]);
            sum += moved * moved;
            ++common;
        }
    }
    const int enough = common >= COMMON_LEAST && common >= COMMON_PART * count;
    guess->moved = enough ? sqrt(sum / common) : HUGE_VAL;
}

static const opms_node_t *nearest(const opms_node_t *nodes, uint32_t count, const opms_node_t *to)
{
    const opms_node_t *best = &nodes[0];
    for (uint32_t i = 1; i < count; ++i) {
        best = distance(&nodes[i], to) < distance(best, to) ? &nodes[i] : best;
    }
    return best;
}

static opms_node_t middle_of(const opms_node_t *nodes, uint32_t count)
{
    opms_node_t middle = {{0, 0}, {0.0, 0.0}, 0.0};
    for (uint32_t i = 0; i < count; ++i) {
        middle.px[0] += nodes[i].px[0] / count;
        middle.px[1] += nodes[i].px[1] / count;
    }
    return middle;
}

/* Distance to the nearest neighbours in the middle of a picture. */
static double pitch_near(const opms_node_t *nodes, uint32_t count, const opms_node_t *node)
{
    double least = HUGE_VAL;
    for (uint32_t i = 0; i < count; ++i) {
        if (&nodes[i] != node) {
            least = fmin(least, distance(&nodes[i], node));
        }
    }
    return least;
}

/* Around the labels that the nearest known node suggests, in every quarter turn. */
static void best_guess(const sheet_t *sheet, const opms_node_t *known, uint32_t known_count,
                       const opms_node_t *nodes, uint32_t count, guess_t *best, guess_t *next)
{
    const opms_node_t centre = middle_of(nodes, count);
    const opms_node_t *middle = nearest(nodes, count, &centre);
    const opms_node_t *there = nearest(known, known_count, middle);
    best->moved = next->moved = HUGE_VAL;
    for (int k = 0; k < 36; ++k) {
        guess_t guess = {k / 9, {there->label[0] + k % 3 - 1, there->label[1] + k / 3 % 3 - 1}, 0};
        int label[2];
        turned(guess.turn, middle->label, label);
        guess.shift[0] -= label[0];
        guess.shift[1] -= label[1];
        try_guess(sheet, nodes, count, &guess);
        if (guess.moved < best->moved) {
            *next = *best;
            *best = guess;
        } else if (guess.moved < next->moved) {
            *next = guess;
        }
    }
}

static int fits_the_sheet(const guess_t *guess, const opms_node_t *nodes, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i) {
        int label[2];
        guessed_label(guess, nodes[i].label, label);
        const int32_t there[2] = {label[0], label[1]};
        if (!is_on_sheet(there)) {
            return 0;
        }
    }
    return 1;
}

opms_status_t opms_grid_relabel(const opms_node_t *known, uint32_t known_count, opms_node_t *nodes,
                                uint32_t count, uint32_t *certain, opms_error_t *err)
{
    if (!known || !nodes || !certain) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL",
                         !known ? "known" : !nodes ? "nodes" : "certain");
    }
    sheet_t sheet;
    memset(&sheet, 0, sizeof sheet);
    for (uint32_t i = 0; i < known_count; ++i) {
        if (!is_on_sheet(known[i].label)) {
            return opms_fail(err, OPMS_ERR_ARG, STAGE, (int32_t)i,
                             "known[%u]: label (%d, %d) is not on the sheet", (unsigned)i,
                             (int)known[i].label[0], (int)known[i].label[1]);
        }
        sheet.at[known[i].label[0] - OPMS_GRID_CENTRE + HALF_X]
                [known[i].label[1] - OPMS_GRID_CENTRE + HALF_Y] = &known[i];
    }
    *certain = 0;
    if (known_count < COMMON_LEAST || count < COMMON_LEAST) {
        return OPMS_OK;
    }
    guess_t best, next;
    best_guess(&sheet, known, known_count, nodes, count, &best, &next);
    const opms_node_t centre = middle_of(nodes, count);
    const opms_node_t *middle = nearest(nodes, count, &centre);
    const double pitch = pitch_near(nodes, count, middle);
    if (best.moved < MOVED_MOST * pitch && next.moved > OTHER_LEAST * pitch &&
        fits_the_sheet(&best, nodes, count)) {
        for (uint32_t i = 0; i < count; ++i) {
            int label[2];
            guessed_label(&best, nodes[i].label, label);
            nodes[i].label[0] = label[0];
            nodes[i].label[1] = label[1];
        }
        *certain = 1;
    }
    return OPMS_OK;
}
