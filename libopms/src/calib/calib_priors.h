/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Weak priors keep directions that the pictures leave wholly open from running away; they are too
 * wide to be felt by a calibration that can be used. */
#ifndef OPMS_CALIB_CALIB_PRIORS_H
#define OPMS_CALIB_CALIB_PRIORS_H

#include "calib/calib_state.h"

namespace opms::calib
{

/** Deviation of a shared unknown from its prior value, and its standard deviation; sigma 0: none.
 */
struct Prior {
    double off, sigma;
};

inline Prior prior_of(const opms_calibrator &calibrator, const Shape &shape, int unknown)
{
    const opms_calib_options_t &options = calibrator.options;
    switch (unknown) {
    case 2:
        return {shape.lens.cx_px - 0.5 * (options.width_px - 1), 0.5 * options.width_px};
    case 3:
        return {shape.lens.cy_px - 0.5 * (options.height_px - 1), 0.5 * options.width_px};
    case 4:
        return {shape.lens.k1, 3.0};
    case 5:
        return {shape.lens.k2, 10.0};
    case 6:
        return {shape.lens.p1, 0.3};
    case 7:
        return {shape.lens.p2, 0.3};
    default:
        if (unknown < LENS) {
            return {0.0, 0.0};
        }
        return {shape.cockle[unknown - LENS], options.cockle_sigma_m};
    }
}

} // namespace opms::calib
#endif
