/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Pictures of the bar `apriltag33` for tests: a camera model of the tests' own, the codes of
 * libapriltag's table, area sampling, blur and seeded noise. */
#ifndef APRILTAG_SCENE_H
#define APRILTAG_SCENE_H

#include <opms/types.h>

typedef struct apriltag_scene {
    opms_lens_t lens;
    opms_transform_t bar_camera;
    int first, last;      /**< tags that are printed; the rest of the bar is white */
    int wrong_at;         /**< the tag at this index shows wrong_id, or -1 */
    int wrong_id;
    double black, white, ground; /**< grey levels */
    double blur_px;       /**< Gaussian, without the pixel's own area */
    double noise;         /**< standard deviation */
    uint64_t seed;
} apriltag_scene_t;

/** The whole bar, 40 to 190 grey levels, blur 0.7 px, noise 2, seen by a camera of 900 px focal
 * length from 0.5 m; image right is ahead, image down is along the bar. */
apriltag_scene_t apriltag_scene(void);

/** Draw a scene into rows of the lens's width without a gap. */
void apriltag_render(const apriltag_scene_t *scene, uint8_t *pixels);

#endif
