/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Pictures of the bar `hope33` for tests, from the table of docs/conventions.md and not from the
 * library. */
#ifndef BAR_SCENE_H
#define BAR_SCENE_H

#include <opms/types.h>

#define BAR_SCENE_WIDTH 640
#define BAR_SCENE_HEIGHT 480
#define BAR_SCENE_PIXELS (BAR_SCENE_WIDTH * BAR_SCENE_HEIGHT)
#define BAR_SCENE_SQUARES 33

typedef struct bar_scene {
    opms_lens_t lens;
    opms_transform_t bar_camera;
    double shown_m[2];            /**< range of Y of the bar that is not covered by ground */
    double hidden_m[2];           /**< range of Y that is covered */
    int codes[BAR_SCENE_SQUARES]; /**< bit 5 the most significant, 1 = black cell */
    double black, white, ground;  /**< grey levels */
    double blur_px;               /**< Gaussian, without the pixel's own area */
    double noise;                 /**< standard deviation */
    uint64_t seed;
    double top; /**< grey level at saturation */
} bar_scene_t;

/** The whole bar, 40 to 190 grey levels, blur 0.7 px, noise 2, seen by the middle part of the HOPE
 * camera's picture; image right is ahead, image down is along the bar. */
bar_scene_t bar_scene(void);

/** Where the detector is in the scene of bar_scene(), over a flat bar. */
opms_transform_t bar_scene_detector(void);

/** Leave the squares first to last with their cells uncovered. */
void bar_scene_show(bar_scene_t *scene, int first, int last);

/** Turn the camera about its optical axis. */
void bar_scene_roll(bar_scene_t *scene, double angle_rad);

/** Pixel of corner 0 to 3 of a square. */
void bar_scene_corner(const bar_scene_t *scene, int square, int corner, double px[2]);

/** 1 if the four corners of a square are inside the picture by `margin_px`. */
int bar_scene_sees(const bar_scene_t *scene, int square, double margin_px);

/** Draw a scene into rows of the lens's width without a gap, 16 bit or 8 bit (`top` up to 255). */
void bar_render16(const bar_scene_t *scene, uint16_t *pixels);
void bar_render8(const bar_scene_t *scene, uint8_t *pixels);

#endif
