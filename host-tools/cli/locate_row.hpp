/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A result of `opms locate` as a JSON row or as a line of a table. */
#ifndef OPMS_CLI_LOCATE_ROW_HPP
#define OPMS_CLI_LOCATE_ROW_HPP

#include <cstddef>
#include <string>

#include "locate_run.hpp"

/** Figures that people read: mm and degrees. */
struct PoseFigures {
    bool of_detector = false; /**< the detector in ground, else the camera in the bar's frame */
    double position_mm[3] = {0, 0, 0};
    double angles_deg[3] = {0, 0, 0}; /**< psi, phi, theta: R = Rz(psi) Ry(phi) Rx(theta) */
    double sigma_mm = 0;  /**< root of the sum of the three variances of the position */
    double sigma_deg = 0; /**< of the worst angle */
};

PoseFigures pose_figures(const opms_location_t &location);

/** One object of schema opms.locate/1, without the line's end. */
std::string locate_json_row(const LocateResult &result);

/** Heading and lines of the table; @p name_width is the width of the first column. */
std::string locate_table_heading(bool of_detector, std::size_t name_width);
std::string locate_table_line(const LocateResult &result, std::size_t name_width);

#endif
