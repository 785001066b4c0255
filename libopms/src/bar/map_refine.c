/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/map_refine.h"

#include <math.h>

#include "bar/bar_code.h"
#include "bar/correlation.h"
#include "bar/map_pass.h"
#include "bar/picture_shape.h"
#include "bar/shaped_fit.h"
#include "algebra/median.h"

/* Passes of: measure the stretches where the map expects them, throw out those that cannot be a
 * side of this bar, fit map and common shift to the rest (Tukey's weights), take over the blur that
 * the profiles ask for. The first passes scout with a few squares spread over the range that is
 * known; the range grows with what has been confirmed, so that the map is never asked for more than
 * it knows. Then all squares are measured, once if nothing moves any more. */

#define SCOUTING_MOST 14
#define SCOUTING_SHAPED 16
#define SCOUTING_SQUARES 6
#define SHAPED_SQUARES 8
#define LENS_BLUR_PX 1.0 /* of a lens in focus, the most */
#define MOVED_BETTER 0.1 /* less misfit with motion than without, for a picture to have moved */
#define ALONG_CLEAR 4.0   /* way along the bar over that across it, for its sign not to matter */
#define CLIP_CLEAR 0.4
#define SCOUTED_PX 0.2f      /* movement after which all squares are measured */
#define SCOUTED_BLUR 0.06f
#define COMPARED_PX 0.05f    /* and after which two starts can be compared */
#define COMPARED_BLUR 0.03f
#define SHAPED 0.04f         /* change of blur (px) or clip that counts as none */
#define SURE_PX 0.3f         /* movement of a range from which its surroundings are well foretold */
#define UNSETTLED_BLUR 0.1f  /* such a change at the end means that nothing settles */
#define UNSETTLED_SHAPED 0.05f
#define PASSES_MOST 16
#define SETTLED_PX 0.01f   /* movement after which no further pass is needed */
#define SWINGING_PASSES 5  /* after which pixels that come and go may be all that moves */
#define LINEAR_PX 0.045f     /* and where the offsets answer a movement to first order */
#define LINEAR_BLUR 0.01f
#define CUT_LOWER 0.75      /* of the contrast that saturation left */

static int clamp_index(int k)
{
    return k < 0 ? 0 : k >= OPMS_BAR_SQUARES ? OPMS_BAR_SQUARES - 1 : k;
}

/** Range of squares that was scouted, and how it ended. */
typedef struct scouting {
    int from, to;
    int settled;
    pass_result_t result;
} scouting_t;

/** Widen the range by a part of what a pass has confirmed; returns whether the pass speaks for all
 * that can be seen of it. */
static int widen(const edge_scene_t *scene, int parts, scouting_t *scouting)
{
    int index[OPMS_BAR_SQUARES];
    const int span = 1 + (scouting->result.high - scouting->result.low);
    const int from = clamp_index(scouting->result.low - parts * span);
    const int to = clamp_index(scouting->result.high + parts * span);
    const int beyond = map_visible_squares(scene, from, scouting->from - 1, 1, index) +
                       map_visible_squares(scene, scouting->to + 1, to, 1, index);
    scouting->from = from < scouting->from ? from : scouting->from;
    scouting->to = to > scouting->to ? to : scouting->to;
    return beyond == 0;
}

/** Passes over few squares, until the range stands still and the blur is known, or, `until_cut`,
 * white is seen to be cut. 0 where too little agrees. */
static int scout(edge_scene_t *scene, int passes, int until_cut, float contrast, bar_fit_t *fit,
                 scouting_t *scouting)
{
    pass_result_t *result = &scouting->result;
    edge_scene_t before = *scene; /* and the range to return to where a wide one finds too little */
    scouting_t narrow = *scouting;
    int index[OPMS_BAR_SQUARES], wide = 0;
    scouting->settled = 0;
    for (int pass = 0; pass < passes && !scouting->settled; ++pass) {
        const int count =
            map_visible_squares(scene, scouting->from, scouting->to,
                                scene->shaped ? SHAPED_SQUARES : SCOUTING_SQUARES, index);
        if (!map_pass(scene, index, count, contrast, 3.f, fit, result)) {
            if (!wide) {
                return 0;
            }
            *scene = before;
            *scouting = narrow;
            wide = 0;
            continue;
        }
        before = *scene;
        narrow = *scouting;
        widen(scene, 1, &narrow);
        wide = result->moved_px < SURE_PX;
        const int known = widen(scene, wide ? 2 : 1, scouting);
        if (until_cut && shape_saturated_part(fit) > SHAPE_SATURATED_LEAST) {
            scouting->settled = result->blurred_px < SCOUTED_BLUR || pass >= 5;
            continue;
        }
        const int compared = scene->shaped && pass < SWINGING_PASSES;
        scouting->settled = known && result->moved_px < (compared ? COMPARED_PX : SCOUTED_PX) &&
                            result->blurred_px < (compared ? COMPARED_BLUR : SCOUTED_BLUR);
    }
    return 1;
}

