/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Where the sides of a square lie in the picture, to the limit that the noise sets. */
#ifndef OPMS_BAR_EDGE_FIT_H
#define OPMS_BAR_EDGE_FIT_H

#include <math.h>

#include <opms/bar.h>

#include "bar/plane_map.h"
#include "image/view.h"

/** What is known of the picture when the sides are measured. */
typedef struct edge_scene {
    const view_t *view;
    const opms_lens_t *lens;
    double ray_limit;
    plane_map_t map;
    double shift_px;      /**< common outward shift of the sides */
    double shift_gain[2]; /**< by which a family of sides takes part in it; families as blur_px */
    double blur_px[2];    /**< standard deviation, of the sides along Y (X = +-10 mm) and of those
                             along X */
    double blur_scale[2]; /**< px per mm across those sides where the blur is as stated: what of it
                             comes from motion grows with the scale */
    double still_px;   /**< what of the blur does not come from motion */
    int still;         /**< the picture is known not to have moved: one blur for all sides */
    int shaped;        /**< profiles are modelled with cut white and motion: what follows holds */
    double way_mm[3];  /**< of the picture over the bar while the shutter was open, along X and Y at
                            way_at, and what the camera rose: then the picture grows */
    double way_at;     /**< Y, mm */
    double clip;       /**< part of the true contrast at which white is cut, UNCUT if it is not */
    double ground_drop; /**< how much darker than white the ground is, part of the true contrast;
                             used where white is cut */
    double cut_noise;  /**< of grey levels, over the contrast that saturation leaves */
    double cut_level;  /**< lighter pixels are cut at this grey level, at most that of saturation */
    const struct stretch_kernel *kernel;
    int scouting;      /**< a few lines of pixels across a side are enough */
} edge_scene_t;

#define UNCUT 2.0 /* a clip that no coverage reaches */

/** Did the picture move? Before its profiles are shaped: do the families' blurs differ for
 * certain? */
static inline int edge_scene_moved(const edge_scene_t *scene)
{
    if (scene->shaped) {
        return fabs(scene->way_mm[0]) + fabs(scene->way_mm[1]) > 0;
    }
    const double a = scene->blur_px[0], b = scene->blur_px[1];
    return a > 1.18 * b || b > 1.18 * a;
}

/** Grey levels of black [0] and white [1] that the picture has shown, and the weight of each as so
 * many pixels of a stretch; weight 0 where none is known. */
typedef struct grey_levels {
    float grey[2], weight[2];
} grey_levels_t;

/** Sums over the pixels of a stretch: of the grey level i, of the regressors, and of products.
 * Regressors are the white coverage w, its slope g along the normal, its derivative h by the blur,
 * the ground k, and the slope c of the code cells' part of the coverage. */
enum {
    SUM_I,
    SUM_II,
    SUM_W,
    SUM_WI,
    SUM_WW,
    SUM_G,
    SUM_GI,
    SUM_GW,
    SUM_GG,
    SUM_H,
    SUM_HI,
    SUM_HW,
    SUM_HG,
    SUM_HH,
    SUM_C = 16, /**< these only where there are cells or ground; fours are written at once */
    SUM_CW,
    SUM_CG,
    SUM_K = 20,
    SUM_KI,
    SUM_KW,
    SUM_KG,
    SUM_KH,
    SUM_KK,
    SUMS = 28
};

typedef struct fit_sums {
    float of[SUMS];
    float n;
} fit_sums_t;

/** What a stretch tells of the shape that all profiles share: logarithm of the clip, blur but for
 * motion, the ways along X, Y and Z, the ground's drop. */
enum { SHAPE_CLIP, SHAPE_STILL, SHAPE_WAY, SHAPE_GROUND = SHAPE_WAY + 3, SHAPES };

typedef struct shape_info {
    float weight[SHAPES][SHAPES]; /**< normal equations, lower triangle, for noise 1; */
    float slope[SHAPES];              /**< step = weight^-1 slope */
    float by[SHAPES];                 /**< derivative of the offset */
} shape_info_t;

/** One stretch of a side, as fitted. */
typedef struct stretch {
    int16_t square, side;
    uint16_t pixels;
    uint16_t saturated;   /**< pixels at the white level */
    uint8_t shaped, ground, cells; /**< with cut white and motion; the ground, cells in its model */
    float expected_px;    /**< offset at which the sums were taken */
    float along_mm;       /**< position of its middle along the side */
    float normal[2];      /**< outward, unit */
    float predicted[2];   /**< unshifted edge of the map at along_mm, px */
    float by_blur;        /**< derivative of the offset by the blur it is measured with */
    float by_cells;       /**< and by the place of the code cells beyond the side */
    float offset_px;      /**< measured edge from `predicted`, outward */
    float sigma_unit;     /**< standard deviation of the offset for noise of one grey level */
    float black;          /**< grey level */
    float contrast;       /**< grey levels from black to white, or to saturation */
    float px_per_mm;      /**< across the side */
    float variance;       /**< of the grey levels about the model */
    float level_variance[2]; /**< of black and of white as found here, for noise 1 */
    float blur_slope, blur_weight; /**< information on the blur: Newton step = slope / weight */
} stretch_t;

/** Where stretches are written to, one array for each of what is used at different times. */
typedef struct stretch_place {
    stretch_t *stretch;
    fit_sums_t *sums;  /**< of those that are not `shaped` */
    shape_info_t *shape; /**< of those that are */
} stretch_place_t;

/** Measure the visible stretches of one square's four sides.
 *
 * Model: grey = black + contrast (white coverage), the coverage that of a straight edge under a
 * Gaussian blur, with the square's corners and the black code cells next to the side in it;
 * black, contrast and position are free for each stretch. Raw pixels, no resampling.
 *
 * @param levels     Black and white where they are known.
 * @param[out] out  Its arrays have room for 4 OPMS_BAR_EDGES_PER_SIDE more.
 * @return The number of stretches that could be fitted. */
int edge_fit_square(const edge_scene_t *scene, int square, const grey_levels_t *levels,
                    const stretch_place_t *out);

/** Solve a measured stretch once more, with other grey levels; 0 where it has no edge to be placed.
 */
int stretch_solve(const grey_levels_t *levels, const fit_sums_t *sums, stretch_t *stretch);

#endif
