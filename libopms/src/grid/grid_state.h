/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Nodes while they are being found, on a lattice of their own. */
#ifndef OPMS_GRID_GRID_STATE_H
#define OPMS_GRID_GRID_STATE_H

#include <opms/grid.h>

#include "grid/line_profile.h"
#include "grid/valley.h"

/* The seed lies in the lattice's middle; the grid's longer side fits whichever way it turns. */
#define LATTICE 96
#define LATTICE_MIDDLE (LATTICE / 2)
#define CELLS (LATTICE * LATTICE)

enum { NODE_UNKNOWN = 0, NODE_FOUND = 1 };

/* The four arms of a node: where its lines go on. */
enum { ARM_PLUS_I = 1, ARM_MINUS_I = 2, ARM_PLUS_J = 4, ARM_MINUS_J = 8 };

/** One node of the lattice. */
typedef struct lattice_node {
    vec2_t at;
    vec2_t step[2];  /**< to the next node along i, along j */
    vec2_t bend[2];  /**< how the fit moves the node per curvature (1/px) of each line */
    float sigma;     /**< px; 0 until it is fitted */
    float contrast;  /**< of its fainter line, grey levels */
    uint8_t state;   /**< NODE_... */
    uint8_t tries;
    uint8_t arms;    /**< those that are seen */
} lattice_node_t;

struct opms_grid_detector {
    opms_grid_options_t options;
    view_t view;
    lattice_node_t lattice[CELLS];
    uint16_t queue[CELLS];
    int queue_in, queue_out;
    uint32_t found; /**< nodes of the lattice that are found */
    profile_store_t profiles;
    float blur;     /**< px, standard deviation */
    int rows;       /**< of pixels that are read of an arm at most */
    float noise, contrast;
    uint32_t node_count;
    opms_node_t nodes[OPMS_GRID_NODES_MAX];
};

static inline int lattice_index(int i, int j)
{
    return j * LATTICE + i;
}

/** The node at (i, j), or NULL where it is not found or outside. */
static inline lattice_node_t *node_at(opms_grid_detector_t *d, int i, int j)
{
    if (i < 0 || j < 0 || i >= LATTICE || j >= LATTICE) {
        return NULL;
    }
    lattice_node_t *node = &d->lattice[lattice_index(i, j)];
    return node->state == NODE_FOUND ? node : NULL;
}

#endif
