/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * From picture files of the calibration grid to labelled nodes. */
#ifndef OPMS_CLI_GRID_READER_HPP
#define OPMS_CLI_GRID_READER_HPP

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <opms/grid.h>

/** One picture file and what was found in it. */
struct GridPicture {
    std::string image;
    std::string reason; /**< why it could not be read; else empty */
    int32_t width_px = 0, height_px = 0;
    bool colour = false;
    opms_grid_summary_t summary = {};
    std::vector<opms_node_t> nodes; /**< labels are certain where the state is labelled */
    std::string labelled_from;      /**< the picture whose labels were carried over, or empty */

    /** "labelled", "unlabelled", "absent" or "error". */
    const char *state_name() const;
    bool labelled() const;
};

/** Reads picture after picture; keeps the detector as long as the size stays the same. */
class GridReader {
public:
    /** @param white_level  as in opms_image_t. */
    explicit GridReader(uint16_t white_level) : white_level_(white_level) {}
    GridPicture read(const std::string &image);

private:
    struct Deleter {
        void operator()(opms_grid_detector_t *detector) const
        {
            opms_grid_detector_destroy(detector);
        }
    };
    bool fit_detector(GridPicture &picture);

    uint16_t white_level_;
    int32_t width_px_ = 0, height_px_ = 0;
    std::unique_ptr<opms_grid_detector_t, Deleter> detector_;
};

#endif
