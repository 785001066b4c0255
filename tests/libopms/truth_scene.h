/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Bars in front of cameras, and the edges that a perfect detector would measure. */
#ifndef TRUTH_SCENE_H
#define TRUTH_SCENE_H

#include <opms/bar.h>
#include <opms/types.h>

#include "truth_project.h"

/** The camera of docs/conventions.md's figures, with the distortion of a real lens. */
static inline opms_lens_t truth_lens(void)
{
    const opms_lens_t lens = {1024,  768,    585.0, 585.0,  517.3,
                              379.6, -0.118, 0.031, 0.0011, -0.0007};
    return lens;
}

/** Where that camera sits on the detector: 0.4 m up, 0.1 m ahead, 25 degrees off the vertical. */
static inline opms_transform_t truth_mounting(void)
{
    const double s = sin(25.0 * 0.017453292519943295), c = cos(25.0 * 0.017453292519943295);
    const opms_transform_t mounting = {{-c, 0.0, -s, 0.0, 1.0, 0.0, s, 0.0, -c}, {-0.1, 0.0, 0.4}};
    return mounting;
}

/** Camera to bar from the detector in the ground frame, the bar tilted. */
static inline opms_transform_t truth_bar_camera(const opms_transform_t *ground_detector,
                                                const opms_transform_t *detector_camera,
                                                double tilt_rad)
{
    const double w[3] = {0.0, tilt_rad, 0.0}; /* R_bar_ground = Ry(+tilt) */
    opms_transform_t bar_ground = {{0}, {0}}, ground_camera, bar_camera;
    truth_rotation(w, bar_ground.R);
    truth_multiply(ground_detector->R, detector_camera->R, ground_camera.R);
    truth_apply(ground_detector, detector_camera->t_m, ground_camera.t_m);
    truth_multiply(bar_ground.R, ground_camera.R, bar_camera.R);
    truth_apply(&bar_ground, ground_camera.t_m, bar_camera.t_m);
    return bar_camera;
}

/** A detector somewhere in the working volume, its attitude off by up to `lean_rad` an axis. */
static inline opms_transform_t truth_detector(uint64_t *random, double lean_rad)
{
    opms_transform_t detector;
    double w[3];
    for (int i = 0; i < 3; ++i) {
        w[i] = truth_uniform(random, -lean_rad, lean_rad);
    }
    truth_rotation(w, detector.R);
    detector.t_m[0] = truth_uniform(random, 0.15, 0.55);
    detector.t_m[1] = truth_uniform(random, -0.5, 0.5);
    detector.t_m[2] = truth_uniform(random, 0.0, 0.115);
    return detector;
}

static inline int truth_in_picture(const opms_lens_t *lens, const double px[2])
{
    return px[0] > 3.0 && px[1] > 3.0 && px[0] < lens->width_px - 4.0 &&
           px[1] < lens->height_px - 4.0;
}

/** One side's stretch at parameter s (-1 to 1 along the side): exact point and outward normal. */
static inline int truth_edge(const opms_lens_t *lens, const opms_transform_t *bar_camera,
                             int square, int side, double s, opms_edge_t *edge)
{
    const double half = 0.5 * OPMS_BAR_SQUARE_M;
    const double middle = (square - OPMS_BAR_ORIGIN) * OPMS_BAR_PITCH_M;
    const double sign = side < 2 ? -1.0 : 1.0;
    const double X = side % 2 ? s * half : sign * half;
    const double Y = middle + (side % 2 ? sign * half : s * half);
    const double step = 1e-5;
    const double here[3] = {X, Y, 0.0};
    const double ahead[3] = {X + (side % 2 ? step : 0.0), Y + (side % 2 ? 0.0 : step), 0.0};
    const double back[3] = {X - (side % 2 ? step : 0.0), Y - (side % 2 ? 0.0 : step), 0.0};
    const double out[3] = {X + (side % 2 ? 0.0 : sign * step), Y + (side % 2 ? sign * step : 0.0),
                           0.0};
    double to[2], from[2], outside[2];
    edge->square = square;
    edge->side = side;
    edge->bar_m[0] = X;
    edge->bar_m[1] = Y;
    edge->sigma_px = 0.05;
    edge->shift_gain = 1.0;
    if (truth_project(lens, bar_camera, here, edge->px) < 0.05) {
        return 0;
    }
    truth_project(lens, bar_camera, ahead, to);
    truth_project(lens, bar_camera, back, from);
    truth_project(lens, bar_camera, out, outside);
    const double du = to[0] - from[0], dv = to[1] - from[1];
    const double length = sqrt(du * du + dv * dv);
    const double facing =
        (outside[0] - edge->px[0]) * -dv + (outside[1] - edge->px[1]) * du > 0.0 ? 1.0 : -1.0;
    edge->normal[0] = facing * -dv / length;
    edge->normal[1] = facing * du / length;
    return truth_in_picture(lens, edge->px);
}

/** Exact edges of the squares first to last that are in the picture, `stretches` a side. */
static inline uint32_t truth_edges(const opms_lens_t *lens, const opms_transform_t *bar_camera,
                                   int first, int last, int stretches, opms_edge_t *edges)
{
    uint32_t count = 0;
    for (int square = first; square <= last; ++square) {
        for (int side = 0; side < 4; ++side) {
            for (int i = 0; i < stretches; ++i) {
                const double s = (2.0 * i + 1.0) / stretches - 1.0;
                count +=
                    (uint32_t)truth_edge(lens, bar_camera, square, side, 0.8 * s, &edges[count]);
            }
        }
    }
    return count;
}

/** Move an edge outward. */
static inline void truth_move_edge(opms_edge_t *edge, double outward_px)
{
    edge->px[0] += outward_px * edge->normal[0];
    edge->px[1] += outward_px * edge->normal[1];
}

#endif
