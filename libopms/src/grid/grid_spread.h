/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * From one cell to all nodes: each is predicted from its neighbours and confirmed by its arms. */
#ifndef OPMS_GRID_GRID_SPREAD_H
#define OPMS_GRID_GRID_SPREAD_H

#include "grid/grid_seed.h"
#include "grid/grid_state.h"

/** Fill the lattice from a cell. @return nodes found. */
uint32_t spread_nodes(opms_grid_detector_t *d, const grid_cell_t *cell);

#endif
