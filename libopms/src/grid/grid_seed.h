/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A first cell of the grid: white between four lines. */
#ifndef OPMS_GRID_GRID_SEED_H
#define OPMS_GRID_GRID_SEED_H

#include "grid/valley.h"

/** Corners of a cell, in order around it: (0,0), (1,0), (1,1), (0,1) of its own axes. */
typedef struct grid_cell {
    vec2_t corner[4];
} grid_cell_t;

/** Look for a cell around a point. @return 1 if there is one. */
int find_cell(const view_t *view, vec2_t around, float min_pitch, grid_cell_t *cell);

#endif
