/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Sums over the pixels of some rows that cross a line of the grid. */
#ifndef OPMS_GRID_LINE_SUMS_H
#define OPMS_GRID_LINE_SUMS_H

#include "grid/line_profile.h"
#include "image/view.h"

/** What a row is described by: 1, px across the line, the line, its change with its place, and the
 * grey level. Products of two of them, those first that are asked for with more powers of s. */
enum line_product {
    ONE_SHIFT,
    SHIFT_SHIFT,
    ONE_ONE,
    ACROSS_SHIFT,
    DEPTH_SHIFT,
    ONE_ACROSS,
    ONE_DEPTH,
    ONE_GREY,
    SHIFT_GREY,
    ACROSS_ACROSS,
    ACROSS_DEPTH,
    ACROSS_GREY,
    DEPTH_DEPTH,
    DEPTH_GREY,
    GREY_GREY,
    PRODUCTS
};
#define PRODUCTS_ONCE 9  /* the first ones, also weighted by s, */
#define PRODUCTS_TWICE 5 /* by s^2, */
#define PRODUCTS_THRICE 2 /* and by s^3 */

/** Rows of the picture, or its columns: `u` runs within one, `v` counts them. */
typedef struct raster {
    const view_t *view;
    const line_profile_t *profile; /**< of the line, smeared by the pixels' height, too */
    int columns;
    int u_end, v_end;
    float slope;  /**< px across the line a pixel */
    int row_size; /**< pixels that are read of each */
    float origin; /**< grey levels count from here, so that float sums keep their digits */
} raster_t;

/** Rows that wait to be read together, each in a lane of its own. */
typedef struct row_batch {
    const uint8_t *first[LANES]; /**< pixel */
    lanes_t x;                   /**< px of that across the line */
    lanes_t s;                   /**< px along the line */
    int count;
} row_batch_t;

/** The sums; all zero at first. */
typedef struct line_sums {
    lanes_t plain[PRODUCTS], once[PRODUCTS_ONCE], twice[PRODUCTS_TWICE], thrice[PRODUCTS_THRICE];
    int rows;
} line_sums_t;

/** Add the rows of a batch to the sums, and empty it. */
void add_rows(const raster_t *raster, row_batch_t *batch, line_sums_t *sums);

#endif
