/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * From a fitted bar to the squares, edges and summary that a caller reads. */
#ifndef OPMS_BAR_REPORT_H
#define OPMS_BAR_REPORT_H

#include "bar/detector_state.h"

/** Write the results of a located bar; `roi` moves them to the whole picture's coordinates. */
void bar_report(opms_bar_detector_t *d, const edge_scene_t *scene, const opms_roi_t *roi,
                double margin, opms_bar_summary_t *summary);

#endif
