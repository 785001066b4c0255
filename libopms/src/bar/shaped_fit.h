/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The shape that cut white and motion give profiles, as unknowns of the picture, solved with the
 * map. */
#ifndef OPMS_BAR_SHAPED_FIT_H
#define OPMS_BAR_SHAPED_FIT_H

#include "bar/map_refine.h"

/** Unknowns beside the map: common shift, then those of shape_info_t. */
enum { SHAPED_SHIFT, SHAPED_FIRST, SHAPED_UNKNOWNS = SHAPED_FIRST + SHAPES };

_Static_assert(MAP_UNKNOWNS + SHAPED_UNKNOWNS <= FIT_UNKNOWNS_MOST, "columns of the fit");

#define SHAPED_STARTS 3

#define SHAPED_UNCUT SHAPED_STARTS /* the start for white that is not cut */

/** The least clip that a fit ends at: the profiles' shape, and with it the edges' places, are then
 * a guess. */
#define SHAPED_CLIP_LEAST 0.12

/** Start modelling cut white, and motion if the picture `moved`, from what a fit without them
 * shows; 0 where start number `start` makes no sense. The ways hold at Y = middle_mm. */
int shaped_start(edge_scene_t *scene, int start, int moved, double middle_mm);

/** Let the ways along Y and Z be the other way round. A picture does not tell in which direction
 * time went, and only where sides end in which way the families moved together. */
static inline void shaped_mirror(edge_scene_t *scene)
{
    scene->way_mm[1] = -scene->way_mm[1];
    scene->way_mm[2] = -scene->way_mm[2];
}

/** Let the way along Y be none in the middle and grow towards both ends, `half_mm` away. */
void shaped_fan(edge_scene_t *scene, double half_mm);

/** Gradient of a measured offset by the unknowns; by all but the shift, of what is still to be
 * added to them. */
static inline void shaped_row(const shape_info_t *shape, float row[SHAPED_UNKNOWNS])
{
    row[SHAPED_SHIFT] = 1;
    for (int a = 0; a < SHAPES; ++a) {
        row[SHAPED_FIRST + a] = -shape->by[a];
    }
}

/** Add to the lower triangle of n x n normal equations, whose last unknowns are those above, what
 * is known of these besides the offsets: by the profiles, and beforehand. */
void shaped_know(const edge_scene_t *scene, const bar_fit_t *fit, double *normal, double *rhs,
                 int n);

/** Let the families' blurs be what blur and ways make them. */
void shaped_blurs(edge_scene_t *scene);

/** Take over what was solved for; shaped_blurs() follows, at the scale that the pass has found. */
void shaped_take(edge_scene_t *scene, const double change[SHAPED_UNKNOWNS]);

/** Let the shift that the pose leaves open stand for what the unknowns may still be wrong by. */
void shaped_gains(const edge_scene_t *scene, bar_fit_t *fit);

#endif
