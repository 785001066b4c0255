/* SPDX-License-Identifier: Apache-2.0 */
#include "grid_reading_ahead.hpp"

#include <algorithm>
#include <thread>

namespace {

constexpr unsigned THREADS_MOST = 8; /* each holds a detector and a picture */

}  // namespace

GridReadingAhead::GridReadingAhead(const std::vector<std::string> &images, uint16_t white_level)
    : images_(images)
{
    const std::size_t threads = std::clamp(std::thread::hardware_concurrency(), 1U, THREADS_MOST);
    for (std::size_t i = 0; i < std::min(threads, images.size()); i++) {
        readers_.emplace_back(white_level);
    }
    ahead_.resize(readers_.size());
    for (std::size_t i = 0; i < readers_.size(); i++) {
        start(i);
    }
}

void GridReadingAhead::start(std::size_t image)
{
    if (image < images_.size()) {
        const std::size_t slot = image % readers_.size();
        ahead_[slot] = std::async(std::launch::async, [this, slot, image] {
            return readers_[slot].read(images_[image]);
        });
    }
}

GridPicture GridReadingAhead::next()
{
    GridPicture picture = ahead_[next_ % readers_.size()].get();
    start(next_ + readers_.size());
    next_++;
    return picture;
}
