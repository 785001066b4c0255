/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Do the nodes scatter as their sigmas say? */
#ifndef OPMS_GRID_NODE_SCATTER_H
#define OPMS_GRID_NODE_SCATTER_H

#include "grid/grid_state.h"

/** Where the nodes scatter by more than their sigmas say, raise all sigmas to what they do. */
void hold_sigmas_to_scatter(opms_grid_detector_t *d);

#endif
