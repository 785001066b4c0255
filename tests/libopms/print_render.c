/* SPDX-License-Identifier: Apache-2.0 */
#include "print_render.h"

#include <math.h>

#include "truth_project.h"

/* A pixel is the mean of samples about its middle, as dense as the blur and the pixel's own area
 * together. They are a Fibonacci lattice, along which no edge runs. To blur the pixels afterwards
 * would be no blur of a lens: its profile has corners. */
#define SAMPLES 233
#define LATTICE 144

typedef struct lattice {
    double u[SAMPLES], v[SAMPLES]; /* from the pixel's middle */
} lattice_t;

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

/** Where the ray of a pixel meets the printed plane; far away where it does not. */
static void bar_point(const print_picture_t *picture, double u, double v, double bar_m[2])
{
    double ray[3] = {0.0, 0.0, 1.0}, far_m[3];
    ray_of_pixel(&picture->lens, u, v, ray);
    truth_apply(&picture->bar_camera, ray, far_m);
    const double *t = picture->bar_camera.t_m;
    const double s = t[2] / (t[2] - far_m[2]);
    bar_m[0] = s > 0.0 ? t[0] + s * (far_m[0] - t[0]) : 1e9;
    bar_m[1] = s > 0.0 ? t[1] + s * (far_m[1] - t[1]) : 1e9;
}

/** Integral of the Gaussian's distribution up to s. */
static double ramp(double s, double sigma)
{
    const double z = s / sigma;
    return 0.5 * s * erfc(-z * sqrt(0.5)) + sigma * 0.3989422804014327 * exp(-0.5 * z * z);
}

/** Offset below which lies a given part of a pixel's light from one side. */
static double quantile(double part, double sigma)
{
    double low = -0.5 - 8.0 * sigma, high = -low;
    for (int i = 0; i < 50; ++i) {
        const double middle = 0.5 * (low + high);
        if (ramp(middle + 0.5, sigma) - ramp(middle - 0.5, sigma) < part) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

static lattice_t lattice_of(double sigma)
{
    lattice_t lattice;
    for (int i = 0; i < SAMPLES; ++i) {
        lattice.u[i] = quantile((i + 0.5) / SAMPLES, sigma);
        lattice.v[i] = quantile((i * LATTICE % SAMPLES + 0.5) / SAMPLES, sigma);
    }
    return lattice;
}

static double pixel_level(const print_picture_t *picture, const lattice_t *lattice, int u, int v)
{
    double centre_m[2], right_m[2], down_m[2], sum = 0.0;
    bar_point(picture, u, v, centre_m);
    if (fabs(centre_m[0]) > picture->reach_m[0] || fabs(centre_m[1]) > picture->reach_m[1]) {
        return picture->ground;
    }
    bar_point(picture, u + 1, v, right_m);
    bar_point(picture, u, v + 1, down_m);
    for (int i = 0; i < SAMPLES; ++i) {
        double bar_m[2];
        for (int k = 0; k < 2; ++k) {
            bar_m[k] = centre_m[k] + lattice->u[i] * (right_m[k] - centre_m[k]) +
                       lattice->v[i] * (down_m[k] - centre_m[k]);
        }
        sum += picture->level(picture->print, bar_m);
    }
    return sum / SAMPLES;
}

void print_render(const print_picture_t *picture, uint16_t *pixels)
{
    const int width = picture->lens.width_px, height = picture->lens.height_px;
    const lattice_t lattice = lattice_of(picture->blur_px);
    uint64_t random = picture->seed;
    for (int i = 0; i < width * height; ++i) {
        const double mean = pixel_level(picture, &lattice, i % width, i / width);
        const double level = floor(mean + picture->noise * truth_gauss(&random) + 0.5);
        pixels[i] = (uint16_t)(level < 0.0 ? 0.0 : level > picture->top ? picture->top : level);
    }
}
