/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A first solution, from nothing. */
#ifndef OPMS_CALIB_CALIB_START_H
#define OPMS_CALIB_CALIB_START_H

#include "calib/calib_state.h"

namespace opms::calib
{

/** Try focal lengths (what the homographies say, and a ladder of others), each with a short
 * solution on a few of the points; keep the one that fits best.
 *
 * @return false where none fits. */
bool start_solution(opms_calibrator &calibrator);

} // namespace opms::calib
#endif
