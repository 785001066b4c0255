/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Nodes as the crossings of two fitted lines. */
#ifndef OPMS_GRID_NODE_FIT_H
#define OPMS_GRID_NODE_FIT_H

#include "grid/grid_state.h"

/** Estimate the picture's blur, then move every node of the lattice to where its lines cross and
 * give it its sigma; nodes whose lines cannot be measured are dropped. Fills in noise, contrast
 * and blur. */
void fit_nodes(opms_grid_detector_t *d);

/** Fit one node again, some of its arms left out (ARM_...). */
void refit_node(opms_grid_detector_t *d, int i, int j, unsigned without_arms);

/** Take off what the bending of the lines has done to the fits; once, and last: the curvature at
 * a node is that of its neighbours, which must be where they belong. All before any moves. */
void straighten_nodes(opms_grid_detector_t *d);

#endif
