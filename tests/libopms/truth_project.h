/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The camera model once more, written from the paper's equations and not from the library, as a
 * judge of it; with the little algebra and the seeded random numbers that scenes need. */
#ifndef TRUTH_PROJECT_H
#define TRUTH_PROJECT_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include <opms/types.h>

/** p_a = R p_b + t */
static inline void truth_apply(const opms_transform_t *a_b, const double b[3], double a[3])
{
    for (int i = 0; i < 3; ++i) {
        a[i] = a_b->t_m[i];
        for (int j = 0; j < 3; ++j) {
            a[i] += a_b->R[3 * i + j] * b[j];
        }
    }
}

/** p_b = R^T (p_a - t) */
static inline void truth_apply_inverse(const opms_transform_t *a_b, const double a[3], double b[3])
{
    for (int i = 0; i < 3; ++i) {
        b[i] = 0.0;
        for (int j = 0; j < 3; ++j) {
            b[i] += a_b->R[3 * j + i] * (a[j] - a_b->t_m[j]);
        }
    }
}

/** c = a b, 3 x 3 row-major; c may not be a or b. */
static inline void truth_multiply(const double a[9], const double b[9], double c[9])
{
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            c[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
        }
    }
}

/** Rodrigues' formula. */
static inline void truth_rotation(const double w[3], double R[9])
{
    const double angle = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    const double s = angle > 0.0 ? sin(angle) / angle : 1.0;
    const double c = angle > 0.0 ? 2.0 * pow(sin(0.5 * angle) / angle, 2.0) : 0.5;
    const double k[9] = {0.0, -w[2], w[1], w[2], 0.0, -w[0], -w[1], w[0], 0.0};
    double kk[9];
    truth_multiply(k, k, kk);
    for (int i = 0; i < 9; ++i) {
        R[i] = (i % 4 == 0 ? 1.0 : 0.0) + s * k[i] + c * kk[i];
    }
}

/** The small rotation w with b = a Exp(w), to second order. */
static inline void truth_small_rotation(const double a[9], const double b[9], double w[3])
{
    double d[9];
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            d[3 * i + j] = a[i] * b[j] + a[3 + i] * b[3 + j] + a[6 + i] * b[6 + j];
        }
    }
    w[0] = 0.5 * (d[7] - d[5]);
    w[1] = 0.5 * (d[2] - d[6]);
    w[2] = 0.5 * (d[3] - d[1]);
}

/** The intrinsic parameter number k, in the order fx fy cx cy k1 k2 p1 p2. */
static inline double *truth_intrinsic(opms_lens_t *lens, int k)
{
    double *const all[8] = {&lens->fx_px, &lens->fy_px, &lens->cx_px, &lens->cy_px,
                            &lens->k1,    &lens->k2,    &lens->p1,    &lens->p2};
    return all[k];
}

/** Pixel of a point of the camera frame. */
static inline void truth_project_camera(const opms_lens_t *lens, const double p[3], double px[2])
{
    const double x = p[0] / p[2];
    const double y = p[1] / p[2];
    const double r2 = x * x + y * y;
    const double radial = 1.0 + lens->k1 * r2 + lens->k2 * r2 * r2;
    const double xd = x * radial + 2.0 * lens->p1 * x * y + lens->p2 * (r2 + 2.0 * x * x);
    const double yd = y * radial + lens->p1 * (r2 + 2.0 * y * y) + 2.0 * lens->p2 * x * y;
    px[0] = lens->fx_px * xd + lens->cx_px;
    px[1] = lens->fy_px * yd + lens->cy_px;
}

/** Pixel of a bar point; returns its depth. */
static inline double truth_project(const opms_lens_t *lens, const opms_transform_t *bar_camera,
                                   const double bar[3], double px[2])
{
    double p[3];
    truth_apply_inverse(bar_camera, bar, p);
    truth_project_camera(lens, p, px);
    return p[2];
}

/** Seeded random numbers (splitmix64); the same on every machine. */
static inline uint64_t truth_random(uint64_t *state)
{
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/** Uniform between low and high. */
static inline double truth_uniform(uint64_t *state, double low, double high)
{
    return low + (high - low) * ((double)(truth_random(state) >> 11) / 9007199254740992.0);
}

/** Gaussian of variance 1. */
static inline double truth_gauss(uint64_t *state)
{
    const double radius = sqrt(-2.0 * log(1.0 - truth_uniform(state, 0.0, 1.0)));
    return radius * cos(6.283185307179586 * truth_uniform(state, 0.0, 1.0));
}

#endif
