/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/picture_shape.h"

#include <math.h>

#define BLUR_LEAST 0.25
#define SHARED_BLUR 0.12      /* relative difference of the families' blurs that counts as none */
#define BLUR_MOST 4.0

void shape_scale(edge_scene_t *scene, const bar_fit_t *fit)
{
    double weight[2] = {0, 0}, scale[2] = {0, 0};
    for (int i = 0; i < fit->count; ++i) {
        const stretch_t *s = &fit->stretch[i];
        if (fit->good[i]) {
            weight[s->side & 1] += (double)s->blur_weight;
            scale[s->side & 1] += (double)(s->blur_weight * s->px_per_mm);
        }
    }
    for (int family = 0; family < 2; ++family) {
        if (weight[family] > 0) {
            scene->blur_scale[family] = scale[family] / weight[family];
        }
    }
}

/** Take over the blur that the profiles ask for. Both families share one, the lens's, unless they
 * differ for certain: then the picture moved. */
void shape_update_blur(edge_scene_t *scene, const bar_fit_t *fit)
{
    double slope[2] = {0, 0}, weight[2] = {0, 0}, blur[2];
    for (int i = 0; i < fit->count; ++i) {
        const stretch_t *s = &fit->stretch[i];
        if (fit->good[i]) {
            const int family = s->side & 1;
            slope[family] += (double)s->blur_slope;
            weight[family] += (double)s->blur_weight;
        }
    }
    if (!(weight[0] > 0 && weight[1] > 0)) {
        return;
    }
    for (int family = 0; family < 2; ++family) {
        blur[family] =
            scene->blur_px[family] + fmax(-0.4, fmin(0.6, slope[family] / weight[family]));
    }
    shape_scale(scene, fit);
    const double mean = (weight[0] * blur[0] + weight[1] * blur[1]) / (weight[0] + weight[1]);
    const double sigma = (double)fit->noise * sqrt(1 / weight[0] + 1 / weight[1]);
    /* Families that were told apart stay so at half the difference: no two passes take turns. */
    const double known = fabs(scene->blur_px[0] - scene->blur_px[1]) > 0 ? 0.5 : 1;
    const int shared =
        scene->still || fabs(blur[0] - blur[1]) < fmax(known * SHARED_BLUR * mean, 4 * sigma);
    for (int family = 0; family < 2; ++family) {
        scene->blur_px[family] = fmin(BLUR_MOST, fmax(BLUR_LEAST, shared ? mean : blur[family]));
    }
    scene->still_px = fmin(scene->blur_px[0], scene->blur_px[1]);
}

double shape_saturated_part(const bar_fit_t *fit)
{
    double pixels = 0, saturated = 0;
    for (int i = 0; i < fit->count; ++i) {
        if (fit->good[i]) {
            pixels += fit->stretch[i].pixels;
            saturated += fit->stretch[i].saturated;
        }
    }
    return pixels > 0 ? saturated / pixels : 0;
}

/** What the clip leaves of a shift goes with the blur: motion blurs two of the four sides more than
 * the others. Without saturation all sides shift alike (print, exposure). */
void shape_update_gain(edge_scene_t *scene, const bar_fit_t *fit)
{
    const double part = fmin(1, shape_saturated_part(fit) / 0.05);
    const double mean = 0.5 * (scene->blur_px[0] + scene->blur_px[1]);
    for (int family = 0; family < 2; ++family) {
        scene->shift_gain[family] = 1 + part * (scene->blur_px[family] / mean - 1);
    }
}
