/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * From pictures of the calibration grid to a camera: what `opms calibrate` does, without its
 * options and its words. */
#ifndef OPMS_CLI_CALIBRATE_RUN_HPP
#define OPMS_CLI_CALIBRATE_RUN_HPP

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <opms/calib.h>
#include <opms/types.h>

#include "calibrate_advice.hpp"
#include "expected_volume.hpp"
#include "grid_reader.hpp"

/** Where the head stood on the grid when a picture was taken. */
struct FootprintPlace {
    std::string image;
    double x_m = 0, y_m = 0, yaw_rad = 0;
};

struct CalibrateJob {
    std::vector<std::string> images;        /**< in the order they were taken */
    std::vector<FootprintPlace> footprints; /**< of some of them; the first goes into the file */
    double footprint_sigma_m = 0, footprint_sigma_rad = 0;
    double cockle_sigma_m = 0; /**< as in opms_calib_options_t; 0: the sheet is flat */
    uint16_t white_level = 0;
};

/** One picture: its nodes, and what became of it. */
struct CalibratePicture {
    GridPicture grid;
    std::string left_out;          /**< why it takes no part; empty where it does */
    std::optional<uint32_t> index; /**< in the calibrator */
    opms_calib_picture_t solved = {};
    std::vector<double> residuals_px; /**< two a node, where used: measured less calculated */
    std::vector<double> weights;      /**< one a node: robust, 0 to 1 */

    bool used() const { return left_out.empty() && index.has_value(); }
};

enum class CalibrateState {
    calibrated,
    undetermined, /**< solved, but the pictures do not fix the camera */
    unsolved,     /**< nothing fits the pictures */
    bad_pictures  /**< unread, of mixed sizes, too few, or none on the footprint */
};

struct CalibrateResult {
    CalibrateState state = CalibrateState::bad_pictures;
    std::string reason; /**< empty where calibrated */
    std::vector<CalibratePicture> pictures;
    bool has_solution = false; /**< calib and the pictures' `solved` are filled in */
    opms_calib_result_t calib = {};
    std::vector<FootprintPlace> footprints; /**< those that were used */
    opms_camera_t camera = {};              /**< complete where calibrated */
    opms_camera_t placed = {};              /**< the same, had the footprints been exact */
    std::optional<ExpectedError> expected;  /**< of positions, where calibrated */
    std::optional<CalibrateAdvice> next;    /**< the picture to take next, where solved */
    std::string next_words;                 /**< a sentence about it */
};

/** Warnings without which there is no camera to speak of. */
constexpr uint32_t CALIBRATE_OPEN =
    OPMS_CALIB_ALL_PARALLEL | OPMS_CALIB_FOCAL_OPEN | OPMS_CALIB_CENTRE_OPEN;

using CalibrateTalk = std::function<void(const std::string &)>;

/** Read, label and sort out the pictures. @param talk  is told one line a picture. */
std::vector<CalibratePicture> calibrate_read(const CalibrateJob &job, const CalibrateTalk &talk);

/** All of it. */
CalibrateResult calibrate_run(const CalibrateJob &job, const CalibrateTalk &talk);

#endif
