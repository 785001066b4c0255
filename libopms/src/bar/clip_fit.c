/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/clip_fit.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "algebra/spd.h"

/* Where white is cut at a part of its true height, what is left of a profile is its foot. How far
 * before the edge the foot lies depends on the blur, which differs between the two families of
 * sides in a picture that moved, and on the height of what was cut off. Neither is seen in one
 * profile: a foot looks like another foot of more blur and more height. But the pitch of the
 * squares tells where the sides along X must lie, and both families share the height. So all is
 * solved for together, by Gauss and Newton. */

#define CLIP_LEAST 0.12
#define CLIP_STEP 0.4    /* of the logarithm */
#define BLUR_LEAST 0.25
#define BLUR_MOST 4.0
#define BLUR_STEP 0.5
#define SHIFT_SIGMA_PX 0.01
#define BLUR_TIE_PX 0.002
#define DOUBT 10 /* in the profiles' shape: variance over what the noise alone makes of it */
#define SHARP_PX 0.9
#define CROSS_SIGMA_PX2 0.5

/** What a step under a Gaussian seems to be when it is cut: its shift into the light in apparent
 * blurs, and its apparent blur over the true one. From least-squares fits of plain steps. */
typedef struct cut_step {
    double clip, shift, narrowing;
} cut_step_t;

static const cut_step_t cut_steps[] = {
    {1, 0, 1},           {0.9, 0.142, 0.864}, {0.8, 0.348, 0.758},
    {0.7, 0.598, 0.677}, {0.6, 0.902, 0.609}, {0.5, 1.279, 0.549},
    {0.4, 1.760, 0.495}, {0.3, 2.409, 0.442}, {0.2, 3.382, 0.386}};

#define CUT_STEPS (sizeof cut_steps / sizeof cut_steps[0])

/** The sides along X as a Gaussian step, which their shift tells the clip of. */
static void start_with_gaussian(edge_scene_t *scene, double shift_px)
{
    const double shift = shift_px / scene->blur_px[1];
    size_t k = 1;
    while (k + 1 < CUT_STEPS && cut_steps[k].shift < shift) {
        ++k;
    }
    const cut_step_t *a = &cut_steps[k - 1], *b = &cut_steps[k];
    const double part = fmin(1, fmax(0.05, (shift - a->shift) / (b->shift - a->shift)));
    const double narrowing = a->narrowing + part * (b->narrowing - a->narrowing);
    scene->clip = a->clip + part * (b->clip - a->clip);
    for (int family = 0; family < 2; ++family) {
        scene->blur_px[family] = fmin(BLUR_MOST, scene->blur_px[family] / narrowing);
    }
}

/** The sides along X as a ramp, whose shift tells how long it is, and the others as a Gaussian. */
static void start_with_ramp(edge_scene_t *scene, double shift_px, const cut_step_t *cut)
{
    const double ramp = 2 * shift_px / (1 - cut->clip);
    const double still = fmin(BLUR_MOST, scene->blur_px[0] / cut->narrowing);
    scene->clip = cut->clip;
    scene->blur_px[0] = still;
    scene->blur_px[1] = fmin(BLUR_MOST, sqrt(still * still + ramp * ramp / 12));
}

/** What part of the lesser blur is not from motion, and how far that can be told beforehand. */
typedef struct still_belief {
    double part, sigma, least;
} still_belief_t;

static still_belief_t still_belief(double lesser_px)
{
    /* A lens that is in focus blurs by 0.5 to 0.8 px, the pixels included. */
    static const still_belief_t sharp = {0.95, 0.06, 0.7}, blurred = {0.75, 0.2, 0.35};
    return lesser_px < SHARP_PX ? sharp : blurred;
}

