/* SPDX-License-Identifier: Apache-2.0 */
#include "sim_raster.hpp"

#include <algorithm>
#include <cmath>

namespace opms::simulate
{

Raster::Raster(int size, int per_px)
    : size_(size), per_px_(per_px),
      sums_(static_cast<std::size_t>(size + 2) * static_cast<std::size_t>(size))
{
}

void Raster::clear(const cv::Vec2d &origin_px)
{
    origin_ = origin_px;
    std::fill(sums_.begin(), sums_.end(), 0.0);
}

void Raster::add(const Outline &outline)
{
    const std::size_t count = outline.corners.size();
    for (std::size_t i = 0; i < count; ++i) {
        edge((outline.corners[i] - origin_) * static_cast<double>(per_px_),
             (outline.corners[i + 1 == count ? 0 : i + 1] - origin_) *
                 static_cast<double>(per_px_));
    }
}

/** Cut to the raster: above and below it an edge does nothing, to its right neither; to its left
 * it covers whole rows, as it would standing on the border. */
void Raster::edge(cv::Vec2d a, cv::Vec2d b)
{
    /* A polygon of positive area (y down) has its inside to the right of its rising edges. */
    double sense = -1;
    if (a[1] > b[1]) {
        std::swap(a, b);
        sense = 1;
    }
    if (a[1] == b[1] || b[1] <= 0 || a[1] >= size_) {
        return;
    }
    const cv::Vec2d along = b - a;
    const auto at_y = [&](double y) {
        return cv::Vec2d(a[0] + along[0] * (y - a[1]) / along[1], y);
    };
    const cv::Vec2d low = a[1] < 0 ? at_y(0) : a, high = b[1] > size_ ? at_y(size_) : b;
    cv::Vec2d stops[4] = {low, low, high, high};
    int count = 1;
    const double borders[2] = {along[0] > 0 ? 0.0 : size_, along[0] > 0 ? size_ : 0.0};
    for (const double x : borders) {
        if ((low[0] - x) * (high[0] - x) < 0) {
            const double y = a[1] + along[1] * (x - a[0]) / along[0];
            stops[count++] = {x, std::clamp(y, low[1], high[1])};
        }
    }
    stops[count] = high;
    for (int i = 0; i < count; ++i) {
        const double middle = (stops[i][0] + stops[i + 1][0]) / 2;
        if (middle < size_) {
            inside({std::clamp(stops[i][0], 0.0, static_cast<double>(size_)), stops[i][1]},
                   {std::clamp(stops[i + 1][0], 0.0, static_cast<double>(size_)), stops[i + 1][1]},
                   sense);
        }
    }
}

void Raster::inside(const cv::Vec2d &a, const cv::Vec2d &b, double sense)
{
    const double height = b[1] - a[1];
    if (height <= 0) {
        return;
    }
    const double slope = (b[0] - a[0]) / height;
    double x = a[0], y = a[1];
    for (int row = static_cast<int>(a[1]); row < size_ && y < b[1]; ++row) {
        const double end = std::min(row + 1.0, b[1]);
        const double next = end == b[1] ? b[0] : a[0] + slope * (end - a[1]);
        row_part(&sums_[static_cast<std::size_t>(row) * static_cast<std::size_t>(size_ + 2)], x,
                 next, sense * (end - y));
        x = next;
        y = end;
    }
}

/** The part of an edge inside one row: cell by cell the mean distance to the cell's right side. */
void Raster::row_part(double *row, double x0, double x1, double height) const
{
    const double low = std::min(x0, x1), high = std::max(x0, x1);
    const int first = std::min(static_cast<int>(low), size_ - 1);
    const double width = high - low;
    if (high <= first + 1 || width <= 0) {
        const double right = first + 1 - (low + high) / 2;
        row[first] += height * right;
        row[first + 1] += height * (1 - right);
        return;
    }
    for (double x = low; x < high;) {
        const int cell = std::min(static_cast<int>(x), size_ - 1);
        const double end = std::min(cell + 1.0, high);
        const double part = height * (end - x) / width, right = cell + 1 - (x + end) / 2;
        row[cell] += part * right;
        row[cell + 1] += part * (1 - right);
        if (end <= x) {
            break;
        }
        x = end;
    }
}

void Raster::cover(std::vector<float> &out) const
{
    const auto size = static_cast<std::size_t>(size_);
    out.resize(size * size);
    for (std::size_t row = 0; row < size; ++row) {
        double sum = 0;
        for (std::size_t x = 0; x < size; ++x) {
            sum += sums_[row * (size + 2) + x];
            out[row * size + x] = static_cast<float>(sum);
        }
    }
}

} // namespace opms::simulate
