/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What a calibration is good for, in plain words. */
#ifndef OPMS_CLI_CALIBRATE_VERDICT_HPP
#define OPMS_CLI_CALIBRATE_VERDICT_HPP

#include <string>
#include <vector>

#include "calibrate_run.hpp"

struct CalibrateVerdict {
    const char *level; /**< "good", "care" or "again" */
    std::string headline;
    std::vector<std::string> reasons;
};

CalibrateVerdict calibrate_verdict(const CalibrateResult &result);

#endif