/** Could the blur be that of motion? That of a lens in focus is less. */
static int has_moved(const edge_scene_t *scene)
{
    return !scene->still && (edge_scene_moved(scene) ||
                             fmin(scene->blur_px[0], scene->blur_px[1]) > LENS_BLUR_PX);
}

/** The best of several starts of shaped profiles. */
typedef struct shaped_trial {
    edge_scene_t scene;
    scouting_t scouting;
    double misfit;
    int any;
} shaped_trial_t;

/** Scout with a scene's shape; it stays if it explains the picture better than those before. */
static void try_shape(const edge_scene_t *start, const scouting_t *before, float contrast,
                      bar_fit_t *fit, shaped_trial_t *best)
{
    edge_scene_t trial = *start;
    scouting_t trying = *before;
    fit->levels.weight[0] = fit->levels.weight[1] = 0;
    if (!scout(&trial, SCOUTING_SHAPED, 0, contrast, fit, &trying)) {
        return;
    }
    const double misfit = map_misfit(fit);
    const int unmoved = best->any && !edge_scene_moved(&best->scene);
    if (!best->any || misfit < best->misfit - (unmoved ? MOVED_BETTER : 0)) {
        best->scene = trial;
        best->scouting = trying;
        best->misfit = misfit;
        best->any = 1;
    }
}

/** Scout with the ways in all basins that a start may end in: those along Y may be of either sign
 * against that along X, and alike all along the bar or, where the camera rose, opposite at its
 * ends. */
static void try_ways(edge_scene_t from, const scouting_t *before, float contrast, bar_fit_t *fit,
                     shaped_trial_t *best)
{
    const double half_mm = 0.5 * BAR_PITCH_MM * (before->to - before->from + 1);
    const double *way = best->scene.way_mm;
    try_shape(&from, before, contrast, fit, best);
    if (best->any && best->scouting.settled && fabs(way[1]) > ALONG_CLEAR * fabs(way[0])) {
        return; /* which way it moved across hardly shows */
    }
    shaped_mirror(&from);
    try_shape(&from, before, contrast, fit, best);
    if (!best->any || fabs(way[1]) < 2 * fabs(way[0])) {
        shaped_fan(&from, half_mm);
        try_shape(&from, before, contrast, fit, best);
        shaped_mirror(&from);
        try_shape(&from, before, contrast, fit, best);
    }
}

/** Scout once more with cut white and motion in the model, from several starts; the best one stays.
 */
static int scout_shaped(edge_scene_t *scene, int cut, float contrast, bar_fit_t *fit,
                        scouting_t *scouting)
{
    const edge_scene_t plain = *scene;
    const scouting_t before = *scouting;
    const double middle = BAR_PITCH_MM * (0.5 * (before.from + before.to) - OPMS_BAR_ORIGIN);
    shaped_trial_t best = {plain, before, 0, 0};
    int moved = edge_scene_moved(&plain);
    for (int start = 0; start < SHAPED_STARTS; ++start) {
        const int from = cut ? start : SHAPED_UNCUT;
        edge_scene_t trial = plain;
        if (!shaped_start(&trial, from, moved, middle)) {
            continue;
        }
        if (!moved) {
            try_shape(&trial, &before, contrast, fit, &best);
            moved = has_moved(&best.scene);
            trial = plain;
        }
        if (moved && (trial.shaped || shaped_start(&trial, from, 1, middle))) {
            try_ways(trial, &before, contrast, fit, &best);
        }
        if (!cut || (best.any && best.scouting.settled && best.scene.clip > CLIP_CLEAR)) {
            break; /* enough is left of the profiles to know */
        }
    }
    if (cut || edge_scene_moved(&best.scene)) { /* else the plain profile is that of the picture */
        *scene = best.scene;
        *scouting = best.scouting;
    }
    return best.any;
}

