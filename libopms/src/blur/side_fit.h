/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Width of one edge between a known black and a known white. */
#ifndef OPMS_BLUR_SIDE_FIT_H
#define OPMS_BLUR_SIDE_FIT_H

#include "image/view.h"

/** A straight side in the picture. */
typedef struct side_line {
    double middle[2];   /**< px */
    double normal[2];   /**< unit, out of the square */
    double half_length; /**< px, of the part to be looked at */
    double inside, outside; /**< px, how far from the side */
    double beyond;      /**< px: only where it is white this far out; 0: everywhere */
} side_line_t;

/** Grey level at a point of the picture. */
double grey_at(const view_t *view, const double px[2]);

/** Fit a Gaussian edge to the pixels about a side.
 * @param black, white  Grey levels on both sides of it.
 * @return Standard deviation of its blur in px, or 0 where the pixels show no such edge. */
double side_fit(const view_t *view, const side_line_t *side, double black, double white);

#endif
