/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Gradients of the plane's map for four points at a time. */
#ifndef OPMS_BAR_PLANE_MAP_WIDE_H
#define OPMS_BAR_PLANE_MAP_WIDE_H

#include "bar/plane_map.h"
#include "lens/lens_wide.h"

/** d(n.(u, v))/d(h0..h7) at points of the plane that the map has in front of the camera, with
 * n = (nu, nv). */
WIDE_INLINE void plane_map_rows(const plane_map_t *map, const opms_lens_t *lens,
                                wide_double_t x_mm, wide_double_t y_mm, wide_double_t nu,
                                wide_double_t nv, wide_double_t row[8])
{
    const double *h = map->h;
    const wide_double_t a = x_mm * (1 / PLANE_MAP_X_MM);
    const wide_double_t b = (y_mm - map->y0_mm) * (1 / map->scale_mm);
    const wide_double_t per_w = 1.0 / (h[6] * a + h[7] * b + h[8]);
    const wide_double_t x = (h[0] * a + h[1] * b + h[2]) * per_w;
    const wide_double_t y = (h[3] * a + h[4] * b + h[5]) * per_w;
    const lens_wide_line_t line = lens_line_wide(lens, x, y, nu, nv);
    const wide_double_t p[3] = {a * per_w, b * per_w, per_w};
    const wide_double_t along = -(line.mx * x + line.my * y);
    for (int k = 0; k < 3; ++k) {
        row[k] = line.mx * p[k];
        row[3 + k] = line.my * p[k];
    }
    row[6] = along * p[0];
    row[7] = along * p[1];
}

#endif