/** Cut profiles lower than saturation did: resampling, uneven motion and stray light in the lens
 * round the corner at which the camera cut them, as none of the model's shapes has it. */
static void cut_lower(edge_scene_t *scene, bar_fit_t *fit)
{
    int n = 0;
    for (int i = 0; i < fit->count; ++i) {
        if (fit->good[i]) {
            fit->residual[n++] = fit->stretch[i].black;
        }
    }
    const double black = n > 0 ? (double)median_of(fit->residual, n) : 0;
    scene->cut_level = black + CUT_LOWER * (scene->cut_level - black);
    scene->clip *= CUT_LOWER;
}

/** Is no further pass needed after so many? Offsets of a picture that stood still and is not
 * saturated are right to first order in what a pass finds; in others a pass builds on the last
 * one's shape. If they moved, a pixel at a window's end can swing that to and fro; where white is
 * cut, what moves after many passes is rather a slow approach. */
static int has_settled(const edge_scene_t *scene, const pass_result_t *result, int passes)
{
    if (!scene->shaped && !edge_scene_moved(scene)) {
        return result->moved_px < LINEAR_PX && result->blurred_px < LINEAR_BLUR;
    }
    if (edge_scene_moved(scene)) {
        const int swinging = passes >= SWINGING_PASSES && scene->clip >= 1;
        const float most = swinging ? UNSETTLED_SHAPED : SETTLED_PX;
        return result->moved_px < most && result->blurred_px < most;
    }
    return result->moved_px < SETTLED_PX && result->blurred_px < SHAPED;
}

/** The family of sides that shows black and white best: that which moved less; -1 for either. */
static int clearer_family(const edge_scene_t *scene)
{
    const double a = scene->blur_px[0], b = scene->blur_px[1];
    return a < 0.8 * b ? 0 : b < 0.8 * a ? 1 : -1;
}

/** Measure all squares until nothing moves any more; 0 where too little agrees. */
static int settle(edge_scene_t *scene, const scouting_t *scouting, float contrast, bar_fit_t *fit,
                  pass_result_t *result)
{
    int index[OPMS_BAR_SQUARES];
    fit->levels.weight[0] = fit->levels.weight[1] = 0;
    for (int pass = 0, alike = 0; pass < PASSES_MOST; ++pass) {
        const int count =
            map_visible_squares(scene, scouting->from, scouting->to, OPMS_BAR_SQUARES, index);
        if (!map_pass(scene, index, count, contrast, 2.f, fit, result)) {
            return 0;
        }
        if (has_settled(scene, result, ++alike)) {
            /* Levels may be learnt from profiles whose shape is right. */
            if (!scene->shaped || scene->clip < 1 || fit->levels.weight[0] > 0) {
                break;
            }
            map_learn_levels(fit, clearer_family(scene));
            alike = 0;
        }
    }
    return 1;
}

map_verdict_t map_refine(edge_scene_t *scene, int first, int last, float contrast, bar_fit_t *fit)
{
    scouting_t scouting = {clamp_index(first), clamp_index(last), 0, {0, 0, 0, 0}};
    scene->scouting = 1;
    if (!scout(scene, SCOUTING_MOST, 1, contrast, fit, &scouting)) {
        return MAP_LOST;
    }
    const int cut = shape_saturated_part(fit) > SHAPE_SATURATED_LEAST;
    if (cut || has_moved(scene)) {
        if (!scout_shaped(scene, cut, contrast, fit, &scouting)) {
            return MAP_LOST;
        }
        if (cut) {
            cut_lower(scene, fit);
        }
    }
    scene->scouting = 0;
    pass_result_t result = scouting.result;
    if (!settle(scene, &scouting, contrast, fit, &result)) {
        return MAP_LOST;
    }
    if (scene->shaped) {
        shaped_gains(scene, fit);
        if (scene->clip < 1) {
            fit->contrast /= (float)CUT_LOWER; /* up to saturation again, for the report */
        }
    }
    correlation_state(scene, fit);
    const float most = scene->shaped ? UNSETTLED_SHAPED : UNSETTLED_BLUR;
    const int settled = result.blurred_px < most && (!scene->shaped || result.moved_px < most);
    const int unsure = !settled || scene->clip <= SHAPED_CLIP_LEAST;
    return unsure ? MAP_UNSURE : MAP_FIRM;
}
