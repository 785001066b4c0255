/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * From a picture to labelled squares and measured edges of the marker bar.
 *
 * Bar frame, codes and reference points: docs/conventions.md. The detector needs the lens, because
 * straight sides are straight in rays and not in pixels; it needs no pose. */
#ifndef OPMS_BAR_H
#define OPMS_BAR_H

#include <opms/status.h>
#include <opms/types.h>

#ifdef __cplusplus
extern "C" {
#endif

#define OPMS_BAR_SQUARES 33           /**< squares of a bar, index 0 to 32 */
#define OPMS_BAR_PITCH_M 0.030        /**< from square to square, along Y */
#define OPMS_BAR_SQUARE_M 0.020       /**< side of a square */
#define OPMS_BAR_ORIGIN 16            /**< index of the square at the origin */
#define OPMS_BAR_EDGES_PER_SIDE 8     /**< most stretches in which one side is measured */
#define OPMS_BAR_EDGES_MAX (OPMS_BAR_SQUARES * 4 * OPMS_BAR_EDGES_PER_SIDE)

typedef enum opms_bar_state {
    OPMS_BAR_ABSENT = 0,    /**< no bar is seen */
    OPMS_BAR_LOCATED = 1,   /**< squares found, labels certain */
    OPMS_BAR_AMBIGUOUS = 2  /**< squares found, but the evidence does not decide (labels or pose) */
} opms_bar_state_t;

/** One square of the bar, where the fitted bar has it. */
typedef struct opms_square {
    int32_t index;          /**< 0 to 32; square k is centred at (0, (k-16) 30 mm, 0) */
    uint32_t edges;         /**< measured stretches on its four sides, at least 1; a side along X
                                 and one along Y are seen */
    /** Corners (u, v) in the order (-X,-Y), (+X,-Y), (+X,+Y), (-X,+Y) of the bar frame. May lie
     * outside the picture for a square that its border cuts. */
    double corners_px[4][2];
} opms_square_t;

/** One stretch of a square's side: a point of the bar and the line in the picture it lies on. */
typedef struct opms_edge {
    int32_t square;     /**< 0 to 32 */
    int32_t side;       /**< 0: X = -10 mm, 1: Y = -10 mm, 2: X = +10 mm, 3: Y = +10 mm */
    double bar_m[2];    /**< (X, Y) of the stretch's middle in the bar plane */
    double px[2];       /**< measured point (u, v), anywhere along the edge */
    double normal[2];   /**< unit normal of the edge in the picture, out of the square */
    double sigma_px;    /**< standard deviation along the normal, from the image noise */
    /** Pixels by which this edge moves along its normal when the common edge shift grows by one: 1,
     * but less on the sides along X of a picture that moved or saturates. Their places tell how far
     * out the others are only as far as the shape of the profiles is known; what they do not take
     * part in has been taken off their px. */
    double shift_gain;
} opms_edge_t;

/** What is known about the picture of the bar as a whole. */
typedef struct opms_bar_summary {
    opms_bar_state_t state;
    uint32_t square_count;
    uint32_t edge_count;
    uint32_t followed;    /**< the bar was found where the hint said */
    double label_margin;  /**< log-likelihood ratio of the labels to the next best; 0 if none */
    /** Standard deviation of the blur across the sides along Y [0] and along X [1], with motion. */
    double blur_px[2];
    double noise;         /**< standard deviation of the grey levels about the edge model */
    double contrast;      /**< median grey levels from black to white, or to saturation */
    double white_fraction_saturated; /**< part of the white beside the squares that is saturated */
} opms_bar_summary_t;

/** Options of a detector; fill with opms_bar_options_init() first. */
typedef struct opms_bar_options {
    uint32_t struct_size;
    int32_t min_square_px; /**< shortest side that the search must not miss; 6 to 64, default 7 */
    opms_allocator_t allocator;
} opms_bar_options_t;

/** Finds bars of kind `hope33`. Holds all memory; one handle, one thread at a time. */
typedef struct opms_bar_detector opms_bar_detector_t;

/** Fill in the defaults. @param[out] options not NULL. @since 0.1 */
OPMS_API void opms_bar_options_init(opms_bar_options_t *options);

/** Create a detector for pictures of one lens.
 *
 * @param lens     Must pass opms_lens_check(); copied. Its size is the size of the pictures.
 * @param options  NULL for the defaults; copied.
 * @param[out] detector  Freed by opms_bar_detector_destroy().
 * @return OPMS_OK, OPMS_ERR_ARG, OPMS_ERR_DOMAIN or OPMS_ERR_MEMORY.
 * @since 0.1 */
OPMS_API opms_status_t opms_bar_detector_create(const opms_lens_t *lens,
                                                const opms_bar_options_t *options,
                                                opms_bar_detector_t **detector, opms_error_t *err);

/** Free a detector. NULL is allowed. @since 0.1 */
OPMS_API void opms_bar_detector_destroy(opms_bar_detector_t *detector);

/** Find the bar in a picture. Never allocates; bounded time.
 *
 * @param image  As large as the lens says; read only during the call.
 * @param roi    NULL for the whole picture; squares are sought inside it.
 * @param hint   NULL, or where the bar is expected (camera to bar); makes a good guess fast and a
 *               wrong one harmless.
 * @param[out] summary  State and figures; not NULL.
 * @return OPMS_OK (whatever the state) or OPMS_ERR_ARG.
 * @since 0.1 */
OPMS_API opms_status_t opms_bar_detect(opms_bar_detector_t *detector, const opms_image_t *image,
                                       const opms_roi_t *roi, const opms_transform_t *hint,
                                       opms_bar_summary_t *summary, opms_error_t *err);

/** Squares of the last opms_bar_detect(), by rising index.
 * @param[out] count  May be NULL.
 * @return Owned by the detector, valid until its next call. @since 0.1 */
OPMS_API const opms_square_t *opms_bar_squares(const opms_bar_detector_t *detector,
                                               uint32_t *count);

/** Measured edges of the last opms_bar_detect().
 * @param[out] count  May be NULL.
 * @return Owned by the detector, valid until its next call. @since 0.1 */
OPMS_API const opms_edge_t *opms_bar_edges(const opms_bar_detector_t *detector, uint32_t *count);

#ifdef __cplusplus
}
#endif
#endif
