/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/side_way.h"

#include <stddef.h>

#include "bar/bar_code.h"

side_way_t side_way_of(const edge_scene_t *scene, int square, int side)
{
    side_way_t way = {{0, 0}, {0, 0}, {0, 0}};
    if (!scene->shaped || !edge_scene_moved(scene)) {
        return way;
    }
    const double out = side < 2 ? -BAR_HALF_SQUARE_MM : BAR_HALF_SQUARE_MM;
    const double middle = BAR_PITCH_MM * (square - OPMS_BAR_ORIGIN);
    const double height = plane_map_height(&scene->map);
    way.at_mm[0] = side & 1 ? 0 : out;
    way.at_mm[1] = middle + (side & 1 ? out : 0);
    for (int axis = 0; axis < 2; ++axis) {
        way.by_rise[axis] = (way.at_mm[axis] - (axis ? scene->way_at : 0)) / height;
        way.mm[axis] = scene->way_mm[axis] + scene->way_mm[2] * way.by_rise[axis];
    }
    return way;
}

double side_way_sag(const edge_scene_t *scene, const side_way_t *way, const double normal[2])
{
    if (!scene->shaped || !edge_scene_moved(scene)) {
        return 0;
    }
    const double growth = scene->way_mm[2] / plane_map_height(&scene->map);
    double px[3][2];
    for (int i = 0; i < 3; ++i) {
        const double when = 0.5 * (i - 1), part = when / (1 - growth * when);
        if (!plane_map_project(&scene->map, scene->lens, scene->ray_limit,
                               way->at_mm[0] + part * way->mm[0],
                               way->at_mm[1] + part * way->mm[1], px[i], NULL)) {
            return 0;
        }
    }
    /* Over the way the mean of what is of second order is a third of that at its ends. */
    double sag = 0;
    for (int axis = 0; axis < 2; ++axis) {
        sag += normal[axis] * (0.5 * (px[0][axis] + px[2][axis]) - px[1][axis]) / 3;
    }
    return sag;
}
