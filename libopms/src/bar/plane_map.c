/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/plane_map.h"

#include <math.h>
#include <string.h>

#include "algebra/spd.h"
#include "lens/lens_fast.h"

int plane_map_fit(plane_map_t *map, const plane_pair_t *pairs, int count)
{
    double low = 1e30, high = -1e30;
    for (int i = 0; i < count; ++i) {
        low = pairs[i].y_mm < low ? pairs[i].y_mm : low;
        high = pairs[i].y_mm > high ? pairs[i].y_mm : high;
    }
    map->y0_mm = 0.5 * (low + high);
    map->scale_mm = 0.5 * (high - low);
    if (count < 4 || !(map->scale_mm > 0)) {
        return 0;
    }
    double normal[64] = {0}, rhs[8] = {0};
    for (int i = 0; i < count; ++i) {
        const double a = pairs[i].x_mm / PLANE_MAP_X_MM;
        const double b = (pairs[i].y_mm - map->y0_mm) / map->scale_mm;
        for (int axis = 0; axis < 2; ++axis) {
            const double ray = pairs[i].ray[axis];
            double row[8] = {0};
            row[3 * axis] = a;
            row[3 * axis + 1] = b;
            row[3 * axis + 2] = 1;
            row[6] = -ray * a;
            row[7] = -ray * b;
            for (int j = 0; j < 8; ++j) {
                for (int k = 0; k <= j; ++k) {
                    normal[8 * j + k] += row[j] * row[k];
                }
                rhs[j] += row[j] * ray;
            }
        }
    }
    if (!spd_factor(normal, 8, SPD_PIVOT_LEAST)) {
        return 0;
    }
    spd_solve(normal, 8, rhs);
    memcpy(map->h, rhs, sizeof rhs);
    map->h[8] = 1;
    return 1;
}

int plane_map_project(const plane_map_t *map, const opms_lens_t *lens, double ray_limit,
                      double x_mm, double y_mm, double px[2], double *jac)
{
    const double *h = map->h;
    const double a = x_mm / PLANE_MAP_X_MM, b = (y_mm - map->y0_mm) / map->scale_mm;
    const double w = h[6] * a + h[7] * b + h[8];
    if (!(w > 0.02)) {
        return 0;
    }
    const double per_w = 1 / w;
    const double x = (h[0] * a + h[1] * b + h[2]) * per_w;
    const double y = (h[3] * a + h[4] * b + h[5]) * per_w;
    if (!(x * x + y * y < ray_limit * ray_limit)) {
        return 0;
    }
    if (!jac) {
        return lens_project_ray(lens, x, y, &px[0], &px[1]);
    }
    double bend[4];
    lens_project_ray_jac(lens, x, y, &px[0], &px[1], bend);
    const double by_x = per_w * (1 / PLANE_MAP_X_MM), by_y = per_w / map->scale_mm;
    const double x_a = (h[0] - x * h[6]) * by_x, y_a = (h[3] - y * h[6]) * by_x;
    const double x_b = (h[1] - x * h[7]) * by_y, y_b = (h[4] - y * h[7]) * by_y;
    jac[0] = bend[0] * x_a + bend[1] * y_a;
    jac[1] = bend[0] * x_b + bend[1] * y_b;
    jac[2] = bend[2] * x_a + bend[3] * y_a;
    jac[3] = bend[2] * x_b + bend[3] * y_b;
    return 1;
}

void plane_map_relabel(plane_map_t *map, int turn, double shift_mm)
{
    if (turn) {
        for (int row = 0; row < 3; ++row) {
            map->h[3 * row] = -map->h[3 * row];
            map->h[3 * row + 1] = -map->h[3 * row + 1];
        }
        map->y0_mm = -map->y0_mm;
    }
    map->y0_mm += shift_mm;
}

double plane_map_height(const plane_map_t *map)
{
    const double *h = map->h;
    double normal[3], x2 = 0, y2 = 0, depth = 0;
    for (int i = 0; i < 3; ++i) {
        const int j = 3 * ((i + 1) % 3), k = 3 * ((i + 2) % 3);
        normal[i] = h[j] * h[k + 1] - h[k] * h[j + 1];
        x2 += h[3 * i] * h[3 * i];
        y2 += h[3 * i + 1] * h[3 * i + 1];
    }
    for (int i = 0; i < 3; ++i) {
        depth -= normal[i] * h[3 * i + 2];
    }
    /* Either axis has a length per mm; they differ as far as the map is not that of a camera. */
    const double x = sqrt(x2), y = sqrt(y2);
    return depth / (x * y * 0.5 * (x / PLANE_MAP_X_MM + y / map->scale_mm));
}