int clip_start(edge_scene_t *scene, int start)
{
    const double shift_px = -scene->shift_px * scene->shift_gain[1];
    if (start == 0) {
        start_with_gaussian(scene, shift_px);
    } else if (shift_px > 0.3) {
        start_with_ramp(scene, shift_px, &cut_steps[start == 1 ? 7 : 5]);
    } else {
        return 0;
    }
    const double least = fmin(scene->blur_px[0], scene->blur_px[1]);
    scene->still_px = edge_scene_moved(scene) ? still_belief(least).part * least : least;
    scene->shift_gain[0] = scene->shift_gain[1] = 1;
    scene->shift_px = 0;
    return 1;
}

void clip_row(const clip_info_t *clip, float row[CLIP_UNKNOWNS])
{
    row[CLIP_SHIFT] = 1;
    for (int a = 0; a < CLIP_SHAPE; ++a) {
        row[CLIP_FIRST + a] = -clip->by[a];
    }
}

void clip_know(const edge_scene_t *scene, const bar_fit_t *fit, double *normal, double *rhs, int n)
{
    double m[CLIP_UNKNOWNS][CLIP_UNKNOWNS] = {{0}}, r[CLIP_UNKNOWNS] = {0};
    for (int i = 0; i < fit->count; ++i) {
        if (!fit->good[i]) {
            continue;
        }
        const stretch_t *s = &fit->stretch[i];
        const double noise = (double)(fit->sigma[i] / s->sigma_unit);
        const double w = 1 / (noise * noise * DOUBT);
        for (int a = 0; a < CLIP_SHAPE; ++a) {
            r[CLIP_FIRST + a] += w * (double)fit->clip[i].slope[a];
            for (int b = 0; b <= a; ++b) {
                m[CLIP_FIRST + a][CLIP_FIRST + b] += w * (double)fit->clip[i].weight[a][b];
            }
        }
    }
    m[CLIP_SHIFT][CLIP_SHIFT] += 1 / (SHIFT_SIGMA_PX * SHIFT_SIGMA_PX);
    if (!edge_scene_moved(scene)) {
        const int blur = CLIP_FIRST + CLIP_BLUR;
        const double tie = 1 / (BLUR_TIE_PX * BLUR_TIE_PX);
        const double apart = scene->blur_px[1] - scene->blur_px[0];
        m[blur][blur] += tie;
        m[blur + 1][blur + 1] += tie;
        m[blur + 1][blur] -= tie;
        r[blur] += tie * apart;
        r[blur + 1] -= tie * apart;
    }
    /* Motion is seldom along the bar alone: a little of it is in the smaller blur, too. */
    const int less = scene->blur_px[1] < scene->blur_px[0];
    const int still = CLIP_FIRST + CLIP_STILL, blur = CLIP_FIRST + CLIP_BLUR + less;
    const double least = scene->blur_px[less];
    const still_belief_t belief = still_belief(least);
    const double sure = 1 / (belief.sigma * belief.sigma * least * least);
    const double above = scene->still_px - belief.part * least;
    m[still][still] += sure;
    m[blur][blur] += sure * belief.part * belief.part;
    m[still][blur] -= sure * belief.part;
    r[still] -= sure * above;
    r[blur] += sure * belief.part * above;
    const int cross = CLIP_FIRST + CLIP_CROSS;
    m[cross][cross] += 1 / (CROSS_SIGMA_PX2 * CROSS_SIGMA_PX2);
    r[cross] -= scene->cross_px2 / (CROSS_SIGMA_PX2 * CROSS_SIGMA_PX2);
    const int first = n - CLIP_UNKNOWNS;
    for (int a = 0; a < CLIP_UNKNOWNS; ++a) {
        rhs[first + a] += r[a];
        for (int b = 0; b <= a; ++b) {
            normal[(first + a) * n + first + b] += m[a][b];
        }
    }
}

