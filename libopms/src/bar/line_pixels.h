/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The pixels of a stretch's lines one behind the other, as columns for the vector unit. */
#ifndef OPMS_BAR_LINE_PIXELS_H
#define OPMS_BAR_LINE_PIXELS_H

#include "bar/stretch_fit.h"

#define PIXELS_MAX 1024 /* of a stretch, a multiple of LANES */

typedef struct line_pixels {
    int count; /**< what fills up the last lanes is 0 and does not count */
    float s_high, along_low, along_high; /**< extremes of the columns */
    float s[PIXELS_MAX], along[PIXELS_MAX], grey[PIXELS_MAX];
} line_pixels_t;

void line_pixels_gather(line_pixels_t *pixels, const fit_line_t *lines, int count);

/** How many are as light as `white` or lighter. */
int line_pixels_saturated(const line_pixels_t *pixels, float white);

#endif
