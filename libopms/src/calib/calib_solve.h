/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The joint least-squares solution of lens and poses. */
#ifndef OPMS_CALIB_CALIB_SOLVE_H
#define OPMS_CALIB_CALIB_SOLVE_H

#include "calib/calib_state.h"

namespace opms::calib
{

/** How far to go. */
struct SolvePlan {
    uint32_t stride;      // every stride-th point of each picture
    int iterations_max;
    bool with_cockle;
};

/** Where it ended. */
struct SolveEnd {
    double cost;  // robust, HUGE_VAL where nothing fitted
    double scale; // of the residuals, in units of the stated sigmas
    int iterations;
    bool converged;
};

/** Improve shape and poses of all pictures in use, from where they are. */
SolveEnd solve_jointly(opms_calibrator &calibrator, const SolvePlan &plan);

/** Robust scale of the residuals, in units of the stated sigmas; samples up to 4096 points. */
double residual_scale(const opms_calibrator &calibrator, uint32_t stride);

} // namespace opms::calib
#endif
