/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Pictures of a printed plane for tests: a camera model of the tests' own, area sampling, blur and
 * seeded noise. What is printed is the caller's. */
#ifndef PRINT_RENDER_H
#define PRINT_RENDER_H

#include <opms/types.h>

typedef struct print_picture {
    opms_lens_t lens;
    opms_transform_t bar_camera;
    /** Grey level of a point of the plane. */
    double (*level)(const void *print, const double bar_m[2]);
    const void *print;
    double reach_m[2]; /**< beyond it, in X or in Y, there is nothing but ground */
    double ground;     /**< grey level */
    double blur_px;    /**< Gaussian, without the pixel's own area */
    double noise;      /**< standard deviation */
    uint64_t seed;
    double top; /**< largest grey level; whatever is lighter is saturated */
} print_picture_t;

/** Draw a picture into rows of the lens's width without a gap. */
void print_render(const print_picture_t *picture, uint16_t *pixels);

#endif
