/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The bar where a hint has it, without a search of the picture. */
#ifndef OPMS_BAR_FOLLOW_H
#define OPMS_BAR_FOLLOW_H

#include "bar/detector_state.h"

/** Look for the bar next to where the hint has it: moved by less than half a pitch along itself,
 * and about as far and as turned as the hint says.
 *
 * @return 1 with the results written, 0 where anything does not hold; the detector is then as
 * before, and the picture has to be searched. */
int follow_hint(opms_bar_detector_t *d, const opms_transform_t *hint, int least_contrast,
                const opms_roi_t *roi, opms_bar_summary_t *summary);

#endif
