/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Is a camera file still valid? What `opms calibrate --check` does, and how it says it. */
#ifndef OPMS_CLI_CALIBRATE_CHECK_HPP
#define OPMS_CLI_CALIBRATE_CHECK_HPP

#include <optional>
#include <string>
#include <vector>

#include <opms/calib.h>

#include "calibrate_run.hpp"
#include "camera_file.hpp"

enum class CheckVerdict {
    valid,
    lens_touched,
    camera_moved, /**< on the detector */
    cannot_tell,
    bad_pictures  /**< unread, of another size, without a grid */
};

/** What the mounting looks like from one picture on a footprint. */
struct CheckMounting {
    std::string image;
    opms_calib_mounting_check_t figures = {};
};

struct CheckResult {
    CheckVerdict verdict = CheckVerdict::bad_pictures;
    std::string reason; /**< in one sentence */
    std::string advice; /**< what to do; empty where all is well */
    std::vector<CalibratePicture> pictures;
    bool has_lens = false; /**< lens and mountings are filled in */
    opms_calib_lens_check_t lens = {};
    bool lens_assumed = false; /**< the file has no covariance; one was assumed */
    std::vector<CheckMounting> mountings;
    std::optional<opms_calib_result_t> alone; /**< what the pictures say without the file */
};

/** Judge a camera file by pictures of the grid.
 *
 * @param job  Its images; its footprints, of which there may be none. */
CheckResult calibrate_check(const opms_host::CameraFile &file, const CalibrateJob &job,
                            const CalibrateTalk &talk);

/** "valid", "lens_touched", ... */
const char *check_verdict_name(CheckVerdict verdict);

/** Lines for people. */
std::string check_text(const std::string &path, const opms_host::CameraFile &file,
                       const CheckResult &result);

/** One object of schema opms.calibrate_check/1. */
std::string check_json(const std::string &path, const opms_host::CameraFile &file,
                       const CheckResult &result);

#endif
