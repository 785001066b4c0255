/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/correlation.h"

#include <math.h>

#define UNKNOWN 9 /* of the fit that left the residuals: map and common shift */

/* Variance of moving profiles over what the noise makes of it, from simulated pictures: of those
 * that are cut, and of those whose shape is not that of the model any more. The latter moved so far
 * along the bar that squares and cells run into each other, or, cut, across it or both ways. */
#define DOUBT_OF_CUT 1.5f
#define DOUBT_OF_SHAPE 8.f
#define ALONG_MOST_MM 5.5
#define ACROSS_MOST_MM 2.0
#define LENS_BLUR_PX 0.95 /* of a lens in focus, the most */

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

/** How far the picture moved across a family of sides while the shutter was open. */
static double way_mm(const edge_scene_t *scene, int family)
{
    const double blur = scene->blur_px[family], still = scene->still_px;
    return blur > still && scene->blur_scale[family] > 0
               ? sqrt(12 * (blur * blur - still * still)) / scene->blur_scale[family]
               : 0;
}

static float doubt_of_motion(const edge_scene_t *scene)
{
    const int cut = scene->clip < 1;
    const int both = fmin(scene->blur_px[0], scene->blur_px[1]) > LENS_BLUR_PX;
    if (way_mm(scene, 1) > ALONG_MOST_MM ||
        (cut && (both || way_mm(scene, 0) > ACROSS_MOST_MM))) {
        return DOUBT_OF_SHAPE;
    }
    return cut && edge_scene_moved(scene) ? DOUBT_OF_CUT : 1.f;
}

void correlation_state(const edge_scene_t *scene, bar_fit_t *fit)
{
    const float along_side = group_excess(fit, 1), along_bar = group_excess(fit, 4);
    const float excess = doubt_of_motion(scene) * fmaxf(1.f, fmaxf(along_side, along_bar));
    for (int i = 0; i < fit->count; ++i) {
        fit->sigma[i] *= sqrtf(excess);
    }
}
