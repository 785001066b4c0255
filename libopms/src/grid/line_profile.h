/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What a blurred line looks like to pixels, out of tables that are kept while they are used. */
#ifndef OPMS_GRID_LINE_PROFILE_H
#define OPMS_GRID_LINE_PROFILE_H

#define PROFILE_ENTRIES 194
#define PROFILES_KEPT 256

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
    float reach;    /**< px from the middle, beyond which there is nothing */
    float per_px;   /**< entries */
    border_t at[PROFILE_ENTRIES];
} line_profile_t;

/** Profiles by width and blur. All zero at first. */
typedef struct profile_store {
    line_profile_t kept[PROFILES_KEPT];
} profile_store_t;

/** The profile of a line; valid until the next call. */
const line_profile_t *profile_of(profile_store_t *store, float width, float blur);

/** The border at x px from the line's middle, linear between entries: exact to 2e-4. */
static inline border_t border_at(const line_profile_t *profile, float x)
{
    const float reach = profile->reach;
    const float inside = x < -reach ? -reach : x > reach ? reach : x;
    const float place = (inside + reach) * profile->per_px;
    const int i = (int)place;
    const float part = place - (float)i;
    const border_t low = profile->at[i], high = profile->at[i + 1];
    const border_t border = {low.area + part * (high.area - low.area),
                             low.level + part * (high.level - low.level)};
    return border;
}

#endif
