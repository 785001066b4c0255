/* SPDX-License-Identifier: Apache-2.0 */
/* The marker is a black square from 3 to 9 mm in +X and +Y of the centre node: in one corner of one
 * cell. Every corner of every cell is compared with the three others of its cell, so that light
 * and shadow take no part; the darkest one must stand out clearly from all the rest.
 *
 * Seen from above, X to Y turns against the picture's u to v; a lattice that turns the other way
 * is mirrored first. After that the marker's corner tells the direction. */
#include "grid/grid_label.h"

#include <string.h>

#include "grid/grey_inside.h"
#include "grid/grid_sheet.h"

#define MARKER_MIDDLE 0.24f  /* of the pitch: 6 mm */
#define MARKER_SPREAD 0.05f  /* samples within it */
#define DARK_LEAST 0.35f     /* of the white */
#define MARGIN_LEAST 0.2f

/* Mean of five places of a cell's corner, where the marker would be. */
static float corner_grey(const view_t *view, const lattice_node_t *corner[4], int k)
{
    static const float around[5][2] = {{0, 0}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}};
    const vec2_t own = corner[k]->at;
    const vec2_t x = vec2_between(own, corner[(k + 1) % 4]->at);
    const vec2_t y = vec2_between(own, corner[(k + 3) % 4]->at);
    /* Where the opposite corner is beyond x + y: cells are no parallelograms. */
    const vec2_t both = vec2_between(vec2_add(x, y, 1.f),
                                     vec2_between(own, corner[(k + 2) % 4]->at));
    const vec2_t along = vec2_add(x, both, MARKER_MIDDLE);
    const vec2_t beside = vec2_add(y, both, MARKER_MIDDLE);
    const vec2_t middle = vec2_add(vec2_add(own, along, MARKER_MIDDLE), y, MARKER_MIDDLE);
    float sum = 0.f;
    for (int i = 0; i < 5; ++i) {
        const vec2_t row = vec2_add(middle, along, MARKER_SPREAD * around[i][0]);
        sum += grey_inside(view, vec2_add(row, beside, MARKER_SPREAD * around[i][1]));
    }
    return 0.2f * sum;
}

/* Darkness of each corner of a cell against the mean of the three others. */
static void darkness(const view_t *view, const lattice_node_t *corner[4], float dark[4])
{
    float grey[4];
    for (int k = 0; k < 4; ++k) {
        grey[k] = corner_grey(view, corner, k);
    }
    for (int k = 0; k < 4; ++k) {
        const float others = (grey[0] + grey[1] + grey[2] + grey[3] - grey[k]) / 3.f;
        dark[k] = others > 0.f ? 1.f - grey[k] / others : 0.f;
    }
}

typedef struct place {
    int i, j, corner;
    float dark;
} place_t;

/* 0 where there is no whole cell in the picture. */
static int cell_corners(opms_grid_detector_t *d, int i, int j, const lattice_node_t *corner[4])
{
    corner[0] = node_at(d, i, j);
    corner[1] = node_at(d, i + 1, j);
    corner[2] = node_at(d, i + 1, j + 1);
    corner[3] = node_at(d, i, j + 1);
    for (int k = 0; k < 4; ++k) {
        if (!corner[k] || !is_inside(&d->view, corner[k]->at)) {
            return 0;
        }
    }
    return 1;
}

/* The darkest corner of all cells, and how dark the next darkest is. */
static place_t darkest_corner(opms_grid_detector_t *d, float *next)
{
    place_t best = {0, 0, 0, 0.f};
    *next = 0.f;
    for (int q = 0; q < d->queue_in; ++q) {
        const int i = d->queue[q] % LATTICE, j = d->queue[q] / LATTICE;
        const lattice_node_t *corner[4];
        float dark[4];
        if (!cell_corners(d, i, j, corner)) {
            continue;
        }
        darkness(&d->view, corner, dark);
        for (int k = 0; k < 4; ++k) {
            if (dark[k] > best.dark) {
                const place_t place = {i, j, k, dark[k]};
                *next = best.dark;
                best = place;
            } else if (dark[k] > *next) {
                *next = dark[k];
            }
        }
    }
    return best;
}

