/* SPDX-License-Identifier: Apache-2.0 */
#include "apriltag_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <apriltag.h>
#include <tag36h11.h>

#include "print_render.h"

#define TAGS 33
#define CELLS 8 /* of the black border */
#define PITCH_M 0.030
#define SQUARE_M 0.020
#define HALF_WIDTH_M 0.015
#define HALF_LENGTH_M 0.5

typedef struct {
    const apriltag_scene_t *scene;
    uint8_t black[TAGS][CELLS][CELLS]; /* row along +X, column along +Y */
} print_t;

apriltag_scene_t apriltag_scene(void)
{
    const double s = sin(0.3), c = cos(0.3);
    const apriltag_scene_t scene = {
        {1024, 768, 900.0, 900.0, 517.3, 379.6, -0.118, 0.031, 0.0011, -0.0007},
        {{-c, 0.0, -s, 0.0, 1.0, 0.0, s, 0.0, -c}, {0.15, 0.02, 0.48}},
        0,
        TAGS - 1,
        -1,
        0,
        40.0,
        190.0,
        110.0,
        0.7,
        2.0,
        1};
    return scene;
}

static void draw_tags(const apriltag_scene_t *scene, print_t *print)
{
    apriltag_family_t *family = tag36h11_create();
    print->scene = scene;
    for (int k = 0; k < TAGS; ++k) {
        const int id = k == scene->wrong_at ? scene->wrong_id : k;
        memset(print->black[k], 1, sizeof print->black[k]);
        for (uint32_t bit = 0; bit < family->nbits; ++bit) {
            if (family->codes[id] >> (family->nbits - bit - 1) & 1) {
                print->black[k][family->bit_y[bit]][family->bit_x[bit]] = 0;
            }
        }
    }
    tag36h11_destroy(family);
}

static double printed_level(const void *tags, const double bar_m[2])
{
    const print_t *print = tags;
    const apriltag_scene_t *scene = print->scene;
    if (fabs(bar_m[0]) > HALF_WIDTH_M || fabs(bar_m[1]) > HALF_LENGTH_M) {
        return scene->ground;
    }
    const int k = (int)floor(bar_m[1] / PITCH_M + 0.5) + TAGS / 2;
    const double cell_m = SQUARE_M / CELLS;
    const int row = (int)floor((bar_m[0] + SQUARE_M / 2) / cell_m);
    const int column = (int)floor((bar_m[1] - (k - TAGS / 2) * PITCH_M + SQUARE_M / 2) / cell_m);
    const int inside = row >= 0 && row < CELLS && column >= 0 && column < CELLS &&
                       k >= scene->first && k <= scene->last;
    return inside && print->black[k][row][column] ? scene->black : scene->white;
}

void apriltag_render(const apriltag_scene_t *scene, uint8_t *pixels)
{
    const size_t count = (size_t)scene->lens.width_px * (size_t)scene->lens.height_px;
    print_t print;
    draw_tags(scene, &print);
    const print_picture_t picture = {scene->lens,
                                     scene->bar_camera,
                                     printed_level,
                                     &print,
                                     {1.3 * HALF_WIDTH_M, 1.1 * HALF_LENGTH_M},
                                     scene->ground,
                                     scene->blur_px,
                                     scene->noise,
                                     scene->seed,
                                     255.0};
    uint16_t *levels = malloc(count * sizeof *levels);
    print_render(&picture, levels);
    for (size_t i = 0; i < count; ++i) {
        pixels[i] = (uint8_t)levels[i];
    }
    free(levels);
}