void clip_take(edge_scene_t *scene, const double change[CLIP_UNKNOWNS])
{
    const double step = fmax(-CLIP_STEP, fmin(CLIP_STEP, change[CLIP_FIRST + CLIP_LOG]));
    scene->clip = fmin(0.995, fmax(CLIP_LEAST, scene->clip * exp(step)));
    scene->shift_px = change[CLIP_SHIFT];
    const double change_still = change[CLIP_FIRST + CLIP_STILL];
    scene->still_px += fmax(-BLUR_STEP, fmin(BLUR_STEP, change_still));
    scene->cross_px2 += change[CLIP_FIRST + CLIP_CROSS];
    for (int family = 0; family < 2; ++family) {
        const double wider =
            fmax(-BLUR_STEP, fmin(BLUR_STEP, change[CLIP_FIRST + CLIP_BLUR + family]));
        scene->blur_px[family] =
            fmin(BLUR_MOST, fmax(BLUR_LEAST, scene->blur_px[family] + wider));
    }
    const double least = fmin(scene->blur_px[0], scene->blur_px[1]);
    const double lowest = edge_scene_moved(scene) ? still_belief(least).least * least : least;
    scene->still_px = fmin(least, fmax(lowest, scene->still_px));
}

int clip_at_bound(const edge_scene_t *scene)
{
    return scene->clip <= CLIP_LEAST;
}

/** Mean gradient of the offsets of either family by the unknowns, and their weight. */
static void mean_rows(const bar_fit_t *fit, double row[2][CLIP_UNKNOWNS], double weight[2])
{
    memset(row, 0, 2 * sizeof row[0]);
    weight[0] = weight[1] = 0;
    for (int i = 0; i < fit->count; ++i) {
        if (fit->good[i]) {
            const int family = fit->stretch[i].side & 1;
            const double w = 1 / (double)(fit->sigma[i] * fit->sigma[i]);
            weight[family] += w;
            float own[CLIP_UNKNOWNS];
            clip_row(&fit->clip[i], own);
            for (int a = 0; a < CLIP_UNKNOWNS; ++a) {
                row[family][a] += w * (double)own[a];
            }
        }
    }
    for (int family = 0; family < 2; ++family) {
        for (int a = 0; a < CLIP_UNKNOWNS && weight[family] > 0; ++a) {
            row[family][a] /= weight[family];
        }
    }
}

void clip_gains(const edge_scene_t *scene, bar_fit_t *fit)
{
    double known[CLIP_UNKNOWNS * CLIP_UNKNOWNS] = {0}, unused[CLIP_UNKNOWNS] = {0};
    double row[2][CLIP_UNKNOWNS], weight[2], spread[2][2];
    clip_know(scene, fit, known, unused, CLIP_UNKNOWNS);
    for (int a = 0; a < CLIP_UNKNOWNS; ++a) {
        known[a * CLIP_UNKNOWNS + a] += 1e-6 * (1 + known[a * CLIP_UNKNOWNS + a]);
    }
    mean_rows(fit, row, weight);
    if (!spd_factor(known, CLIP_UNKNOWNS, SPD_PIVOT_LEAST) || !(weight[0] > 0 && weight[1] > 0)) {
        return;
    }
    /* Covariance of the families' shifts, and its larger eigenvector. */
    for (int f = 0; f < 2; ++f) {
        double solved[CLIP_UNKNOWNS];
        memcpy(solved, row[f], sizeof solved);
        spd_solve(known, CLIP_UNKNOWNS, solved);
        for (int g = 0; g < 2; ++g) {
            spread[f][g] = 0;
            for (int a = 0; a < CLIP_UNKNOWNS; ++a) {
                spread[f][g] += row[g][a] * solved[a];
            }
        }
    }
    const double angle = 0.5 * atan2(2 * spread[0][1], spread[0][0] - spread[1][1]);
    const double gain[2] = {fmax(0, cos(angle)), fmax(0, sin(angle))};
    const double size = sqrt((weight[0] * gain[0] * gain[0] + weight[1] * gain[1] * gain[1]) /
                             (weight[0] + weight[1]));
    for (int i = 0; i < fit->count && size > 0; ++i) {
        fit->shift_gain[i] = (float)(gain[fit->stretch[i].side & 1] / size);
    }
}
