/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The search for the bar in one picture: lines, seeds, rows, labels, refinement. */
#ifndef OPMS_BAR_SEARCH_H
#define OPMS_BAR_SEARCH_H

#include "bar/detector_state.h"

/** Search the picture that has been set up in the detector, near the hint (or NULL) first. */
void bar_search(opms_bar_detector_t *d, const opms_transform_t *hint, int least_contrast,
                const opms_roi_t *roi, opms_bar_summary_t *summary);

#endif
