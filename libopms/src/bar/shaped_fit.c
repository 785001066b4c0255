/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/shaped_fit.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "algebra/spd.h"

/* Where white is cut at a part of its true height, what is left of a profile is its foot. How far
 * before the edge the foot lies depends on the blur, on the way that the side moved, and on the
 * height of what was cut off. None is seen in one profile: a foot looks like another foot of more
 * blur and more height. But the pitch of the squares tells where the sides along X must lie, all
 * share the height and the lens's blur, and the ways of all follow from three numbers. So all is
 * solved for together, by Gauss and Newton. */

#define CLIP_MOST 0.995
#define CLIP_STEP 0.4    /* of the logarithm */
#define BLUR_LEAST 0.25
#define BLUR_MOST 4.0
#define BLUR_STEP 0.5
#define SHIFT_SIGMA_PX 0.01
#define WAY_STEP_MM 1.5
#define WAY_MOST_MM 20.0
#define RISE_SIGMA_MM 3.0
#define GROUND_USUAL 0.5   /* by how much ground is darker than print, of the contrast */
#define GROUND_SIGMA 0.3
#define GROUND_LEAST (-0.3)
#define GROUND_MOST 1.2
#define GROUND_STEP 0.2
#define FIXED 1e-6       /* standard deviation of what is not solved for */
#define DOUBT 10         /* in the profiles' shape: variance over what the noise makes of it */
#define CLIP_HALF 0.5    /* the less is left of white, the more an error of its shape does */
#define STILL_START 0.8  /* lenses in focus blur by less, and what blurs more may be motion */
#define SHARP_PX 0.9

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
    double part, sigma;
} still_belief_t;

static still_belief_t still_belief(double lesser_px)
{
    /* A lens that is in focus blurs by 0.5 to 0.8 px, the pixels included. */
    static const still_belief_t sharp = {0.95, 0.06}, blurred = {0.75, 0.2};
    return lesser_px < SHARP_PX ? sharp : blurred;
}

/** Stand still with the lens's blur, or take what is beyond it for motion. */
static void start_ways(edge_scene_t *scene, int moved)
{
    const double lesser = fmin(scene->blur_px[0], scene->blur_px[1]);
    scene->way_mm[0] = scene->way_mm[1] = scene->way_mm[2] = 0;
    scene->still_px = 0.5 * (scene->blur_px[0] + scene->blur_px[1]);
    if (!moved) {
        return;
    }
    scene->still_px = fmin(STILL_START, still_belief(lesser).part * lesser);
    for (int family = 0; family < 2; ++family) {
        const double of_way = scene->blur_px[family] * scene->blur_px[family] -
                              scene->still_px * scene->still_px;
        scene->way_mm[family] = sqrt(12 * fmax(0, of_way)) / scene->blur_scale[family];
    }
}

int shaped_start(edge_scene_t *scene, int start, int moved, double middle_mm)
{
    const double shift_px = -scene->shift_px * scene->shift_gain[1];
    if (start == SHAPED_UNCUT) {
        scene->clip = UNCUT;
    } else if (start == 0) {
        start_with_gaussian(scene, shift_px);
    } else if (shift_px > 0.3) {
        start_with_ramp(scene, shift_px, &cut_steps[start == 1 ? 7 : 5]);
    } else {
        return 0;
    }
    if (!(scene->blur_scale[0] > 0 && scene->blur_scale[1] > 0)) {
        return 0;
    }
    start_ways(scene, moved);
    scene->way_at = middle_mm;
    scene->shaped = 1;
    scene->shift_gain[0] = scene->shift_gain[1] = 1;
    scene->shift_px = 0;
    return 1;
}

void shaped_fan(edge_scene_t *scene, double half_mm)
{
    const double height = plane_map_height(&scene->map);
    /* The same mean square over the bar. */
    scene->way_mm[2] = sqrt(3) * scene->way_mm[1] * height / half_mm;
    scene->way_mm[1] = 0;
}

/** Normal equations of the picture's unknowns, lower triangle. */
typedef struct unknowns {
    double m[SHAPED_UNKNOWNS][SHAPED_UNKNOWNS], r[SHAPED_UNKNOWNS];
} unknowns_t;

/** An unknown is `off` too large, to a standard deviation. */
static void know_one(unknowns_t *of, int unknown, double off, double sigma)
{
    of->m[unknown][unknown] += 1 / (sigma * sigma);
    of->r[unknown] -= off / (sigma * sigma);
}

