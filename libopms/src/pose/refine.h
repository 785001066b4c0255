/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Robust Gauss-Newton on the edges: pose and common shift. */
#ifndef OPMS_POSE_REFINE_H
#define OPMS_POSE_REFINE_H

#include <algorithm>

#include "pose/edge_set.h"

namespace opms::pose
{

/** Tukey's constant: residuals from here on, in units of the scale, have no weight. Under Gaussian
 * noise the estimate keeps 98 % of the least-squares efficiency. */
constexpr double TUKEY = 6.0;

/** Tukey's weight of a residual; `scale` in the same unit. */
inline double tukey_weight(double residual, double scale)
{
    const double part = residual / (TUKEY * scale);
    const double rest = 1.0 - part * part;
    return rest > 0.0 ? rest * rest : 0.0;
}

/** What an edge adds to the matrix of the normal equations. */
enum class Steps {
    Careful, /**< its weight: never overshoots, gains a digit a step */
    Newton   /**< the curvature of its loss: two or three steps near the solution */
};

/** The normal equations at a placement. The seven unknowns are w, R^T d and the shift in px: with
 * the translation in the camera's axes no edge needs the rotation for its gradient. */
struct Normal {
    Mat7 matrix;
    Vec7 gradient;
    double cost;   /**< sum of twice Tukey's loss in units of scale^2: chi2 for small residuals */
    bool in_front; /**< all points have positive depth and all numbers are finite */
};

/** A placement, the scale of its residuals, and the equations there. */
struct Fit {
    Placement placement;
    double scale; /**< of the residuals in stated sigmas: 1, or more where they are larger */
    Normal normal;
    bool converged;
};

/** Residuals in sigmas, measured minus model minus shift, of the first n edges. */
void residuals(const EdgeSet &set, uint32_t n, const Placement &placement, double *z);

/** 1.4826 times the median distance from zero; over at most 128 of them. */
double robust_scale(const double *z, uint32_t n);

/** Equations of the first n edges. */
void normal_equations(const EdgeSet &set, uint32_t n, const Placement &placement, double scale,
                      Steps steps, Normal &normal);

/** matrix^-1, scaled for accuracy. @return false where an unknown is not determined. */
bool invert_information(const Mat7 &matrix, Mat7 &inverse);

/** How refine() goes about it. */
struct RefinePlan {
    Steps steps;
    int iterations_max;
    double tolerance; /**< chi2 that the last step may still gain */
    double window;    /**< scale over that of Gaussian residuals with the median seen */
};

/** From a start to the nearest minimum over the first n edges. fit.placement is the start.
 *
 * The last step is taken, but fit.normal is left at the place before it. */
void refine(const EdgeSet &set, uint32_t n, const RefinePlan &plan, Fit &fit);

} // namespace opms::pose
#endif
