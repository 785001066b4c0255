/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/picture_shape.h"

#include <math.h>
#include <stddef.h>

#define BLUR_LEAST 0.25
#define SHARED_BLUR 0.12      /* relative difference of the families' blurs that counts as none */
#define CLIP_LEAST 0.15
#define CLIP_OF_STILL 0.58
#define MOTION_RATIO 1.3
#define BLUR_MOST 4.0

/** Take over the blur that the profiles ask for. Both families share one, the lens's, unless they
 * differ for certain: then the picture moved. */
void shape_update_blur(edge_scene_t *scene, const bar_fit_t *fit)
{
    double slope[2] = {0, 0}, weight[2] = {0, 0}, scale[2] = {0, 0}, blur[2];
    for (int i = 0; i < fit->count; ++i) {
        const stretch_t *s = &fit->stretch[i];
        if (fit->good[i]) {
            const int family = s->side & 1;
            slope[family] += (double)s->blur_slope;
            weight[family] += (double)s->blur_weight;
            scale[family] += (double)(s->blur_weight * s->px_per_mm);
        }
    }
    if (!(weight[0] > 0 && weight[1] > 0)) {
        return;
    }
    for (int family = 0; family < 2; ++family) {
        blur[family] =
            scene->blur_px[family] + fmax(-0.4, fmin(0.6, slope[family] / weight[family]));
        scene->blur_scale[family] = scale[family] / weight[family];
    }
    const double mean = (weight[0] * blur[0] + weight[1] * blur[1]) / (weight[0] + weight[1]);
    const double sigma = (double)fit->noise * sqrt(1 / weight[0] + 1 / weight[1]);
    const int shared =
        scene->still || fabs(blur[0] - blur[1]) < fmax(SHARED_BLUR * mean, 4 * sigma);
    for (int family = 0; family < 2; ++family) {
        scene->blur_px[family] = fmin(BLUR_MOST, fmax(BLUR_LEAST, shared ? mean : blur[family]));
    }
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

/** By how many true blurs a Gaussian step that is cut at `clip` seems shifted into the light. */
static double shift_of_clip(double clip)
{
    /* A fit to the least-squares shift of a plain step fitted to a cut one, 0.2 to 1. */
    const double open = 1 - clip;
    return open * (1.1543 + open * (1.1761 + open * (-2.3947 + open * 2.0922)));
}

/** The clip at which a Gaussian step seems shifted by that much; the inverse of shift_of_clip(). */
static double clip_of_shift(double shift)
{
    double low = CLIP_LEAST, high = 1;
    for (int i = 0; i < 20; ++i) {
        const double middle = 0.5 * (low + high);
        if (shift_of_clip(middle) > shift) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return 0.5 * (low + high);
}

/** First guess of the clip from a fit without it: a profile that is cut seems shifted into the
 * light and narrower. The table is that fit to a cut Gaussian step. */
void shape_guess_clip(edge_scene_t *scene)
{
    static const struct {
        double shift, clip, narrowing; /* shift in apparent blurs; apparent blur over true blur */
    } table[] = {{0, 1, 1},           {0.142, 0.9, 0.864}, {0.348, 0.8, 0.758},
                 {0.598, 0.7, 0.677}, {0.902, 0.6, 0.609}, {1.279, 0.5, 0.549},
                 {1.760, 0.4, 0.495}, {2.409, 0.3, 0.442}, {3.382, 0.2, 0.386}};
    const double shift = -scene->shift_px * scene->shift_gain[1] / scene->blur_px[1];
    size_t k = 1;
    while (k + 1 < sizeof table / sizeof table[0] && table[k].shift < shift) {
        ++k;
    }
    double part = (shift - table[k - 1].shift) / (table[k].shift - table[k - 1].shift);
    part = fmin(1, fmax(0.05, part));
    scene->clip = table[k - 1].clip + part * (table[k].clip - table[k - 1].clip);
    const double narrowing =
        table[k - 1].narrowing + part * (table[k].narrowing - table[k - 1].narrowing);
    for (int family = 0; family < 2; ++family) {
        scene->blur_px[family] = fmin(BLUR_MOST, scene->blur_px[family] / narrowing);
    }
    scene->shift_px = 0;
}

/** Where little is left of the profiles and all sides are cut alike, since the picture is still,
 * the common shift does better than a model of the part that is missing: go back to it. */
int shape_drop_clip(edge_scene_t *scene)
{
    const double ratio = scene->blur_px[0] / scene->blur_px[1];
    if (scene->clip >= CLIP_OF_STILL || ratio > MOTION_RATIO || ratio < 1 / MOTION_RATIO) {
        return 0;
    }
    scene->shift_px = -scene->blur_px[1] * shift_of_clip(scene->clip);
    scene->blur_px[0] = scene->blur_px[1] = 0.55 * scene->blur_px[1];
    scene->still = 1;
    scene->clip = 1;
    return 1;
}

/** Choose the clip that leaves no common shift: the shift of the sides along X is certain, because
 * the pitch of the squares is known, and what saturation does not explain of it (print, exposure)
 * is small. */
void shape_update_clip(edge_scene_t *scene)
{
    const double shift =
        shift_of_clip(scene->clip) - scene->shift_px * scene->shift_gain[1] / scene->blur_px[1];
    const double clip = clip_of_shift(fmax(0, shift));
    scene->clip += fmax(-0.15, fmin(0.15, clip - scene->clip));
    scene->clip = fmin(0.995, fmax(CLIP_LEAST, scene->clip));
    scene->shift_px = 0;
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
