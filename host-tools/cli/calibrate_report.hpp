/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A calibration as the document that its report is made from. */
#ifndef OPMS_CLI_CALIBRATE_REPORT_HPP
#define OPMS_CLI_CALIBRATE_REPORT_HPP

#include <string>

#include <nlohmann/json.hpp>

#include "calibrate_run.hpp"

/** What was asked for, as the report shows it. */
struct CalibrateAsked {
    std::string grid, name, out;
};

/** Schema opms.calibrate-report/1: all of opms.calibrate/1, and more (docs/calibrate.md).
 * @param written  the camera file, or empty where none was written. */
nlohmann::ordered_json calibrate_report(const CalibrateJob &job, const CalibrateAsked &asked,
                                        const CalibrateResult &result,
                                        const std::string &written);

#endif
