/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The least squares of one stretch of a side, on raw pixels. */
#ifndef OPMS_BAR_STRETCH_FIT_H
#define OPMS_BAR_STRETCH_FIT_H

#include "bar/edge_fit.h"
#include "bar/edge_profile.h"

#define LINE_PIXELS_MAX 64
#define STRETCH_LINES_MAX 32

/** One line of pixels across a side. */
typedef struct fit_line {
    float s_first, s_step; /**< distance from the expected edge, outward: of the first pixel, and step */
    int count;
    float corner;          /**< part of the side that is there, 1 away from the corners */
    float cells;           /**< part of the code cells beyond the gap that is black here */
    float ground;          /**< distance of the bar's border, px; 0 where it is out of reach */
    float cell_near, cell_far; /**< distance of the black cells' two borders, px */
    float grey[LINE_PIXELS_MAX];
} fit_line_t;

/** Fit black level, contrast and position to a stretch; the geometry in `out` is the caller's.
 *
 * @param clip  The part of the contrast at which white saturates, 1 where it does not; used where the
 *              stretch holds saturated pixels.
 * @return 0 where the stretch has no edge that can be placed. */
int stretch_fit(const fit_line_t *lines, int count, const edge_blur_t *blur, double sigma, double clip,
                int white_level, stretch_t *out);

#endif
