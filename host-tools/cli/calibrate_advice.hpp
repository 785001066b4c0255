/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Which picture to take next: of those that could be, the one that helps most. */
#ifndef OPMS_CLI_CALIBRATE_ADVICE_HPP
#define OPMS_CLI_CALIBRATE_ADVICE_HPP

#include <optional>
#include <string>
#include <vector>

#include <opms/calib.h>

/** A picture to be taken, and what it would do. */
struct CalibrateAdvice {
    std::string how;     /**< for the operator: "the detector leaning to the left by ..." */
    std::string towards; /**< "left", "right", "back", "ahead", "up" or "down"; "" where level */
    double tilt_rad = 0; /**< by how much more than in the first picture */
    double distance_m = 0;
    opms_transform_t grid_camera = {};
    uint32_t nodes = 0;
    double gain = 0; /**< as in opms_calib_foresight_t */
    /** The lens's part of the expected position error, RMS; where there is a footprint. */
    std::optional<double> now_m, then_m;
};

/** @param calibrator  with a solution
 *  @param first       a picture that it used: moves are told from there
 *  @param footprints  of pictures used, with sigmas of 0; without any, directions are those of
 *                     the picture and not of the detector
 *  @return nothing where no other picture would show the grid. */
std::optional<CalibrateAdvice> calibrate_advice(const opms_calibrator_t *calibrator,
                                                uint32_t first,
                                                const std::vector<opms_footprint_t> &footprints);

/** A sentence for the operator. @param total_m  the expected position error as a whole, if known */
std::string calibrate_advice_words(const CalibrateAdvice &advice, std::optional<double> total_m);

#endif
