/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Pictures of the grid, read in their order by as many threads as there are processors: most of the
 * time of a calibration goes into unpacking pictures. */
#ifndef OPMS_CLI_GRID_READING_AHEAD_HPP
#define OPMS_CLI_GRID_READING_AHEAD_HPP

#include <cstddef>
#include <future>
#include <string>
#include <vector>

#include "grid_reader.hpp"

/** Reads a list of pictures; one thread may call it. No more pictures than threads are held. */
class GridReadingAhead {
public:
    /** @param images       outlives this.
     *  @param white_level  as in opms_image_t. */
    GridReadingAhead(const std::vector<std::string> &images, uint16_t white_level);

    /** The next picture of the list; call it once for each. */
    GridPicture next();

private:
    void start(std::size_t image);

    const std::vector<std::string> &images_;
    std::vector<GridReader> readers_; /* image i is read by the i-th of them, modulo their number */
    std::vector<std::future<GridPicture>> ahead_;
    std::size_t next_ = 0;
};

#endif
