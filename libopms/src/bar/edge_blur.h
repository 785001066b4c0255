/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What blurs an edge: a Gaussian, and uniform motion besides. */
#ifndef OPMS_BAR_EDGE_BLUR_H
#define OPMS_BAR_EDGE_BLUR_H

#include <math.h>

/** A blur across an edge, px: Gaussian, and a box as wide as the picture moved during exposure. */
typedef struct edge_blur {
    float gauss, per_gauss;
    float box, per_box; /**< 0: still */
} edge_blur_t;

/** A Gaussian blur under a box, 0 where there is none. */
static inline edge_blur_t edge_blur_boxed(double gauss, double box)
{
    const edge_blur_t blur = {(float)gauss, (float)(1 / gauss), (float)box,
                              box > 0 ? (float)(1 / box) : 0.f};
    return blur;
}

/** Blur with a total standard deviation `sigma`, of which `still` is not from motion. */
static inline edge_blur_t edge_blur_of(double sigma, double still)
{
    const double box = sigma > 1.15 * still ? sqrt(12.0 * (sigma * sigma - still * still)) : 0;
    return edge_blur_boxed(box > 0 ? still : sigma, box);
}

#endif
