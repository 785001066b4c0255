/* SPDX-License-Identifier: Apache-2.0 */
#include "grid/grid_spread.h"

#include <string.h>

#define ARM 0.35f         /* of the step: between node and next node, clear of both crossings */
#define REACH 0.3f        /* of the step: how far off a line may be from where it is expected */
#define NEAR 0.1f         /* of the step: so far off it is, mostly */
#define WHITE_PX 2.f      /* beyond that, to see white: more beside wide lines, as NEAR is then */
#define DISAGREE 0.2f     /* of the step: between both arms of a line */
#define LEAST_DEPTH 0.10f /* of the white */
#define TRIES 3           /* a node refused from one side may be predicted better from another */

/* Where an arm's line runs: px off the expected place, along the other step's direction. */
typedef struct arm {
    int seen;
    vec2_t at;
    float off; /* in steps */
} arm_t;

/* The valley beside an arm's middle. It mostly lies where it is expected: then what is near is
 * enough to look at, some white on both sides included. */
static int find_valley(const view_t *view, vec2_t middle, vec2_t unit, float length,
                       valley_t *valley)
{
    const float near = NEAR * length + WHITE_PX;
    const float reach = REACH * length > 2.f ? REACH * length : 2.f;
    if (near < reach && nearest_valley(view, middle, unit, near, LEAST_DEPTH, valley) &&
        fabsf(valley->at) < near - WHITE_PX) {
        return 1;
    }
    return nearest_valley(view, middle, unit, reach, LEAST_DEPTH, valley);
}

static arm_t look_at_arm(const view_t *view, vec2_t node, vec2_t along, vec2_t across)
{
    arm_t arm = {0};
    const float length = vec2_length(across);
    const vec2_t unit = {across.x / length, across.y / length};
    const vec2_t middle = vec2_add(node, along, ARM);
    valley_t valley;
    if (find_valley(view, middle, unit, length, &valley)) {
        arm.seen = 1;
        arm.at = vec2_add(middle, unit, valley.at);
        arm.off = valley.at / length;
    }
    return arm;
}

/* The line through both arms, or through one of them with the expected direction. */
static int line_of_arms(const arm_t *plus, const arm_t *minus, vec2_t expected, vec2_t *point,
                        vec2_t *along)
{
    *along = expected;
    if (plus->seen && minus->seen) {
        if (fabsf(plus->off - minus->off) > DISAGREE) {
            return 0;
        }
        along->x = plus->at.x - minus->at.x;
        along->y = plus->at.y - minus->at.y;
    }
    *point = plus->seen ? plus->at : minus->at;
    return plus->seen || minus->seen;
}

/* Find the node near where it is expected; its steps are the expected ones on entry. */
static int confirm_node(const view_t *view, lattice_node_t *node)
{
    const vec2_t e[2] = {node->step[0], node->step[1]};
    const vec2_t back[2] = {{-e[0].x, -e[0].y}, {-e[1].x, -e[1].y}};
    const arm_t arms[4] = {
        look_at_arm(view, node->at, e[0], e[1]), look_at_arm(view, node->at, back[0], e[1]),
        look_at_arm(view, node->at, e[1], e[0]), look_at_arm(view, node->at, back[1], e[0])};
    vec2_t point[2], along[2];
    if (!line_of_arms(&arms[0], &arms[1], e[0], &point[0], &along[0]) ||
        !line_of_arms(&arms[2], &arms[3], e[1], &point[1], &along[1])) {
        return 0;
    }
    const float det = vec2_cross(along[0], along[1]);
    if (fabsf(det) < 0.15f * vec2_length(along[0]) * vec2_length(along[1])) {
        return 0;
    }
    const vec2_t between = {point[1].x - point[0].x, point[1].y - point[0].y};
    const vec2_t crossing = vec2_add(point[0], along[0], vec2_cross(between, along[1]) / det);
    const vec2_t off = {crossing.x - node->at.x, crossing.y - node->at.y};
    const float shorter = fminf(vec2_length(e[0]), vec2_length(e[1]));
    if (vec2_length(off) > REACH * shorter + 1.f ||
        !view_holds(view, crossing.x, crossing.y, 1.0)) {
        return 0;
    }
    node->at = crossing;
    node->arms = 0;
    for (int k = 0; k < 4; ++k) {
        node->arms |= (uint8_t)(arms[k].seen << k);
    }
    return 1;
}

static void accept_node(opms_grid_detector_t *d, int i, int j)
{
    d->lattice[lattice_index(i, j)].state = NODE_FOUND;
    d->queue[d->queue_in++] = (uint16_t)lattice_index(i, j);
    ++d->found;
}

/* The step that a neighbour in the row or column before, or after, has made. */
static vec2_t step_between(const lattice_node_t *from, const lattice_node_t *to)
{
    const vec2_t step = {to->at.x - from->at.x, to->at.y - from->at.y};
    return step;
}

