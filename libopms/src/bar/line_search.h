/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Dark runs along single rows and columns of the picture: where a square may be. */
#ifndef OPMS_BAR_LINE_SEARCH_H
#define OPMS_BAR_LINE_SEARCH_H

#include <stdint.h>

#include "image/view.h"

/** A dark run between two lighter ones. */
typedef struct dark_run {
    int middle;  /**< coordinate along the line */
    int length;  /**< px, at half height */
    int black, white; /**< darkest inside, the lighter neighbour's darker one */
} dark_run_t;

/** A row (`upright` 0) or column (1) of the picture, from coordinate `from` to `to`. */
typedef struct search_line {
    int upright, at, from, to;
} search_line_t;

/** Copy a line into a buffer that holds to - from + 1 values. */
void line_load(const view_t *view, const search_line_t *line, uint16_t *values);

/** Next dark run of at least `contrast` on both sides in values[*cursor..count); 0 at the end.
 * `*cursor` starts at 0 and is the caller's to keep. */
int line_next_run(const uint16_t *values, int count, int contrast, int shortest, int longest,
                  int *cursor, dark_run_t *run);

#endif
