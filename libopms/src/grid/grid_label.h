/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Labels: where the marker is, and which way the grid turns. */
#ifndef OPMS_GRID_GRID_LABEL_H
#define OPMS_GRID_GRID_LABEL_H

#include "grid/grid_state.h"

/** From the lattice to labels: label = 50 + turn (lattice - origin). */
typedef struct lattice_label {
    int origin[2];
    int turn[4]; /**< row-major */
    float margin; /**< contrast of the marker over the next best place, 0 to 1 */
} lattice_label_t;

/** Look for the marker.
 * @return 1 where it is certain; else `label` keeps the lattice's own axes, made right-handed. */
int label_lattice(opms_grid_detector_t *d, lattice_label_t *label);

/** Write the nodes by label. Those outside of the sheet make it no such grid: @return 0. */
int write_nodes(opms_grid_detector_t *d, const lattice_label_t *label, int certain);

#endif