/* Do the lattice's axes turn as the sheet's do when it is seen from above? */
static int is_mirrored(opms_grid_detector_t *d)
{
    int votes = 0;
    for (int q = 0; q < d->queue_in; ++q) {
        const int i = d->queue[q] % LATTICE, j = d->queue[q] / LATTICE;
        const lattice_node_t *node = node_at(d, i, j), *a = node_at(d, i + 1, j),
                             *b = node_at(d, i, j + 1);
        if (node && a && b) {
            const vec2_t x = {a->at.x - node->at.x, a->at.y - node->at.y};
            const vec2_t y = {b->at.x - node->at.x, b->at.y - node->at.y};
            votes += vec2_cross(x, y) < 0.f ? 1 : -1;
        }
    }
    return votes < 0;
}

int label_lattice(opms_grid_detector_t *d, lattice_label_t *label)
{
    /* Directions of +X and +Y from the centre node, for the marker in each corner of its cell. */
    static const int origin_of[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    static const int x_of[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    static const int y_of[4][2] = {{0, 1}, {-1, 0}, {0, -1}, {1, 0}};
    const int mirrored = is_mirrored(d);
    float next;
    const place_t place = darkest_corner(d, &next);
    const int certain = place.dark > DARK_LEAST && place.dark - next > MARGIN_LEAST;
    const int k = certain ? place.corner : 0;
    const int *x = mirrored ? y_of[k] : x_of[k], *y = mirrored ? x_of[k] : y_of[k];
    label->margin = certain ? place.dark - next : 0.f;
    label->origin[0] = certain ? place.i + origin_of[k][0] : LATTICE_MIDDLE;
    label->origin[1] = certain ? place.j + origin_of[k][1] : LATTICE_MIDDLE;
    /* Rows are the new axes: label - 50 = (x . p, y . p). */
    label->turn[0] = x[0];
    label->turn[1] = x[1];
    label->turn[2] = y[0];
    label->turn[3] = y[1];
    return certain;
}

static void label_of(const lattice_label_t *label, int i, int j, int32_t out[2])
{
    const int x = i - label->origin[0], y = j - label->origin[1];
    out[0] = OPMS_GRID_CENTRE + label->turn[0] * x + label->turn[1] * y;
    out[1] = OPMS_GRID_CENTRE + label->turn[2] * x + label->turn[3] * y;
}

/* By the second label, then by the first. */
static int comes_before(const opms_node_t *a, const opms_node_t *b)
{
    return a->label[1] != b->label[1] ? a->label[1] < b->label[1] : a->label[0] < b->label[0];
}

/* Rows of the lattice are nearly in order already: shell sort. */
static void sort_nodes(opms_node_t *nodes, uint32_t count)
{
    for (uint32_t gap = count / 2; gap > 0; gap /= 2) {
        for (uint32_t i = gap; i < count; ++i) {
            const opms_node_t node = nodes[i];
            uint32_t j = i;
            for (; j >= gap && comes_before(&node, &nodes[j - gap]); j -= gap) {
                nodes[j] = nodes[j - gap];
            }
            nodes[j] = node;
        }
    }
}

int write_nodes(opms_grid_detector_t *d, const lattice_label_t *label, int certain)
{
    d->node_count = 0;
    for (int q = 0; q < d->queue_in; ++q) {
        const lattice_node_t *from = &d->lattice[d->queue[q]];
        if (from->state != NODE_FOUND) {
            continue;
        }
        opms_node_t node;
        label_of(label, d->queue[q] % LATTICE, d->queue[q] / LATTICE, node.label);
        if ((certain && !is_on_sheet(node.label)) || d->node_count == OPMS_GRID_NODES_MAX) {
            d->node_count = 0;
            return 0;
        }
        node.px[0] = (double)from->at.x;
        node.px[1] = (double)from->at.y;
        node.sigma_px = (double)from->sigma;
        d->nodes[d->node_count++] = node;
    }
    sort_nodes(d->nodes, d->node_count);
    return 1;
}
