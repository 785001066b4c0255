/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * opms::apriltag: from a picture to labelled squares and measured edges of the bar `apriltag33`.
 *
 * A library of its own beside libopms, the only user of libapriltag. That library finds and reads
 * the tags; the borders are then measured anew on the raw grey levels, so that the edges can go to
 * opms_locator_solve() or opms_pose_solve() like those of bar.h. Bar frame, squares and sides are
 * those of `hope33`: tag k is square k, its black border the square's four sides.
 *
 * Tags smaller than about 3 px a cell (24 px a side) are not expected to be read. */
#ifndef OPMS_APRILTAG_H
#define OPMS_APRILTAG_H

#include <opms/bar.h>
#include <opms/status.h>
#include <opms/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Options of a detector; fill with opms_apriltag_options_init() first. */
typedef struct opms_apriltag_options {
    uint32_t struct_size;
    int32_t decimate; /**< search in every n-th pixel, 1 to 4, default 1; all are measured in */
} opms_apriltag_options_t;

/** Finds bars of kind `apriltag33`. One handle, one thread at a time; different handles freely. */
typedef struct opms_apriltag_detector opms_apriltag_detector_t;

/** Fill in the defaults. @param[out] options not NULL. @since 0.1 */
OPMS_API void opms_apriltag_options_init(opms_apriltag_options_t *options);

/** Create a detector for pictures of one lens.
 *
 * @param lens     Must pass opms_lens_check(); copied. Its size is the size of the pictures.
 * @param options  NULL for the defaults; copied.
 * @param[out] detector  Freed by opms_apriltag_detector_destroy().
 * @return OPMS_OK, OPMS_ERR_ARG, OPMS_ERR_DOMAIN or OPMS_ERR_MEMORY.
 * @since 0.1 */
OPMS_API opms_status_t opms_apriltag_detector_create(const opms_lens_t *lens,
                                                     const opms_apriltag_options_t *options,
                                                     opms_apriltag_detector_t **detector,
                                                     opms_error_t *err);

/** Free a detector. NULL is allowed. @since 0.1 */
OPMS_API void opms_apriltag_detector_destroy(opms_apriltag_detector_t *detector);

/** Find the bar in a picture.
 *
 * Tags whose id is above 32, that repeat another, or that do not lie where the others put the tag
 * of that id are left out. Allocates (libapriltag does), unlike the calls of libopms.
 *
 * @param image  As large as the lens says; read only during the call.
 * @param[out] summary  Not NULL. `state` is ABSENT where no tag of the bar is seen, LOCATED where
 *               at least two agree, AMBIGUOUS where there is one alone, none agree, or a second
 *               bar is in the picture. `label_margin` is that of the tags' codes.
 * @return OPMS_OK (whatever the state), OPMS_ERR_ARG or OPMS_ERR_MEMORY.
 * @since 0.1 */
OPMS_API opms_status_t opms_apriltag_detect(opms_apriltag_detector_t *detector,
                                            const opms_image_t *image, opms_bar_summary_t *summary,
                                            opms_error_t *err);

/** Squares of the last opms_apriltag_detect(), by rising index; none unless it was LOCATED.
 * @param[out] count  May be NULL.
 * @return Owned by the detector, valid until its next call. @since 0.1 */
OPMS_API const opms_square_t *opms_apriltag_squares(const opms_apriltag_detector_t *detector,
                                                    uint32_t *count);

/** Measured edges of the last opms_apriltag_detect(); two a side, whose errors are independent.
 * @param[out] count  May be NULL.
 * @return Owned by the detector, valid until its next call. @since 0.1 */
OPMS_API const opms_edge_t *opms_apriltag_edges(const opms_apriltag_detector_t *detector,
                                                uint32_t *count);

#ifdef __cplusplus
}
#endif
#endif
