/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What a blurred line looks like to pixels, out of tables that are kept while they are used. */
#ifndef OPMS_GRID_LINE_PROFILE_H
#define OPMS_GRID_LINE_PROFILE_H

#include <string.h>

#include "algebra/lanes.h"

#define PROFILE_ENTRIES 196 /* a multiple of LANES */
#define WIDTHS_KEPT 32      /* steps: the widths of one picture differ by less than 2.5 times */
#define BLURS_KEPT 8
#define PROFILE_BORDER_PX 0.8f /* from a window's end to the outer border of its last pixel */

/** A line at the border between two pixels. A pixel sees the mean between its borders: the
 * difference of their areas over its width; and moves with the line by that of their levels. */
typedef struct border {
    float area;  /**< integral of the line up to there, px */
    float level; /**< of the line there, 0 to 1 */
} border_t;

/** One line: its width and the blur's standard deviation, rounded to steps of 3 %. The rounding
 * changes the depth that is fitted, never the place: a profile is symmetric. */
typedef struct line_profile {
    int width_step, blur_step;
    float reach;    /**< px from the middle that the table holds */
    float per_px;   /**< entries */
    border_t at[PROFILE_ENTRIES];
} line_profile_t;

/** Profiles by width and blur. All zero at first. */
typedef struct profile_store {
    line_profile_t kept[WIDTHS_KEPT * BLURS_KEPT];
} profile_store_t;

/** The profile of a line; valid until the next call. */
const line_profile_t *profile_of(profile_store_t *store, float width, float blur);

/** Four borders. */
typedef struct border_lanes {
    lanes_t area, level;
} border_lanes_t;

/** The borders at x px from the line's middle, at most `reach`; linear between entries: exact to
 * 5e-4. */
static inline border_lanes_t border_lanes_at(const line_profile_t *profile, lanes_t x)
{
    const lanes_t place = (x + profile->reach) * profile->per_px;
    const lanes_int_t entry = __builtin_convertvector(place, lanes_int_t);
    const lanes_t part = place - __builtin_convertvector(entry, lanes_t);
    lanes_t pair[LANES]; /* (area, level) of an entry and of the next */
    for (int l = 0; l < LANES; ++l) {
        memcpy(&pair[l], &profile->at[entry[l]], sizeof pair[l]);
    }
    const lanes_t area = {pair[0][0], pair[1][0], pair[2][0], pair[3][0]};
    const lanes_t level = {pair[0][1], pair[1][1], pair[2][1], pair[3][1]};
    const lanes_t next_area = {pair[0][2], pair[1][2], pair[2][2], pair[3][2]};
    const lanes_t next_level = {pair[0][3], pair[1][3], pair[2][3], pair[3][3]};
    const border_lanes_t border = {area + part * (next_area - area),
                                   level + part * (next_level - level)};
    return border;
}

#endif
