/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Saturated white: its level and the blur as unknowns of the picture, solved with the map. */
#ifndef OPMS_BAR_CLIP_FIT_H
#define OPMS_BAR_CLIP_FIT_H

#include "bar/map_refine.h"

/** Unknowns beside the map: common shift, then those of clip_info_t. */
enum { CLIP_SHIFT, CLIP_FIRST, CLIP_UNKNOWNS = CLIP_FIRST + CLIP_SHAPE };

#define CLIP_STARTS 3

/** Start modelling saturated white, from what a fit without it shows; 0 where start number `start`
 * makes no sense. */
int clip_start(edge_scene_t *scene, int start);

/** Gradient of a measured offset by the unknowns; by the last three, of what is still to be
 * added to them. */
void clip_row(const clip_info_t *clip, float row[CLIP_UNKNOWNS]);

/** Add to the lower triangle of n x n normal equations, whose last unknowns are those above, what
 * is known of these besides the offsets: the profiles' shape, and that the shift is small. */
void clip_know(const edge_scene_t *scene, const bar_fit_t *fit, double *normal, double *rhs, int n);

/** Take over what was solved for. */
void clip_take(edge_scene_t *scene, const double change[CLIP_UNKNOWNS]);

/** Has so little been left of white that the fit ended at the least that it allows? Its shape, and
 * with it the edges' places, are then a guess. */
int clip_at_bound(const edge_scene_t *scene);

/** Let the common shift stand for what the unknowns may still be wrong by together: the pattern of
 * offsets that they are the least certain of. */
void clip_gains(const edge_scene_t *scene, bar_fit_t *fit);

#endif
