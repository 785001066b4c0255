/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The least squares of one stretch of a side, on raw pixels. */
#ifndef OPMS_BAR_STRETCH_FIT_H
#define OPMS_BAR_STRETCH_FIT_H

#include "bar/edge_fit.h"
#include "bar/bar_code.h"
#include "bar/edge_blur.h"

#define LINE_PIXELS_MAX 64
#define STRETCH_LINES_MAX 32
#define FIT_LINE_SPARE 8 /* pixels behind a line that may be read */

/** What lies along one side of a square, in the picture. */
typedef struct side_model {
    edge_blur_t blur;      /**< across the side */
    float sigma, per_sigma; /**< standard deviation of that blur, and 1 / it */
    float end_at; /**< where the side ends, mm from its middle, the common shift included */
    float along_scale;     /**< standard deviations of the blur along the side, per mm of it */
    float per_cut_noise;    /**< 1 / the noise at the level where white is cut, coverages */
    int family;             /**< of the side, as in edge_scene_t */
    grey_levels_t levels;   /**< where they are known and white is not cut */
    float way_px, way_by;   /**< way of the side outwards while the shutter was open, and its
                                 derivative by that of the scene */
    float way_mm;           /**< and along itself */
    float rise_across, rise_along; /**< of either by what the camera rises */
    int panels;             /**< into as many is the way divided, 0 if it did not move */
    float lean;            /**< correlation of the blur across the side and along it: what a
                                corner is off the right angle in the picture */
    unsigned cells;        /**< black code cells beyond the gap, bar_gap_cells(); 0 for none */
    float cell_near, cell_far; /**< distance of the cells' two borders, px */
    float ground;          /**< distance of the bar's border, px; 0 where it is out of reach */
    float ground_drop;     /**< of the ground from white, part of the true contrast; where cut */
    float clip; /**< part of the contrast at which white saturates, 1 where it does not */
    float white_level;     /**< grey level of a saturated pixel */
    float cut_level;       /**< lighter pixels are cut at this grey level where `clip` is below 1 */
} side_model_t;

/** One line of pixels across a side. Both coordinates of the side run along it, since a line of the
 * picture is seldom square to the side. */
typedef struct fit_line {
    const uint8_t *first; /**< pixel */
    int count;
    int in_row; /**< 8 bit pixels side by side; what fills up the last lanes is in the picture */
    float s_first,
        s_step; /**< distance from the expected edge, outward: first pixel, and step, px */
    float along_first, along_step; /**< position along the side, mm from its middle */
} fit_line_t;

typedef struct fit_lines {
    int count;
    int wide;              /**< 16 bit pixels */
    ptrdiff_t pixel_bytes; /**< from a pixel of a line to the next */
    fit_line_t line[STRETCH_LINES_MAX];
} fit_lines_t;

#define STRETCH_REACH 3.5f /**< standard deviations from where on a step has no effect */

/** The ends of black cells that lie within reach of a stretch. */
typedef struct cell_ends {
    float base; /**< black at the stretch's lower end: 0 or 1 */
    int count;
    float at_mm[BAR_CELLS + 1], sign[BAR_CELLS + 1];
} cell_ends_t;

/** Which part of the code cells beyond the side a stretch from `low` to `high` mm sees. */
void stretch_cell_ends(const side_model_t *model, float low, float high, cell_ends_t *ends);

/** What looks at every pixel, compiled for one kind of vector unit; all give the same bytes. */
typedef struct stretch_kernel {
    /** Sum up the pixels of two stretches of a side; their geometry is the caller's. The second
     * may have no lines. */
    void (*sum)(const side_model_t *model, const fit_lines_t lines[2], stretch_t *const out[2],
                fit_sums_t *const sums[2]);
    /** Fit a stretch of a picture whose white saturates; 0 where it has no edge to be placed. */
    int (*fit_shaped)(const side_model_t *model, const fit_lines_t *lines, stretch_t *out,
                       shape_info_t *shape);
} stretch_kernel_t;

/** The kernel for the widest registers that this machine has, or, not `wide`, that all have. */
const stretch_kernel_t *stretch_kernel(int wide);

void stretch_sum_plain(const side_model_t *model, const fit_lines_t lines[2],
                       stretch_t *const out[2], fit_sums_t *const sums[2]);
void stretch_sum_avx2(const side_model_t *model, const fit_lines_t lines[2],
                      stretch_t *const out[2], fit_sums_t *const sums[2]);
int stretch_shaped_plain(const side_model_t *model, const fit_lines_t *lines, stretch_t *out,
                       shape_info_t *shape);
int stretch_shaped_avx2(const side_model_t *model, const fit_lines_t *lines, stretch_t *out,
                      shape_info_t *shape);

#endif
