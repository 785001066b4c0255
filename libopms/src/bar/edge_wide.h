/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The profile of a blurred edge for eight pixels at a time. */
#ifndef OPMS_BAR_EDGE_WIDE_H
#define OPMS_BAR_EDGE_WIDE_H

#include "algebra/normal_wide.h"
#include "bar/edge_blur.h"

/** The normal distribution at both ends of the blur's box, at the middle alone where it has none:
 * one loop, since every other copy of it is a kilobyte. */
typedef struct box_ends {
    wide_t z[2];
    normal_wide_t at[2];
} box_ends_t;

WIDE_INLINE void box_ends_at(const edge_blur_t *blur, wide_t s, box_ends_t *ends)
{
    const int count = blur->box > 0.f ? 2 : 1;
    ends->z[0] = (s - 0.5f * blur->box) * blur->per_gauss;
    ends->z[1] = (s + 0.5f * blur->box) * blur->per_gauss;
    for (int i = 0; i < count; ++i) {
        ends->at[i] = normal_wide(ends->z[i]);
    }
}

/** Profile at s px from the edge; the pulse is per px. */
WIDE_INLINE normal_wide_t edge_wide_blurred(const edge_blur_t *blur, wide_t s)
{
    box_ends_t ends;
    box_ends_at(blur, s, &ends);
    const normal_wide_t a = ends.at[0];
    if (blur->box <= 0.f) {
        const normal_wide_t plain = {a.step, a.pulse * blur->per_gauss};
        return plain;
    }
    /* The box averages the Gaussian step from s - box/2 to s + box/2; the integral of the normal
     * distribution is z step + pulse. */
    const normal_wide_t b = ends.at[1];
    const normal_wide_t p = {((ends.z[1] * b.step + b.pulse) - (ends.z[0] * a.step + a.pulse)) *
                                 (blur->gauss * blur->per_box),
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
