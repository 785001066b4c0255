/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Maximum-likelihood fit of a blurred straight step to grey levels. */
#ifndef OPMS_BLURRED_STEP_H
#define OPMS_BLURRED_STEP_H

#include <vector>

namespace opms_tag {

/** One pixel near an edge. */
struct StepSample {
    double along_px; /**< along the expected edge, from its middle */
    double out_px;   /**< from the expected edge, towards white */
    double inner;    /**< 0 to 1: how white the cell behind the black border is here */
    double level;    /**< grey level */
};

/** An edge at out_px = offset_px + slope along_px. */
struct BlurredStep {
    double offset_px, slope;
    double blur_px;      /**< standard deviation of the Gaussian blur */
    double black, step;  /**< level of black, and from it to white */
    double noise;        /**< standard deviation of the levels about the model */
    double sigma_offset_px, sigma_slope;
};

/** Fit offset, slope, blur, black and step.
 *
 * @param border_px  Width of the black border: the inner cell's own edge is that far inside.
 * @return False where there are too few samples, no convergence or no step. */
bool fit_blurred_step(const std::vector<StepSample> &samples, double border_px, BlurredStep &fit);

} // namespace opms_tag

#endif