/** What the profiles tell. */
static void know_profiles(const bar_fit_t *fit, unknowns_t *of)
{
    for (int i = 0; i < fit->count; ++i) {
        if (!fit->good[i]) {
            continue;
        }
        const shape_info_t *shape = &fit->shape[i];
        const double noise = (double)(fit->sigma[i] / fit->stretch[i].sigma_unit);
        const double w = 1 / (noise * noise * DOUBT);
        for (int a = 0; a < SHAPES; ++a) {
            of->r[SHAPED_FIRST + a] += w * (double)shape->slope[a];
            for (int b = 0; b <= a; ++b) {
                of->m[SHAPED_FIRST + a][SHAPED_FIRST + b] += w * (double)shape->weight[a][b];
            }
        }
    }
}

/** The blur of the sides that moved less comes mostly from the lens. */
static void know_still(const edge_scene_t *scene, unknowns_t *of)
{
    const int lesser = scene->blur_px[1] < scene->blur_px[0];
    const int still = SHAPED_FIRST + SHAPE_STILL, way = SHAPED_FIRST + SHAPE_WAY + lesser;
    const double blur = scene->blur_px[lesser], scale = scene->blur_scale[lesser];
    const still_belief_t belief = still_belief(blur);
    const double sure = 1 / (belief.sigma * belief.sigma * blur * blur);
    const double off = scene->still_px - belief.part * blur;
    const double by_still = 1 - belief.part * scene->still_px / blur;
    const double by_way = -belief.part * scene->way_mm[lesser] * scale * scale / (12 * blur);
    of->m[still][still] += sure * by_still * by_still;
    of->m[way][still] += sure * by_way * by_still;
    of->m[way][way] += sure * by_way * by_way;
    of->r[still] -= sure * by_still * off;
    of->r[way] -= sure * by_way * off;
}

/** What is known beforehand. */
static void know_scene(const edge_scene_t *scene, unknowns_t *of)
{
    const int ground = SHAPED_FIRST + SHAPE_GROUND, way = SHAPED_FIRST + SHAPE_WAY;
    if (scene->clip < 1) { /* of which the shift cannot be told apart */
        know_one(of, SHAPED_SHIFT, 0, SHIFT_SIGMA_PX);
        know_one(of, ground, scene->ground_drop - GROUND_USUAL, GROUND_SIGMA);
    } else {
        know_one(of, SHAPED_FIRST + SHAPE_CLIP, 0, FIXED);
        know_one(of, ground, 0, FIXED);
    }
    if (edge_scene_moved(scene)) {
        know_still(scene, of);
        know_one(of, way + 2, scene->way_mm[2], RISE_SIGMA_MM);
    } else {
        for (int axis = 0; axis < 3; ++axis) {
            know_one(of, way + axis, 0, FIXED);
        }
    }
}

void shaped_know(const edge_scene_t *scene, const bar_fit_t *fit, double *normal, double *rhs,
                 int n)
{
    unknowns_t of;
    memset(&of, 0, sizeof of);
    know_profiles(fit, &of);
    know_scene(scene, &of);
    const int first = n - SHAPED_UNKNOWNS;
    for (int a = 0; a < SHAPED_UNKNOWNS; ++a) {
        rhs[first + a] += of.r[a];
        for (int b = 0; b <= a; ++b) {
            normal[(first + a) * n + first + b] += of.m[a][b];
        }
    }
}

static double within(double low, double x, double high)
{
    return fmin(high, fmax(low, x));
}

void shaped_blurs(edge_scene_t *scene)
{
    for (int family = 0; family < 2; ++family) {
        const double way = scene->way_mm[family] * scene->blur_scale[family];
        scene->blur_px[family] = sqrt(scene->still_px * scene->still_px + way * way / 12);
    }
}

