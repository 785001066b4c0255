/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Exact area of polygons in the cells of a small raster.
 *
 * Every edge adds, row by row, the signed area to its right; a running sum along the rows then
 * gives the covered part of each cell (the method of LibArt and of font-rs). Nothing is sampled. */
#ifndef OPMS_SIMULATE_SIM_RASTER_HPP
#define OPMS_SIMULATE_SIM_RASTER_HPP

#include <vector>

#include "sim_outline.hpp"

namespace opms::simulate
{

class Raster
{
  public:
    /** Of @p size cells a side; cell (0, 0) begins at @p origin_px, @p per_px cells a pixel. */
    Raster(int size, int per_px);

    void clear(const cv::Vec2d &origin_px);
    void add(const Outline &outline);
    /** Covered part of all cells into @p out, size x size, row by row. */
    void cover(std::vector<float> &out) const;

  private:
    void edge(cv::Vec2d a, cv::Vec2d b);
    void inside(const cv::Vec2d &a, const cv::Vec2d &b, double sense);
    void row_part(double *row, double x0, double x1, double height) const;

    int size_, per_px_;
    cv::Vec2d origin_{0, 0};
    std::vector<double> sums_;
};

} // namespace opms::simulate
#endif
