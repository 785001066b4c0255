/* SPDX-License-Identifier: Apache-2.0 */
#include "bar_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "print_render.h"
#include "truth_scene.h"

#define SQUARES BAR_SCENE_SQUARES
#define PITCH_M 0.030
#define HALF_SQUARE_M 0.010
#define HALF_WIDTH_M 0.015
#define HALF_LENGTH_M 0.5
#define CELL_X_M 0.0045
#define CELL_Y_M 0.005

static const int bar_codes_printed[SQUARES] = {57, 8,  46, 36, 61, 19, 56, 62, 50, 1,  35,
                                               28, 38, 10, 37, 58, 2,  6,  13, 54, 23, 22,
                                               53, 24, 33, 47, 55, 44, 14, 3,  17, 49, 5};

opms_transform_t bar_scene_detector(void)
{
    const double w[3] = {0.03, -0.05, 0.04};
    opms_transform_t detector = {{0}, {0.30, 0.02, 0.05}};
    truth_rotation(w, detector.R);
    return detector;
}

bar_scene_t bar_scene(void)
{
    const opms_transform_t detector = bar_scene_detector(), mounting = truth_mounting();
    bar_scene_t scene;
    memset(&scene, 0, sizeof scene);
    scene.lens = truth_lens();
    scene.lens.width_px = BAR_SCENE_WIDTH;
    scene.lens.height_px = BAR_SCENE_HEIGHT;
    scene.lens.cx_px -= 192.0;
    scene.lens.cy_px -= 144.0;
    scene.bar_camera = truth_bar_camera(&detector, &mounting, 0.0);
    memcpy(scene.codes, bar_codes_printed, sizeof scene.codes);
    scene.shown_m[0] = -1.0;
    scene.shown_m[1] = 1.0;
    scene.hidden_m[0] = 2.0;
    scene.hidden_m[1] = 2.0;
    scene.black = 40.0;
    scene.white = 190.0;
    scene.ground = 110.0;
    scene.blur_px = 0.7;
    scene.noise = 2.0;
    scene.seed = 1;
    scene.top = 255.0;
    return scene;
}

void bar_scene_show(bar_scene_t *scene, int first, int last)
{
    scene->shown_m[0] = (first - SQUARES / 2) * PITCH_M - 0.018;
    scene->shown_m[1] = (last - SQUARES / 2) * PITCH_M + 0.018;
}

void bar_scene_roll(bar_scene_t *scene, double angle_rad)
{
    const double w[3] = {0.0, 0.0, angle_rad};
    double turn[9], R[9];
    truth_rotation(w, turn);
    truth_multiply(scene->bar_camera.R, turn, R);
    memcpy(scene->bar_camera.R, R, sizeof R);
}

void bar_scene_corner(const bar_scene_t *scene, int square, int corner, double px[2])
{
    const double bar_m[3] = {
        corner == 0 || corner == 3 ? -HALF_SQUARE_M : HALF_SQUARE_M,
        (square - SQUARES / 2) * PITCH_M + (corner < 2 ? -HALF_SQUARE_M : HALF_SQUARE_M), 0.0};
    truth_project(&scene->lens, &scene->bar_camera, bar_m, px);
}

int bar_scene_sees(const bar_scene_t *scene, int square, double margin_px)
{
    int inside = 1;
    for (int corner = 0; corner < 4; ++corner) {
        double px[2];
        bar_scene_corner(scene, square, corner, px);
        inside = inside && px[0] > margin_px && px[1] > margin_px &&
                 px[0] < scene->lens.width_px - 1 - margin_px &&
                 px[1] < scene->lens.height_px - 1 - margin_px;
    }
    return inside;
}

/** Is there a black cell at (x, y) from the centre of square k? */
static int in_cell(const int codes[SQUARES], int k, double x, double y)
{
    if (k < 0 || k >= SQUARES || fabs(fabs(y) - 0.015) > 0.5 * CELL_Y_M ||
        fabs(x) > 3.0 * CELL_X_M) {
        return 0;
    }
    /* The cells of bits 5 to 0 follow one another along X, the first three after the square. */
    const int place = (int)floor(x / CELL_X_M) + 3;
    return (place < 3) == (y > 0.0) && codes[k] >> (5 - place) & 1;
}

static double printed_level(const void *of_scene, const double bar_m[2])
{
    const bar_scene_t *scene = of_scene;
    const double x = bar_m[0], y = bar_m[1];
    if (fabs(x) > HALF_WIDTH_M || fabs(y) > HALF_LENGTH_M || y < scene->shown_m[0] ||
        y > scene->shown_m[1] || (y > scene->hidden_m[0] && y < scene->hidden_m[1])) {
        return scene->ground;
    }
    const int near = (int)floor(y / PITCH_M + 0.5) + SQUARES / 2;
    const int k = near < 0 ? 0 : near >= SQUARES ? SQUARES - 1 : near;
    const double from_k = y - (k - SQUARES / 2) * PITCH_M;
    if (fabs(x) < HALF_SQUARE_M && fabs(from_k) < HALF_SQUARE_M) {
        return scene->black;
    }
    const int cell = in_cell(scene->codes, k, x, from_k) ||
                     in_cell(scene->codes, k - 1, x, from_k + PITCH_M) ||
                     in_cell(scene->codes, k + 1, x, from_k - PITCH_M);
    return cell ? scene->black : scene->white;
}

void bar_render16(const bar_scene_t *scene, uint16_t *pixels)
{
    const print_picture_t picture = {scene->lens,
                                     scene->bar_camera,
                                     printed_level,
                                     scene,
                                     {1.3 * HALF_WIDTH_M, 1.1 * HALF_LENGTH_M},
                                     scene->ground,
                                     scene->blur_px,
                                     scene->noise,
                                     scene->seed,
                                     scene->top};
    print_render(&picture, pixels);
}

void bar_render8(const bar_scene_t *scene, uint8_t *pixels)
{
    const size_t count = (size_t)scene->lens.width_px * (size_t)scene->lens.height_px;
    uint16_t *levels = malloc(count * sizeof *levels);
    bar_render16(scene, levels);
    for (size_t i = 0; i < count; ++i) {
        pixels[i] = (uint8_t)levels[i];
    }
    free(levels);
}
