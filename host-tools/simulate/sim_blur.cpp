/* SPDX-License-Identifier: Apache-2.0 */
#include "sim_blur.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace opms::simulate
{
namespace
{

/** The response to an edge is straight between cells: for a total blur of 0.75 px within 0.1 % of
 * the step, without a shift. */
constexpr int CELLS_A_PX = 8;
constexpr double SIGMA_NONE = 0.02;   /* less is no blur at all */
constexpr double TAIL = 4.5;          /* the Gaussian ends here: 7e-6 of it are beyond */
constexpr double CELLS_A_SIGMA = 0.8; /* a Gaussian sampled like this has its variance to 1e-5 */

} // namespace

Blur::Blur(double sigma_px) : per_px_(CELLS_A_PX), reach_px_(0)
{
    std::vector<double> bell = {1};
    int tail = 0;
    if (sigma_px >= SIGMA_NONE) {
        per_px_ = std::max(CELLS_A_PX, static_cast<int>(std::ceil(CELLS_A_SIGMA / sigma_px)));
        const double sigma = sigma_px * per_px_;
        tail = static_cast<int>(std::ceil(TAIL * sigma));
        bell.clear();
        for (int i = -tail; i <= tail; ++i) {
            bell.push_back(std::exp(-i * i / (2 * sigma * sigma)));
        }
    }
    double sum = 0;
    for (const double value : bell) {
        sum += value;
    }
    reach_px_ = (tail + per_px_ - 1) / per_px_;
    std::vector<double> weights(static_cast<std::size_t>((2 * reach_px_ + 1) * per_px_), 0.0);
    for (int i = -tail; i <= tail; ++i) {
        for (int j = 0; j < per_px_; ++j) {
            weights[static_cast<std::size_t>(reach_px_ * per_px_ + i + j)] +=
                bell[static_cast<std::size_t>(i + tail)] / (sum * per_px_);
        }
    }
    weights_.assign(weights.begin(), weights.end());
}

void Blur::reduce(const std::vector<float> &cells, int count_px, float *out, std::size_t stride,
                  int rows, int columns)
{
    const auto side = static_cast<std::size_t>((count_px + 2 * reach_px_) * per_px_);
    column_.resize(side);
    for (int row = 0; row < rows; ++row) {
        std::fill(column_.begin(), column_.end(), 0.0F);
        const float *from = &cells[static_cast<std::size_t>(row * per_px_) * side];
        for (const float weight : weights_) {
            for (std::size_t x = 0; x < side; ++x) {
                column_[x] += weight * from[x];
            }
            from += side;
        }
        for (int px = 0; px < columns; ++px) {
            const float *cell = &column_[static_cast<std::size_t>(px * per_px_)];
            float sum = 0;
            for (std::size_t i = 0; i < weights_.size(); ++i) {
                sum += weights_[i] * cell[i];
            }
            out[static_cast<std::size_t>(row) * stride + static_cast<std::size_t>(px)] = sum;
        }
    }
}

cv::Mat Blur::apply(const cv::Mat &picture) const
{
    /* A cell lies between two pixels and takes of both by its distance. */
    const int reach = reach_px_ + 1;
    std::vector<float> weights(static_cast<std::size_t>(2 * reach + 1), 0.0F);
    for (std::size_t i = 0; i < weights_.size(); ++i) {
        const double at = (static_cast<double>(i) + 0.5) / per_px_ - 0.5 - reach_px_ + reach;
        const auto left = static_cast<std::size_t>(std::floor(at));
        const double right = at - std::floor(at);
        weights[left] += weights_[i] * static_cast<float>(1 - right);
        weights[left + 1] += weights_[i] * static_cast<float>(right);
    }
    cv::Mat out;
    cv::sepFilter2D(picture, out, CV_32F, weights, weights, {-1, -1}, 0, cv::BORDER_REPLICATE);
    return out;
}

} // namespace opms::simulate
