/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Pictures of the calibration grid by the tests' own renderer, and the truth of its nodes. */
#ifndef GRID_SCENE_H
#define GRID_SCENE_H

#include <stdlib.h>

#include <unity.h>

#include <opms/grid.h>

#include "../print_render.h"
#include "../truth_project.h"

#define SCENE_WIDTH 640
#define SCENE_HEIGHT 480

/** What lies on the sheet. */
typedef struct sheet {
    int marker;           /**< is it printed? */
    double shadow;        /**< part of the light that is left where Y < X / 2 */
    double slope;         /**< change of the light per metre along X, as a part */
    double hand_m[3];     /**< a dark disc: X, Y, radius; 0: none */
} sheet_t;

static inline double scene_level(const void *print, const double at[2])
{
    const sheet_t *sheet = print;
    const double half = 0.5 * OPMS_GRID_LINE_M, pitch = OPMS_GRID_PITCH_M;
    const double x = at[0] - pitch * round(at[0] / pitch), y = at[1] - pitch * round(at[1] / pitch);
    const int in_x = fabs(at[0]) <= 0.4 + half, in_y = fabs(at[1]) <= 0.55 + half;
    double white = 200.0 * (1.0 + sheet->slope * at[0]);
    if (hypot(at[0] - sheet->hand_m[0], at[1] - sheet->hand_m[1]) < sheet->hand_m[2])
        return 60.0;
    if (at[1] < 0.5 * at[0])
        white *= sheet->shadow;
    if (in_x && in_y && (fabs(x) <= half || fabs(y) <= half))
        return 0.1 * white;
    if (sheet->marker && at[0] > 0.003 && at[0] < 0.009 && at[1] > 0.003 && at[1] < 0.009)
        return 0.1 * white;
    return white;
}

/** A picture and its camera. */
typedef struct grid_scene {
    sheet_t sheet;
    opms_lens_t lens;
    opms_transform_t grid_camera;
    double blur_px, noise;
    uint16_t wide[SCENE_WIDTH * SCENE_HEIGHT];
    uint8_t grey[SCENE_WIDTH * SCENE_HEIGHT];
} grid_scene_t;

/** A camera that looks at (x, y) of the sheet from `distance`, turned by `roll` about its axis and
 * leaning by `tilt` towards `way`. */
static inline void scene_place(grid_scene_t *scene, double x, double y, double distance,
                               double roll, double tilt, double way)
{
    const double down[3] = {3.141592653589793, 0.0, 0.0}, turn[3] = {0.0, 0.0, roll};
    const double lean[3] = {tilt * cos(way), tilt * sin(way), 0.0};
    double a[9], b[9], c[9], d[9];
    truth_rotation(down, a);
    truth_rotation(turn, b);
    truth_rotation(lean, c);
    truth_multiply(a, c, d);
    truth_multiply(d, b, scene->grid_camera.R);
    for (int i = 0; i < 3; ++i)
        scene->grid_camera.t_m[i] =
            (i == 0 ? x : i == 1 ? y : 0.0) - distance * scene->grid_camera.R[3 * i + 2];
}

static inline void scene_usual(grid_scene_t *scene)
{
    const opms_lens_t lens = {SCENE_WIDTH, SCENE_HEIGHT, 420.0, 421.5, 325.3,
                              236.6,       -0.1,         0.02,  0.001, -0.0005};
    const sheet_t sheet = {1, 1.0, 0.0, {0.0, 0.0, 0.0}};
    scene->lens = lens;
    scene->sheet = sheet;
    scene->blur_px = 0.6;
    scene->noise = 2.0;
    scene_place(scene, 0.02, -0.03, 0.45, 0.3, 0.35, 1.0);
}

/** Draw it, 8 bit. */
static inline void scene_draw(grid_scene_t *scene, uint64_t seed)
{
    print_picture_t picture = {0};
    picture.lens = scene->lens;
    picture.bar_camera = scene->grid_camera;
    picture.level = scene_level;
    picture.print = &scene->sheet;
    picture.reach_m[0] = 0.4205;
    picture.reach_m[1] = 0.5945;
    picture.ground = 90.0;
    picture.blur_px = scene->blur_px;
    picture.noise = scene->noise;
    picture.seed = seed;
    picture.top = 255.0;
    print_render(&picture, scene->wide);
    for (int i = 0; i < SCENE_WIDTH * SCENE_HEIGHT; ++i)
        scene->grey[i] = (uint8_t)scene->wide[i];
}

/** Where a node truly is. 0 where it is not in the picture by `margin`. */
static inline int scene_node(const grid_scene_t *scene, const int32_t label[2], double margin,
                             double px[2])
{
    const double at[3] = {0.025 * (label[0] - 50), 0.025 * (label[1] - 50), 0.0};
    if (truth_project(&scene->lens, &scene->grid_camera, at, px) < 0.05)
        return 0;
    return px[0] > margin && px[1] > margin && px[0] < scene->lens.width_px - 1 - margin &&
           px[1] < scene->lens.height_px - 1 - margin;
}

static inline opms_image_t scene_image(const grid_scene_t *scene)
{
    const opms_image_t image = {scene->grey, SCENE_WIDTH, SCENE_HEIGHT, SCENE_WIDTH,
                                OPMS_PIXEL_GREY8, 0};
    return image;
}

#endif
