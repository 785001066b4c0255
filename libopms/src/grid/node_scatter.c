/* SPDX-License-Identifier: Apache-2.0 */
/* A line fit states what the noise of its pixels does to it. That its model of a line is not quite
 * the camera's it cannot see: the optics' own blur is no Gaussian, a printer's edge is rough, and
 * the error goes from node to node as the line passes over the pixels. But the truth is smooth.
 * Sixth differences of seven nodes in a row are free of any perspective and distortion that there
 * is (below 0.001 px), while independent errors of sigma make them sqrt(924) sigma large. */
#include "grid/node_scatter.h"

#include "algebra/median.h"

#define ORDER 6
#define SAMPLES_MOST 512
#define SAMPLES_LEAST 40  /* fewer say nothing */
#define NORMAL_MEDIAN 0.4549f /* of the square of a unit normal variable */

/* Squared sixth differences along an axis of u and of v, over their variance by the sigmas. */
static int sample(opms_grid_detector_t *d, int k, int axis, float out[2])
{
    static const float weight[ORDER + 1] = {1.f, -6.f, 15.f, -20.f, 15.f, -6.f, 1.f};
    const int i = d->queue[k] % LATTICE, j = d->queue[k] / LATTICE;
    vec2_t sum = {0.f, 0.f};
    float variance = 0.f;
    for (int n = 0; n <= ORDER; ++n) {
        const lattice_node_t *node = node_at(d, i + (axis == 0 ? n : 0), j + (axis == 1 ? n : 0));
        if (!node) {
            return 0;
        }
        sum = vec2_add(sum, node->at, weight[n]);
        variance += weight[n] * weight[n] * node->sigma * node->sigma;
    }
    out[0] = sum.x * sum.x / variance;
    out[1] = sum.y * sum.y / variance;
    return 1;
}

/* Variance of the scatter along an axis over the stated one; 1 where that cannot be told. The
 * median, because a node that is spoilt is no reason to doubt the others. */
static float excess(opms_grid_detector_t *d, int axis)
{
    float values[2 * SAMPLES_MOST];
    int count = 0;
    const int every = d->queue_in / SAMPLES_MOST + 1;
    for (int k = 0; k < d->queue_in; k += every) {
        count += sample(d, k, axis, values + count) ? 2 : 0;
    }
    if (count < 2 * SAMPLES_LEAST) {
        return 1.f;
    }
    return median_of(values, count) / NORMAL_MEDIAN;
}

void hold_sigmas_to_scatter(opms_grid_detector_t *d)
{
    const float along = excess(d, 0), across = excess(d, 1);
    const float factor = sqrtf(fmaxf(1.f, fmaxf(along, across)));
    for (int k = 0; k < d->queue_in; ++k) {
        d->lattice[d->queue[k]].sigma *= factor;
    }
}
