/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The result of a calibration for people and for programs. */
#ifndef OPMS_CLI_CALIBRATE_TEXT_HPP
#define OPMS_CLI_CALIBRATE_TEXT_HPP

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "calibrate_run.hpp"

/** A warning of opms_calib_result_t: its name for programs, and what to do about it. */
struct CalibrateWarning {
    uint32_t bit;
    const char *name;
    const char *advice;
};

/** Those that are set in @p bits. */
std::vector<CalibrateWarning> calibrate_warnings(uint32_t bits);

/** Lines for people; @p out is the file that was written, or empty. */
std::string calibrate_text(const CalibrateResult &result, const std::string &out);

/** One object of schema opms.calibrate/1. */
nlohmann::ordered_json calibrate_row(const CalibrateResult &result, const std::string &out);

/** The same as text. */
std::string calibrate_json(const CalibrateResult &result, const std::string &out);

#endif
