/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A stretch of one line of the grid, fitted to the raw pixels. */
#ifndef OPMS_GRID_LINE_FIT_H
#define OPMS_GRID_LINE_FIT_H

#include "grid/line_profile.h"
#include "grid/valley.h"

/** What is looked at. */
typedef struct line_stretch {
    vec2_t at;       /**< on the line: the node */
    vec2_t along;    /**< unit direction of the line */
    float from, to;  /**< px along it, on the plus side; and mirrored on the other */
    int plus, minus; /**< which of the two are looked at */
    int rows;        /**< of pixels that are read of each at most */
    float width;     /**< of the line, px */
    float reach;     /**< px on both sides of it */
    float blur;      /**< standard deviation, px */
    /** How well `along` is known: (noise / (contrast sigma_turn))^2; 0: not at all. */
    float turn_weight;
    profile_store_t *profiles;
} line_stretch_t;

/** What is found. */
typedef struct line_fit {
    float off;       /**< px from `at` to the line along (-along.y, along.x) */
    float variance;  /**< of off for unit noise */
    float bend;      /**< change of off per curvature (1/px) of the line */
    float contrast;  /**< grey levels */
    float noise;     /**< standard deviation about the model, grey levels */
    int pixels;
} line_fit_t;

/** Fit it. @return 0 where the pixels do not determine it. */
int fit_line(const view_t *view, const line_stretch_t *stretch, line_fit_t *fit);

#endif
