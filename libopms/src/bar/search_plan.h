/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * In which order the lines of a picture are searched. */
#ifndef OPMS_BAR_SEARCH_PLAN_H
#define OPMS_BAR_SEARCH_PLAN_H

#include "bar/line_search.h"

/** A walk through rows and columns that starts coarse and ends with a line every `pitch` px, so
 * that whatever is `pitch` px wide is crossed in both directions, and a bar that lies anywhere is
 * met after a few lines. */
#define SEARCH_LEVELS 5 /**< from the coarsest lines to all */

typedef struct search_plan {
    int width, height, pitch;
    int level, next, upright;
} search_plan_t;

void search_plan_init(search_plan_t *plan, int width, int height, int pitch);

/** The next line; 0 when all have been given. */
int search_plan_next(search_plan_t *plan, search_line_t *line);

#endif