void shaped_take(edge_scene_t *scene, const double change[SHAPED_UNKNOWNS])
{
    const double *step = &change[SHAPED_FIRST];
    scene->shift_px = change[SHAPED_SHIFT];
    if (scene->clip < 1) {
        const double higher = within(-CLIP_STEP, step[SHAPE_CLIP], CLIP_STEP);
        scene->clip = within(SHAPED_CLIP_LEAST, scene->clip * exp(higher), CLIP_MOST);
        const double darker = within(-GROUND_STEP, step[SHAPE_GROUND], GROUND_STEP);
        scene->ground_drop = within(GROUND_LEAST, scene->ground_drop + darker, GROUND_MOST);
    }
    const double wider = within(-BLUR_STEP, step[SHAPE_STILL], BLUR_STEP);
    scene->still_px = within(BLUR_LEAST, scene->still_px + wider, BLUR_MOST);
    for (int axis = 0; axis < 3; ++axis) {
        const double farther = within(-WAY_STEP_MM, step[SHAPE_WAY + axis], WAY_STEP_MM);
        scene->way_mm[axis] = within(-WAY_MOST_MM, scene->way_mm[axis] + farther, WAY_MOST_MM);
    }
}

/** Mean gradient of the offsets of either family by the unknowns, and their weight. */
static void mean_rows(const bar_fit_t *fit, double row[2][SHAPED_UNKNOWNS], double weight[2])
{
    memset(row, 0, 2 * sizeof row[0]);
    weight[0] = weight[1] = 0;
    for (int i = 0; i < fit->count; ++i) {
        if (fit->good[i]) {
            const int family = fit->stretch[i].side & 1;
            const double w = 1 / (double)(fit->sigma[i] * fit->sigma[i]);
            weight[family] += w;
            float own[SHAPED_UNKNOWNS];
            shaped_row(&fit->shape[i], own);
            for (int a = 0; a < SHAPED_UNKNOWNS; ++a) {
                row[family][a] += w * (double)own[a];
            }
        }
    }
    for (int family = 0; family < 2; ++family) {
        for (int a = 0; a < SHAPED_UNKNOWNS && weight[family] > 0; ++a) {
            row[family][a] /= weight[family];
        }
    }
}

/** Covariance of the mean shifts of the sides along Y [0] and along X [1]; 0 where none follows. */
static int shift_spread(const edge_scene_t *scene, const bar_fit_t *fit, double weight[2],
                        double spread[2][2])
{
    double known[SHAPED_UNKNOWNS * SHAPED_UNKNOWNS] = {0}, unused[SHAPED_UNKNOWNS] = {0};
    double row[2][SHAPED_UNKNOWNS];
    shaped_know(scene, fit, known, unused, SHAPED_UNKNOWNS);
    for (int a = 0; a < SHAPED_UNKNOWNS; ++a) {
        known[a * SHAPED_UNKNOWNS + a] += 1e-6 * (1 + known[a * SHAPED_UNKNOWNS + a]);
    }
    mean_rows(fit, row, weight);
    if (!(weight[0] > 0 && weight[1] > 0) ||
        !spd_factor(known, SHAPED_UNKNOWNS, SPD_PIVOT_LEAST)) {
        return 0;
    }
    for (int f = 0; f < 2; ++f) {
        double solved[SHAPED_UNKNOWNS];
        memcpy(solved, row[f], sizeof solved);
        spd_solve(known, SHAPED_UNKNOWNS, solved);
        for (int g = 0; g < 2; ++g) {
            spread[f][g] = 0;
            for (int a = 0; a < SHAPED_UNKNOWNS; ++a) {
                spread[f][g] += row[g][a] * solved[a];
            }
        }
    }
    return 1;
}

/* How far out the sides along X lie together does no harm: the pitch of the squares shows it. How
 * far those along Y do looks like a turn of the bar about itself. What the one says of the other
 * depends on the shape: given the first, the second is known to a standard deviation r. The pose
 * leaves one shift open. Of this the sides along Y take all, and those along X, whose common shift
 * is seen to a standard deviation `own`, the part own / r: so they hold it to r. */
void shaped_gains(const edge_scene_t *scene, bar_fit_t *fit)
{
    double weight[2], spread[2][2];
    if (!shift_spread(scene, fit, weight, spread)) {
        return;
    }
    const double hidden = fmax(1, CLIP_HALF / scene->clip);
    const double r = hidden * hidden *
                     sqrt(fmax(0, spread[0][0] - spread[0][1] * spread[0][1] / spread[1][1]));
    const double own = 1 / sqrt(weight[1]);
    const double part = r > own ? own / r : 1;
    const float back = (float)((1 - part) * scene->shift_px);
    for (int i = 0; i < fit->count; ++i) {
        stretch_t *s = &fit->stretch[i];
        if (s->side & 1) {
            fit->shift_gain[i] = (float)part;
            s->offset_px -= back;
        } else {
            fit->shift_gain[i] = 1.f;
        }
    }
}
