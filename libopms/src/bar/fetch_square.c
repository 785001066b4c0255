/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/fetch_square.h"

#include <math.h>

#include "bar/bar_code.h"

/* A square is some dozens of short pieces of rows, from all over the picture: no machine foresees
 * them, and a measurement would wait for each. While one square is measured the next one comes. */

#define CACHE_LINE 64 /* bytes; where it is another, a little more or less is asked for */
#define MARGIN_PX 4.0

void fetch_square(const edge_scene_t *scene, int square)
{
    const view_t *view = scene->view;
    double px[2], jac[4];
    if (!plane_map_project(&scene->map, scene->lens, scene->ray_limit, 0,
                           BAR_PITCH_MM * (square - OPMS_BAR_ORIGIN), px, jac)) {
        return;
    }
    const double half_u = BAR_HALF_SQUARE_MM * (fabs(jac[0]) + fabs(jac[1])) + MARGIN_PX;
    const double half_v = BAR_HALF_SQUARE_MM * (fabs(jac[2]) + fabs(jac[3])) + MARGIN_PX;
    const int size = view->wide ? 2 : 1;
    const int left = (int)fmax(px[0] - half_u, 0) * size;
    const int right = (int)fmin(px[0] + half_u, view->width - 1) * size;
    const int top = (int)fmax(px[1] - half_v, 0);
    const int bottom = (int)fmin(px[1] + half_v, view->height - 1);
    for (int y = top; left <= right && y <= bottom; ++y) {
        const uint8_t *row = view->base + (ptrdiff_t)y * view->stride;
        for (int x = left; x < right; x += CACHE_LINE) {
            __builtin_prefetch(row + x);
        }
        __builtin_prefetch(row + right);
    }
}
