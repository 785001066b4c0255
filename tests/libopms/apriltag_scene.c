/* SPDX-License-Identifier: Apache-2.0 */
#include "apriltag_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <apriltag.h>
#include <tag36h11.h>

#include "truth_project.h"

#define SAMPLES 89 /* of a pixel's area: a Fibonacci lattice, along which no edge runs */
#define LATTICE 55
#define TAGS 33
#define CELLS 8 /* of the black border */
#define PITCH_M 0.030
#define SQUARE_M 0.020
#define HALF_WIDTH_M 0.015
#define HALF_LENGTH_M 0.5
#define BLUR_REACH 4

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
        0, TAGS - 1, -1, 0, 40.0, 190.0, 110.0, 0.7, 2.0, 1};
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

/** Fixed-point iteration on the model's own equations. */
static void ray_of_pixel(const opms_lens_t *lens, double u, double v, double ray[2])
{
    const double xd = (u - lens->cx_px) / lens->fx_px, yd = (v - lens->cy_px) / lens->fy_px;
    double x = xd, y = yd;
    for (int i = 0; i < 20; ++i) {
        const double r2 = x * x + y * y;
        const double radial = 1.0 + lens->k1 * r2 + lens->k2 * r2 * r2;
        const double dx = 2.0 * lens->p1 * x * y + lens->p2 * (r2 + 2.0 * x * x);
        const double dy = lens->p1 * (r2 + 2.0 * y * y) + 2.0 * lens->p2 * x * y;
        x = (xd - dx) / radial;
        y = (yd - dy) / radial;
    }
    ray[0] = x;
    ray[1] = y;
}

/** Where the ray of a pixel meets the bar plane; far away where it does not. */
static void bar_point(const apriltag_scene_t *scene, double u, double v, double bar_m[2])
{
    double ray[3] = {0.0, 0.0, 1.0}, far_m[3];
    ray_of_pixel(&scene->lens, u, v, ray);
    truth_apply(&scene->bar_camera, ray, far_m);
    const double *t = scene->bar_camera.t_m;
    const double s = t[2] / (t[2] - far_m[2]);
    bar_m[0] = s > 0.0 ? t[0] + s * (far_m[0] - t[0]) : 1e9;
    bar_m[1] = s > 0.0 ? t[1] + s * (far_m[1] - t[1]) : 1e9;
}

static double printed_level(const print_t *print, const double bar_m[2])
{
    const apriltag_scene_t *scene = print->scene;
    if (fabs(bar_m[0]) > HALF_WIDTH_M || fabs(bar_m[1]) > HALF_LENGTH_M) {
        return scene->ground;
    }
    const int k = (int)floor(bar_m[1] / PITCH_M + 0.5) + TAGS / 2;
    const double cell_m = SQUARE_M / CELLS;
    const int row = (int)floor((bar_m[0] + SQUARE_M / 2) / cell_m);
    const int column =
        (int)floor((bar_m[1] - (k - TAGS / 2) * PITCH_M + SQUARE_M / 2) / cell_m);
    const int inside = row >= 0 && row < CELLS && column >= 0 && column < CELLS &&
                       k >= scene->first && k <= scene->last;
    return inside && print->black[k][row][column] ? scene->black : scene->white;
}

static double pixel_level(const print_t *print, int u, int v)
{
    double centre_m[2], right_m[2], down_m[2], sum = 0.0;
    bar_point(print->scene, u, v, centre_m);
    if (fabs(centre_m[0]) > 1.3 * HALF_WIDTH_M || fabs(centre_m[1]) > 1.1 * HALF_LENGTH_M) {
        return print->scene->ground;
    }
    bar_point(print->scene, u + 1, v, right_m);
    bar_point(print->scene, u, v + 1, down_m);
    for (int i = 0; i < SAMPLES; ++i) {
        const double du = (i + 0.5) / SAMPLES - 0.5;
        const double dv = (i * LATTICE % SAMPLES + 0.5) / SAMPLES - 0.5;
        double bar_m[2];
        for (int k = 0; k < 2; ++k) {
            bar_m[k] = centre_m[k] + du * (right_m[k] - centre_m[k]) +
                       dv * (down_m[k] - centre_m[k]);
        }
        sum += printed_level(print, bar_m);
    }
    return sum / SAMPLES;
}

/** Gaussian blur of `count` levels that lie `step` apart; beyond the ends as at the ends. */
static void blur_line(float *levels, int count, int step, double sigma, float *line)
{
    double weights[2 * BLUR_REACH + 1], total = 0.0;
    for (int i = -BLUR_REACH; i <= BLUR_REACH; ++i) {
        weights[i + BLUR_REACH] = exp(-0.5 * i * i / (sigma * sigma));
        total += weights[i + BLUR_REACH];
    }
    for (int k = 0; k < count; ++k) {
        line[k] = levels[k * step];
    }
    for (int k = 0; k < count; ++k) {
        double sum = 0.0;
        for (int i = -BLUR_REACH; i <= BLUR_REACH; ++i) {
            const int at = k + i < 0 ? 0 : k + i >= count ? count - 1 : k + i;
            sum += weights[i + BLUR_REACH] * line[at];
        }
        levels[k * step] = (float)(sum / total);
    }
}

void apriltag_render(const apriltag_scene_t *scene, uint8_t *pixels)
{
    const int width = scene->lens.width_px, height = scene->lens.height_px;
    print_t print;
    draw_tags(scene, &print);
    float *levels = malloc(sizeof *levels * (size_t)width * (size_t)height);
    float *line = malloc(sizeof *line * (size_t)(width > height ? width : height));
    for (int i = 0; i < width * height; ++i) {
        levels[i] = (float)pixel_level(&print, i % width, i / width);
    }
    for (int v = 0; v < height; ++v) {
        blur_line(levels + v * width, width, 1, scene->blur_px, line);
    }
    for (int u = 0; u < width; ++u) {
        blur_line(levels + u, height, width, scene->blur_px, line);
    }
    uint64_t random = scene->seed;
    for (int i = 0; i < width * height; ++i) {
        const double level = floor(levels[i] + scene->noise * truth_gauss(&random) + 0.5);
        pixels[i] = (uint8_t)(level < 0.0 ? 0.0 : level > 255.0 ? 255.0 : level);
    }
    free(line);
    free(levels);
}