/* Where the neighbour of (i, j) in direction (di, dj) should be: by the parallel steps on both
 * sides, by the step before, else by the step that the node was told. */
static vec2_t expected_step(opms_grid_detector_t *d, int i, int j, int di, int dj)
{
    const lattice_node_t *node = node_at(d, i, j);
    vec2_t sum = {0.f, 0.f};
    float weight = 0.f;
    for (int side = -1; side <= 1; side += 2) {
        const lattice_node_t *a = node_at(d, i + side * dj, j + side * di);
        const lattice_node_t *b = node_at(d, i + side * dj + di, j + side * di + dj);
        if (a && b) {
            sum = vec2_add(sum, step_between(a, b), 1.f);
            weight += 1.f;
        }
    }
    const lattice_node_t *before = node_at(d, i - di, j - dj);
    if (before) {
        sum = vec2_add(sum, step_between(before, node), 1.f);
        weight += 1.f;
    }
    if (weight > 0.f) {
        const vec2_t mean = {sum.x / weight, sum.y / weight};
        return mean;
    }
    const float sign = (float)(di + dj);
    const vec2_t told = {sign * node->step[di == 0].x, sign * node->step[di == 0].y};
    return told;
}

/* The step across the way from (i, j) to a node that lies at `at`: to what is found beside that
 * node, else beside (i, j), else what (i, j) was told. */
static vec2_t step_across(opms_grid_detector_t *d, int i, int j, int di, int dj, vec2_t at)
{
    const lattice_node_t *node = node_at(d, i, j);
    const lattice_node_t fresh = {.at = at};
    const int ai = dj != 0, aj = di != 0; /* the axis across, upwards */
    const lattice_node_t *beside[2][2] = {
        {node_at(d, i + di + ai, j + dj + aj), node_at(d, i + di - ai, j + dj - aj)},
        {node_at(d, i + ai, j + aj), node_at(d, i - ai, j - aj)}};
    for (int k = 0; k < 2; ++k) {
        const lattice_node_t *from = k == 0 ? &fresh : node;
        if (beside[k][0]) {
            return step_between(from, beside[k][0]);
        }
        if (beside[k][1]) {
            return step_between(beside[k][1], from);
        }
    }
    return node->step[ai == 0];
}

static void try_neighbour(opms_grid_detector_t *d, int i, int j, int di, int dj, float min_pitch)
{
    const int ni = i + di, nj = j + dj;
    if (ni < 1 || nj < 1 || ni > LATTICE - 2 || nj > LATTICE - 2) {
        return;
    }
    lattice_node_t *fresh = &d->lattice[lattice_index(ni, nj)];
    if (fresh->state == NODE_FOUND || fresh->tries >= TRIES) {
        return;
    }
    const lattice_node_t *node = node_at(d, i, j);
    const vec2_t step = expected_step(d, i, j, di, dj);
    const float sign = (float)(di + dj);
    ++fresh->tries;
    fresh->at = vec2_add(node->at, step, 1.f);
    fresh->step[di == 0].x = sign * step.x;
    fresh->step[di == 0].y = sign * step.y;
    fresh->step[di != 0] = step_across(d, i, j, di, dj, fresh->at);
    if (vec2_length(step) < min_pitch || !confirm_node(&d->view, fresh)) {
        return;
    }
    const vec2_t made = step_between(node, fresh);
    fresh->step[di == 0].x = sign * made.x;
    fresh->step[di == 0].y = sign * made.y;
    accept_node(d, ni, nj);
}

static void place_cell(opms_grid_detector_t *d, const grid_cell_t *cell)
{
    static const int place[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const vec2_t e[2] = {{cell->corner[1].x - cell->corner[0].x,
                          cell->corner[1].y - cell->corner[0].y},
                         {cell->corner[3].x - cell->corner[0].x,
                          cell->corner[3].y - cell->corner[0].y}};
    for (int k = 0; k < 4; ++k) {
        const int i = LATTICE_MIDDLE + place[k][0], j = LATTICE_MIDDLE + place[k][1];
        lattice_node_t *node = &d->lattice[lattice_index(i, j)];
        node->at = cell->corner[k];
        node->step[0] = e[0];
        node->step[1] = e[1];
        if (confirm_node(&d->view, node)) {
            accept_node(d, i, j);
        }
    }
}

uint32_t spread_nodes(opms_grid_detector_t *d, const grid_cell_t *cell)
{
    static const int ways[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    memset(d->lattice, 0, sizeof d->lattice);
    d->queue_in = d->queue_out = 0;
    d->found = 0;
    place_cell(d, cell);
    while (d->queue_out < d->queue_in) {
        const int index = d->queue[d->queue_out++];
        for (int k = 0; k < 4; ++k) {
            try_neighbour(d, index % LATTICE, index / LATTICE, ways[k][0], ways[k][1],
                          0.8f * (float)d->options.min_pitch_px);
        }
    }
    return d->found;
}
