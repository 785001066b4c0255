/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Are the residuals as independent as the covariance takes them to be? */
#ifndef OPMS_CALIB_CALIB_CORRELATION_H
#define OPMS_CALIB_CALIB_CORRELATION_H

#include "calib/calib_state.h"

namespace opms::calib
{

/** The factor, at least 1, by which the variance of what is fitted grows because residuals are
 * alike in one part of the picture or of the target. */
double residual_correlation(const opms_calibrator &calibrator);

} // namespace opms::calib
#endif
