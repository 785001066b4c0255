/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How exact the detector's poses will be over the volume in which the head works, for a calibrated
 * camera and a bar in full view. */
#ifndef OPMS_CLI_EXPECTED_VOLUME_HPP
#define OPMS_CLI_EXPECTED_VOLUME_HPP

#include <cstdint>
#include <vector>

#include <opms/expect.h>
#include <opms/types.h>

/** Mean variances of a pose: along and about X, Y and Z of the ground. */
struct PoseVariance {
    double position_m2[3] = {0, 0, 0}, rotation_rad2[3] = {0, 0, 0};

    double position_rms_m() const;   /**< of the distance from the truth */
    double rotation_rms_rad() const; /**< of the angle from the truth */
};

PoseVariance operator+(const PoseVariance &a, const PoseVariance &b);

/** A box of places of the level head, and in how many steps it is gone through. */
struct ExpectedBox {
    double low_m[3], high_m[3];
    int steps[3];
    double bar_tilt_rad = 0;

    double place_m(int axis, int step) const; /**< middle of a step */
};

/** X 0.15 to 0.55 m, Y -0.5 to 0.5 m, Z 0 to 0.115 m, over a flat bar. */
ExpectedBox expected_working_volume();

/** Means over the places from which the bar is seen. */
struct ExpectedError {
    uint32_t places = 0, places_seen = 0;
    PoseVariance image;   /**< from the noise of the picture of the bar */
    PoseVariance lens;    /**< from the calibration, had the head stood exactly on its footprint */
    PoseVariance placing; /**< and what the placing there adds */

    PoseVariance calibration() const { return lens + placing; }
    PoseVariance total() const { return image + lens + placing; }
};

/** @param camera  as calibrated; with where it sits on the detector
 *  @param placed  the same with an exact footprint */
ExpectedError expected_over(const opms_camera_t &camera, const opms_camera_t &placed,
                            const ExpectedBox &box);

#endif
