/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How sure a fit is, and how it depends on the lens. */
#ifndef OPMS_POSE_COVARIANCE_H
#define OPMS_POSE_COVARIANCE_H

#include "pose/refine.h"

namespace opms::pose
{

/** What the residuals say about a fit. */
struct FitQuality {
    uint32_t used;      /**< edges with a weight above one half */
    double residual_px; /**< weighted RMS distance of the used edges */
    double chi2_dof;    /**< mean squared residual of the used edges in stated sigmas */
    double inflation;   /**< covariance over inverse normal matrix */
};

/** @param z  residuals of all edges at the fit. */
FitQuality fit_quality(const EdgeSet &set, const Fit &fit, const double *z);

/** Covariance of (w, d) with the shift left open. @return false where it is not determined. */
bool fit_covariance(const Fit &fit, double inflation, Mat7 &inverse, Mat6 &covariance);

/** d(w, d)/d(fx fy cx cy k1 k2 p1 p2): the fit moves so that its gradient stays zero. */
Mat68 fit_by_intrinsics(const EdgeSet &set, const opms_lens_t &lens, const Fit &fit,
                        const Mat7 &inverse);

} // namespace opms::pose
#endif
