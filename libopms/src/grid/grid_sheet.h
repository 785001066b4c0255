/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The printed sheet's labels. */
#ifndef OPMS_GRID_GRID_SHEET_H
#define OPMS_GRID_GRID_SHEET_H

#include <opms/grid.h>

#define HALF_X (OPMS_GRID_NODES_X / 2)
#define HALF_Y (OPMS_GRID_NODES_Y / 2)

/** Is there a node of this label? */
static inline int is_on_sheet(const int32_t label[2])
{
    const int64_t x = (int64_t)label[0] - OPMS_GRID_CENTRE;
    const int64_t y = (int64_t)label[1] - OPMS_GRID_CENTRE;
    return x >= -HALF_X && x <= HALF_X && y >= -HALF_Y && y <= HALF_Y;
}

#endif
