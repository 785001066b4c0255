/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How much the grey levels of a stretch scatter about its model, to weigh it by. */
#ifndef OPMS_BAR_STRETCH_SCATTER_H
#define OPMS_BAR_STRETCH_SCATTER_H

#define SCATTER_SHARED 20.f /**< pixels that what the whole picture says counts for */

/** Variance of a stretch whose residuals have the variance `own`, over so many pixels, in a picture
 * of which most stretches have `shared`.
 *
 * What is known by some dozens of pixels makes weights that vary by themselves. With variances that
 * scatter by v, relative and squared, the weighted mean of many stretches is 1 + v times worse than
 * with the true weights, and the sum of these weights promises 1 - v of what the true ones would
 * (both to first order; v of a variance over n pixels is 2 / n). 1 + 2 v makes up for both. */
static inline float stretch_scatter(float own, float pixels, float shared)
{
    const float all = pixels + SCATTER_SHARED;
    const float v = 2.f * pixels / (all * all);
    return (pixels * own + SCATTER_SHARED * shared) / all * (1.f + 2.f * v);
}

#endif
