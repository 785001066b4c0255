/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * From labelled squares to the map that fits all measured stretches. */
#ifndef OPMS_BAR_MAP_REFINE_H
#define OPMS_BAR_MAP_REFINE_H

#include <opms/bar.h>

#include "bar/edge_fit.h"

#define MAP_UNKNOWNS 8
#define FIT_UNKNOWNS_MOST 15

typedef enum map_verdict {
    MAP_LOST, /**< too few stretches agree */
    MAP_UNSURE,
    MAP_FIRM
} map_verdict_t;

/** The linear equations of the good stretches, by columns for the vector unit. */
typedef struct fit_columns {
    int count;
    uint16_t stretch[OPMS_BAR_EDGES_MAX];
    double by[FIT_UNKNOWNS_MOST][OPMS_BAR_EDGES_MAX]; /**< gradient of each offset; the common
                                                           shift follows the map */
    double target[OPMS_BAR_EDGES_MAX];    /**< the offset */
    double residual[OPMS_BAR_EDGES_MAX];
    double per_sigma[OPMS_BAR_EDGES_MAX]; /**< 0 in what fills up the last lanes */
} fit_columns_t;

/** Stretches of the last pass and what they say together. */
typedef struct bar_fit {
    int count;
    grey_levels_t levels;
    stretch_t stretch[OPMS_BAR_EDGES_MAX];
    fit_sums_t sums[OPMS_BAR_EDGES_MAX];
    shape_info_t shape[OPMS_BAR_EDGES_MAX];
    float residual[OPMS_BAR_EDGES_MAX]; /**< offset from the fitted map, px */
    float sigma[OPMS_BAR_EDGES_MAX];    /**< px */
    uint8_t good[OPMS_BAR_EDGES_MAX];
    uint8_t seen[OPMS_BAR_EDGES_MAX]; /**< a side is there, if not one to be measured by */
    float shift_gain[OPMS_BAR_EDGES_MAX]; /**< by which each takes part in the common shift */
    int unknowns;                       /**< of the fit: the map's, then the picture's */
    fit_columns_t columns;
    float contrast, noise;
} bar_fit_t;

/** Refine the scene's map, shift and blur on all squares that can be seen.
 *
 * @param first, last  Range of squares that the map was fitted to.
 * @param contrast     Least grey levels from black to white.
 * @return MAP_UNSURE where so little is left of saturated, moving profiles that their middle is not
 * known. */
map_verdict_t map_refine(edge_scene_t *scene, int first, int last, float contrast, bar_fit_t *fit);

#endif
