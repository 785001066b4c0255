/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Reading pixels of an opms_image_t: 8 and 16 bit behind one inline accessor.
 *
 * The format test is the same for all pixels of a picture, so it predicts perfectly and costs less
 * than a conversion of the picture would. */
#ifndef OPMS_IMAGE_VIEW_H
#define OPMS_IMAGE_VIEW_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#include <opms/types.h>

typedef struct view {
    const uint8_t *base;
    ptrdiff_t stride;
    int width, height;
    int wide;        /**< 16 bit */
    int white_level; /**< grey level at saturation */
} view_t;

static inline view_t view_of(const opms_image_t *image)
{
    const int wide = image->format == OPMS_PIXEL_GREY16;
    view_t view = {(const uint8_t *)image->pixels, image->stride_bytes, image->width_px,
                   image->height_px, wide, image->white_level};
    if (view.white_level == 0) {
        view.white_level = wide ? 65535 : 255;
    }
    return view;
}

static inline int view_at(const view_t *view, int x, int y)
{
    const uint8_t *row = view->base + (ptrdiff_t)y * view->stride;
    return view->wide ? ((const uint16_t *)(const void *)row)[x] : row[x];
}

static inline int view_holds(const view_t *view, double x, double y, double margin)
{
    return x >= margin && y >= margin && x <= view->width - 1 - margin &&
           y <= view->height - 1 - margin;
}

/** Bilinear grey level; (x, y) must lie in the picture. */
static inline float view_bilinear(const view_t *view, float x, float y)
{
    int x0 = (int)x, y0 = (int)y;
    x0 = x0 > view->width - 2 ? view->width - 2 : x0;
    y0 = y0 > view->height - 2 ? view->height - 2 : y0;
    x0 = x0 < 0 ? 0 : x0;
    y0 = y0 < 0 ? 0 : y0;
    const int x1 = x0 + (x0 + 1 < view->width), y1 = y0 + (y0 + 1 < view->height);
    const float fx = x - (float)x0, fy = y - (float)y0;
    const float top = (float)view_at(view, x0, y0) * (1.f - fx) + (float)view_at(view, x1, y0) * fx;
    const float low = (float)view_at(view, x0, y1) * (1.f - fx) + (float)view_at(view, x1, y1) * fx;
    return top * (1.f - fy) + low * fy;
}

#endif
