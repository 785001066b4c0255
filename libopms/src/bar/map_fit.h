/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The robust linear fit of one pass: the map, and what is unknown of the picture, to all stretches.
 */
#ifndef OPMS_BAR_MAP_FIT_H
#define OPMS_BAR_MAP_FIT_H

#include "bar/map_refine.h"

#define MAP_FIT_TUKEY 4.685f

/** Outward shift of a stretch's side as the scene has it. */
static inline float map_expected_shift(const edge_scene_t *scene, const stretch_t *s)
{
    return (float)(scene->shift_px * scene->shift_gain[s->side & 1]);
}

/** Fit the good stretches; 0 when singular. Offsets become what they would be with the code cells
 * in their true places, residuals what is left.
 *
 * @param change      In: what is expected; out: what is to be added to the map, then the shift.
 * @param[out] scale  Robust scale of the residuals, in sigmas. */
int map_fit(const edge_scene_t *scene, bar_fit_t *fit, double change[FIT_UNKNOWNS_MOST],
            float *scale);

#endif
