/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The profile of a blurred edge for eight pixels at a time. */
#ifndef OPMS_BAR_EDGE_WIDE_H
#define OPMS_BAR_EDGE_WIDE_H

#include "algebra/normal_wide.h"
#include "bar/edge_blur.h"

/** Profile at s px from the edge; the pulse is per px. */
WIDE_INLINE normal_wide_t edge_wide_blurred(const edge_blur_t *blur, wide_t s)
{
    if (blur->box <= 0.f) {
        normal_wide_t p = normal_wide(s * blur->per_gauss);
        p.pulse *= blur->per_gauss;
        return p;
    }
    /* The box averages the Gaussian step from s - box/2 to s + box/2; the integral of the normal
     * distribution is z step + pulse. */
    const wide_t high = (s + 0.5f * blur->box) * blur->per_gauss;
    const wide_t low = (s - 0.5f * blur->box) * blur->per_gauss;
    const normal_wide_t a = normal_wide(low), b = normal_wide(high);
    const normal_wide_t p = {
        ((high * b.step + b.pulse) - (low * a.step + a.pulse)) * (blur->gauss * blur->per_box),
        (b.step - a.step) * blur->per_box};
    return p;
}

/** What a corner off the right angle covers besides the product of its two profiles: their joint
 * normal distribution is a series in the correlation. a and b are distances from the sides in
 * standard deviations, inside the corner positive. */
WIDE_INLINE wide_t corner_excess(wide_t lean, wide_t a, wide_t density_a, wide_t b,
                                    wide_t density_b)
{
    const wide_t ab = a * b, aa = a * a - 1.f, bb = b * b - 1.f;
    return lean * density_a * density_b *
           (1.f + lean * (0.5f * ab + lean * (aa * bb * (1.f / 6) +
                                              lean * ab * (aa - 2.f) * (bb - 2.f) * (1.f / 24))));
}

#endif
