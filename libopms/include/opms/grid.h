/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * From a picture of the calibration grid `a0-25` to its labelled nodes.
 *
 * Black lines 2 mm wide at a pitch of 25 mm on white, 33 across X and 45 along Y; the node at
 * (i 25 mm, j 25 mm) of the grid frame is labelled (50 + i, 50 + j). A black square from 3 to 9 mm
 * in +X and +Y of the centre node tells centre and direction (docs/conventions.md). No lens is
 * needed: lines may bend. */
#ifndef OPMS_GRID_H
#define OPMS_GRID_H

#include <opms/status.h>
#include <opms/types.h>

#ifdef __cplusplus
extern "C" {
#endif

#define OPMS_GRID_PITCH_M 0.025
#define OPMS_GRID_LINE_M 0.002
#define OPMS_GRID_CENTRE 50   /**< label of the centre node, both ways */
#define OPMS_GRID_NODES_X 33  /**< labels 34 to 66 */
#define OPMS_GRID_NODES_Y 45  /**< labels 28 to 72 */
#define OPMS_GRID_NODES_MAX (OPMS_GRID_NODES_X * OPMS_GRID_NODES_Y)

typedef enum opms_grid_state {
    OPMS_GRID_ABSENT = 0,    /**< no grid is seen */
    OPMS_GRID_LABELLED = 1,  /**< nodes found, labels certain */
    OPMS_GRID_UNLABELLED = 2 /**< nodes found, but not the marker: labels begin anywhere and may be
                                  turned by quarters; see opms_grid_relabel() */
} opms_grid_state_t;

/** One node. */
typedef struct opms_node {
    int32_t label[2]; /**< (50 + i, 50 + j) */
    double px[2];     /**< (u, v) */
    /** Standard deviation of each coordinate: from the image noise, and raised for all nodes of a
     * picture alike where they scatter by more than that about smooth lines. */
    double sigma_px;
} opms_node_t;

/** What is known about the picture as a whole. */
typedef struct opms_grid_summary {
    opms_grid_state_t state;
    uint32_t node_count;
    double noise;         /**< standard deviation of the grey levels about the line model */
    double contrast;      /**< median grey levels from white to the depth of a line */
    double blur_px;       /**< standard deviation of the blur */
    double marker_margin; /**< contrast of the marker over the next best place, 0 to 1; 0 if none */
} opms_grid_summary_t;

/** Options of a detector; fill with opms_grid_options_init() first. */
typedef struct opms_grid_options {
    uint32_t struct_size;
    int32_t width_px, height_px; /**< of the pictures; 16 to 16384, no default */
    double min_pitch_px;         /**< shortest distance between lines sought; 8 to 100, default 9 */
    opms_allocator_t allocator;
} opms_grid_options_t;

/** Finds grids. Holds all memory; one handle, one thread at a time. */
typedef struct opms_grid_detector opms_grid_detector_t;

/** Fill in the defaults. @param[out] options not NULL. @since 0.3 */
OPMS_API void opms_grid_options_init(opms_grid_options_t *options);

/** Create a detector.
 * @param options  Not NULL, with the pictures' size; copied.
 * @param[out] detector  Freed by opms_grid_detector_destroy().
 * @return OPMS_OK, OPMS_ERR_ARG or OPMS_ERR_MEMORY. @since 0.3 */
OPMS_API opms_status_t opms_grid_detector_create(const opms_grid_options_t *options,
                                                 opms_grid_detector_t **detector,
                                                 opms_error_t *err);

/** Free a detector. NULL is allowed. @since 0.3 */
OPMS_API void opms_grid_detector_destroy(opms_grid_detector_t *detector);

/** Find the grid in a picture. Never allocates; bounded time.
 *
 * Method: a white cell between four lines is sought from the middle of the picture outwards; nodes
 * spread from it in all four directions, each predicted from its neighbours and confirmed by dark
 * valleys on its arms; then both lines through each node are fitted to the raw pixels (a line of
 * the grid's width, blurred, on white that may change across it), and cross in the node.
 *
 * @param image  As large as the options say; read only during the call.
 * @param[out] summary  State and figures; not NULL.
 * @return OPMS_OK (whatever the state) or OPMS_ERR_ARG. @since 0.3 */
OPMS_API opms_status_t opms_grid_detect(opms_grid_detector_t *detector, const opms_image_t *image,
                                        opms_grid_summary_t *summary, opms_error_t *err);

/** Nodes of the last opms_grid_detect(), by label: first (34, 28), (35, 28), ...
 * @param[out] count  May be NULL.
 * @return Owned by the detector, valid until its next call. @since 0.3 */
OPMS_API const opms_node_t *opms_grid_nodes(const opms_grid_detector_t *detector, uint32_t *count);

/** Label the nodes of a picture whose marker is hidden from a neighbouring picture.
 *
 * Certain where the camera moved by much less than half a pitch between both: all of the eight
 * shifts around the best one, and the other quarter turns, must fit clearly worse.
 *
 * @param known    Labelled nodes of a picture taken shortly before or after.
 * @param[in,out] nodes  Their labels are replaced where the answer is certain.
 * @param[out] certain   1 where it is; else 0 and nothing is changed.
 * @return OPMS_OK or OPMS_ERR_ARG. Pure: any thread. @since 0.3 */
OPMS_API opms_status_t opms_grid_relabel(const opms_node_t *known, uint32_t known_count,
                                         opms_node_t *nodes, uint32_t count, uint32_t *certain,
                                         opms_error_t *err);

#ifdef __cplusplus
}
#endif
#endif
