/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Bilinear grey levels of places that lie within the picture for certain, at half the cost of
 * view_bilinear(): whole numbers, places to 2^-16 px and weights to 2^-7. That is for looking
 * around; what is measured comes from the pixels themselves. */
#ifndef OPMS_GRID_GREY_INSIDE_H
#define OPMS_GRID_GREY_INSIDE_H

#include "grid/vec2.h"
#include "image/view.h"

#define FIXED_ONE 65536
#define INSIDE_MARGIN_PX 1.0

/** May the place, and what lies between it and another such, be read? */
static inline int is_inside(const view_t *view, vec2_t at)
{
    return view_holds(view, at.x, at.y, INSIDE_MARGIN_PX);
}

/** Grey level at (x, y) / FIXED_ONE. */
static inline float fixed_grey(const view_t *view, int x, int y)
{
    const int fx = (x >> 9) & 127, fy = (y >> 9) & 127;
    const int column = x >> 16, row = y >> 16;
    const int a = view_at(view, column, row);
    const int b = view_at(view, column + 1, row);
    const int c = view_at(view, column, row + 1);
    const int d = view_at(view, column + 1, row + 1);
    const int top = a * (128 - fx) + b * fx, low = c * (128 - fx) + d * fx;
    /* Of 16 bits, 128 times 128 times the level still fits. */
    return (float)(top * (128 - fy) + low * fy) * (1.f / 16384.f);
}

static inline float grey_inside(const view_t *view, vec2_t at)
{
    return fixed_grey(view, (int)(at.x * (float)FIXED_ONE), (int)(at.y * (float)FIXED_ONE));
}

#endif
