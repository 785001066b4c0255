/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * From a labelled row to the located bar: refined on all its edges, read once more, reported. */
#ifndef OPMS_BAR_BAR_SETTLE_H
#define OPMS_BAR_BAR_SETTLE_H

#include "bar/detector_state.h"

/** What is known of the bar before its edges are measured. */
typedef struct bar_start {
    plane_map_t map;
    double shift_px;   /**< common outward shift of the sides */
    int first, last;   /**< range of squares that the map was fitted to */
    int squares_least; /**< fewer than so many confirmed are no bar */
} bar_start_t;

/** Measure the bar and write the results; the state says how far it came.
 *
 * @param contrast  Least grey levels from black to white. */
opms_bar_state_t bar_settle(opms_bar_detector_t *d, const bar_start_t *start, float contrast,
                            const opms_roi_t *roi, opms_bar_summary_t *summary);

#endif
