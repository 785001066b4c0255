/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The nodes of a picture as a calibrator takes them. */
#ifndef OPMS_CLI_CALIBRATE_POINTS_HPP
#define OPMS_CLI_CALIBRATE_POINTS_HPP

#include <memory>
#include <vector>

#include <opms/calib.h>

#include "grid_reader.hpp"

struct CalibratorDeleter {
    void operator()(opms_calibrator_t *calibrator) const { opms_calibrator_destroy(calibrator); }
};
using CalibratorHandle = std::unique_ptr<opms_calibrator_t, CalibratorDeleter>;

/** The labels' places on the grid, and where they are seen. */
inline std::vector<opms_calib_point_t> calibrate_points(const GridPicture &picture)
{
    std::vector<opms_calib_point_t> points;
    points.reserve(picture.nodes.size());
    for (const opms_node_t &node : picture.nodes) {
        points.push_back({{(node.label[0] - OPMS_GRID_CENTRE) * OPMS_GRID_PITCH_M,
                           (node.label[1] - OPMS_GRID_CENTRE) * OPMS_GRID_PITCH_M},
                          {node.px[0], node.px[1]},
                          node.sigma_px});
    }
    return points;
}

#endif
