/* SPDX-License-Identifier: Apache-2.0 */
#include "expect/bar_in_view.h"

#include <math.h>

#include <opms/lens.h>

#define HALF_M (0.5 * OPMS_BAR_SQUARE_M)
#define MARGIN_PX 3.0 /* an edge is measured across some pixels */
/* Next to the corners two edges' blurs overlap, and nothing is measured there. Two stretches with
 * half of the rest each weigh like all of it where they stand 1/sqrt(3) of it off the middle. */
#define USED_PART 0.8
#define STRETCH_AT (USED_PART * 0.57735026918962576)

typedef struct view {
    const opms_lens_t *lens;
    const opms_transform_t *bar_camera;
} view_t;

/** A vector of the bar's frame in the camera's: R^T v. */
static void turn_to_camera(const opms_transform_t *bar_camera, const double v[3], double turned[3])
{
    const double *R = bar_camera->R;
    for (int i = 0; i < 3; ++i) {
        turned[i] = R[i] * v[0] + R[3 + i] * v[1] + R[6 + i] * v[2];
    }
}

/** Pixel of (X, Y) of the bar, with the gradient by the camera's coordinates; 0 where none is
 * seen. */
static int look(const view_t *view, double X, double Y, double px[2], double jac[6])
{
    const double *t = view->bar_camera->t_m;
    const double from_camera[3] = {X - t[0], Y - t[1], -t[2]};
    double point[3];
    turn_to_camera(view->bar_camera, from_camera, point);
    return opms_lens_project(view->lens, point, px, jac, NULL, NULL) == OPMS_OK;
}

static int in_picture(const opms_lens_t *lens, const double px[2])
{
    return px[0] >= MARGIN_PX && px[1] >= MARGIN_PX && px[0] <= lens->width_px - 1 - MARGIN_PX &&
           px[1] <= lens->height_px - 1 - MARGIN_PX;
}

static double middle_m(int square)
{
    return OPMS_BAR_PITCH_M * (square - OPMS_BAR_ORIGIN);
}

/** Are all four corners in the picture, and no side too short? */
static int square_is_seen(const view_t *view, int square, double min_square_px)
{
    double corners[4][2], jac[6];
    for (int c = 0; c < 4; ++c) {
        const double X = c == 1 || c == 2 ? HALF_M : -HALF_M;
        const double Y = middle_m(square) + (c >= 2 ? HALF_M : -HALF_M);
        if (!look(view, X, Y, corners[c], jac) || !in_picture(view->lens, corners[c])) {
            return 0;
        }
    }
    for (int c = 0; c < 4; ++c) {
        const double *a = corners[c], *b = corners[(c + 1) % 4];
        if (hypot(b[0] - a[0], b[1] - a[1]) < min_square_px) {
            return 0;
        }
    }
    return 1;
}

/** Movement in the picture, px a metre, along one axis of the bar. */
static void along_axis(const view_t *view, const double jac[6], int axis, double moved[2])
{
    const double unit[3] = {axis == 0, axis == 1, 0};
    double turned[3];
    turn_to_camera(view->bar_camera, unit, turned);
    for (int i = 0; i < 2; ++i) {
        moved[i] =
            jac[3 * i] * turned[0] + jac[3 * i + 1] * turned[1] + jac[3 * i + 2] * turned[2];
    }
}

/** One stretch of a side; `part` from -1 to 1 along it. */
static int stretch(const view_t *view, int square, int side, double part, double sigma_sqrt_px,
                   opms_edge_t *edge)
{
    const double outward = side < 2 ? -1.0 : 1.0;
    const int along = side % 2 ? 0 : 1; /* the axis that the side runs along */
    double jac[6], run[2], out[2];
    edge->square = square;
    edge->side = side;
    edge->bar_m[along] = part * HALF_M;
    edge->bar_m[1 - along] = outward * HALF_M;
    edge->bar_m[1] += middle_m(square);
    edge->shift_gain = 1.0;
    if (!look(view, edge->bar_m[0], edge->bar_m[1], edge->px, jac)) {
        return 0;
    }
    along_axis(view, jac, along, run);
    along_axis(view, jac, 1 - along, out);
    const double px_per_m = hypot(run[0], run[1]);
    const double length_px = px_per_m * USED_PART * OPMS_BAR_SQUARE_M / 2.0;
    const double facing = outward * (out[0] * -run[1] + out[1] * run[0]) > 0.0 ? 1.0 : -1.0;
    edge->normal[0] = facing * -run[1] / px_per_m;
    edge->normal[1] = facing * run[0] / px_per_m;
    edge->sigma_px = sigma_sqrt_px / sqrt(length_px);
    return isfinite(edge->sigma_px) && edge->sigma_px > 0.0;
}

uint32_t bar_in_view(const opms_lens_t *lens, const opms_transform_t *bar_camera,
                     bar_in_view_light_t light, opms_edge_t *edges, uint32_t *square_count)
{
    const view_t view = {lens, bar_camera};
    uint32_t count = 0;
    *square_count = 0;
    if (!(bar_camera->t_m[2] > 0.0)) {
        return 0; /* from behind, nothing is printed */
    }
    for (int square = 0; square < OPMS_BAR_SQUARES; ++square) {
        if (!square_is_seen(&view, square, light.min_square_px)) {
            continue;
        }
        ++*square_count;
        for (int i = 0; i < 8; ++i) {
            count += (uint32_t)stretch(&view, square, i % 4, i < 4 ? -STRETCH_AT : STRETCH_AT,
                                       light.sigma_sqrt_px, &edges[count]);
        }
    }
    return count;
}
