/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/correlation.h"

#include <math.h>

#define UNKNOWN 9 /* of the fit that left the residuals: map and common shift */

/* Variance over what the noise makes of it, from simulated pictures: where a picture moved and
 * white is cut; where it moved across the bar by half a square or more, since squares and code
 * cells then run into each other; and where white is cut and the picture is blurred as by no lens
 * in focus but no motion was found. */
#define DOUBT_OF_CUT 1.5f
#define DOUBT_OF_LONG_WAY 4.f
#define DOUBT_OF_BLUR 8.f
#define WAY_LONG_MM 8.0
#define LENS_BLUR_PX 0.95

/** Mean square of the residuals of groups of stretches, in units of what independent errors give:
 * one group for each side of so many neighbouring squares. */
static float group_excess(const bar_fit_t *fit, int squares)
{
    float sum[OPMS_BAR_SQUARES][4] = {{0}}, weight[OPMS_BAR_SQUARES][4] = {{0}};
    for (int i = 0; i < fit->count; ++i) {
        if (fit->good[i]) {
            const stretch_t *s = &fit->stretch[i];
            const float w = 1.f / (fit->sigma[i] * fit->sigma[i]);
            sum[s->square / squares][s->side] += w * fit->residual[i];
            weight[s->square / squares][s->side] += w;
        }
    }
    float total = 0;
    int groups = 0;
    for (int k = 0; k < OPMS_BAR_SQUARES; ++k) {
        for (int side = 0; side < 4; ++side) {
            if (weight[k][side] > 0.f) {
                total += fminf(sum[k][side] * sum[k][side] / weight[k][side], 25.f);
                ++groups;
            }
        }
    }
    if (groups <= UNKNOWN) {
        return 1.f;
    }
    /* Less two standard deviations of what chance does to independent errors. */
    const float freedom = (float)(groups - UNKNOWN);
    return total / freedom - 2.f * sqrtf(2.f / freedom);
}

static float doubt_of_motion(const edge_scene_t *scene)
{
    if (!scene->shaped) {
        return 1.f;
    }
    if (edge_scene_moved(scene)) {
        return fabs(scene->way_mm[0]) > WAY_LONG_MM ? DOUBT_OF_LONG_WAY
               : scene->clip < 1                    ? DOUBT_OF_CUT
                                                    : 1.f;
    }
    return scene->clip < 1 && scene->still_px > LENS_BLUR_PX ? DOUBT_OF_BLUR : 1.f;
}

void correlation_state(const edge_scene_t *scene, bar_fit_t *fit)
{
    const float along_side = group_excess(fit, 1), along_bar = group_excess(fit, 4);
    const float excess = doubt_of_motion(scene) * fmaxf(1.f, fmaxf(along_side, along_bar));
    for (int i = 0; i < fit->count; ++i) {
        fit->sigma[i] *= sqrtf(excess);
    }
}
