/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * From fine cells to pixels: the pixel's square and the optics' Gaussian in one step.
 *
 * A cell holds an exact area average over 1/per_px pixel. The mean of per_px x per_px neighbours is
 * then an exact pixel square at any cell's place; the Gaussian weighs such squares. */
#ifndef OPMS_SIMULATE_SIM_BLUR_HPP
#define OPMS_SIMULATE_SIM_BLUR_HPP

#include <vector>

#include <opencv2/core.hpp>

namespace opms::simulate
{

class Blur
{
  public:
    explicit Blur(double sigma_px);

    int per_px() const
    {
        return per_px_;
    }
    /** Pixels that a pixel's light can come from on each side. */
    int reach_px() const
    {
        return reach_px_;
    }
    /** Cells, (count_px + 2 reach_px) per_px a side, to count_px x count_px pixels; @p out has
     * @p stride floats a row, and only @p rows x @p columns of it are written. */
    void reduce(const std::vector<float> &cells, int count_px, float *out, std::size_t stride,
                int rows, int columns);
    /** The same for a picture that is given at pixels only and interpolated between them. */
    cv::Mat apply(const cv::Mat &picture) const;

  private:
    int per_px_, reach_px_;
    std::vector<float> weights_; /**< of cells, the first reach_px before the pixel */
    std::vector<float> column_;
};

} // namespace opms::simulate
#endif
