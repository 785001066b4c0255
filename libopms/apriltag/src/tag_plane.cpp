/* SPDX-License-Identifier: Apache-2.0 */
#include "tag_plane.h"

#include <opms/bar.h>

namespace opms_tag {

Point tag_corner_m(int k, int i)
{
    const double half = OPMS_BAR_SQUARE_M / 2;
    const double y = (k - OPMS_BAR_ORIGIN) * OPMS_BAR_PITCH_M;
    return {i == 0 || i == 3 ? -half : half, i < 2 ? y - half : y + half};
}

Point Plane::map(Point p) const
{
    const double w = h[6] * p.x + h[7] * p.y + h[8];
    return {(h[0] * p.x + h[1] * p.y + h[2]) / w, (h[3] * p.x + h[4] * p.y + h[5]) / w};
}

bool plane_through(const Point bar_m[4], const Point ray[4], Plane &plane)
{
    /* Bar coordinates about their centre and in units of a square keep the system well scaled. */
    const double scale = 1.0 / OPMS_BAR_SQUARE_M;
    const Point centre = 0.25 * (bar_m[0] + bar_m[1] + bar_m[2] + bar_m[3]);
    double A[8][8] = {}, B[8][1];
    for (int i = 0; i < 4; i++) {
        const Point p = scale * (bar_m[i] - centre);
        const double x_row[8] = {p.x, p.y, 1, 0, 0, 0, -ray[i].x * p.x, -ray[i].x * p.y};
        const double y_row[8] = {0, 0, 0, p.x, p.y, 1, -ray[i].y * p.x, -ray[i].y * p.y};
        for (int j = 0; j < 8; j++) {
            A[2 * i][j] = x_row[j];
            A[2 * i + 1][j] = y_row[j];
        }
        B[2 * i][0] = ray[i].x;
        B[2 * i + 1][0] = ray[i].y;
    }
    if (!solve(A, B)) {
        return false;
    }
    const double g[9] = {B[0][0], B[1][0], B[2][0], B[3][0], B[4][0], B[5][0], B[6][0], B[7][0], 1};
    for (int r = 0; r < 3; r++) {
        plane.h[3 * r] = scale * g[3 * r];
        plane.h[3 * r + 1] = scale * g[3 * r + 1];
        plane.h[3 * r + 2] =
            g[3 * r + 2] - scale * (g[3 * r] * centre.x + g[3 * r + 1] * centre.y);
    }
    return true;
}

} // namespace opms_tag
