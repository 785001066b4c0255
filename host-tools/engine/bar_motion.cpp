/* SPDX-License-Identifier: Apache-2.0 */
#include "bar_motion.hpp"

#include <algorithm>
#include <cmath>

namespace opms_host {
namespace {

constexpr std::int64_t OLD_NS = 500'000'000;

}  // namespace

void BarMotion::take(const std::vector<opms_square_t> &squares, std::int64_t t_ns)
{
    if (squares.empty()) {
        return;
    }
    std::array<Seen, OPMS_BAR_SQUARES> now{};
    double way_px = -1;
    for (const opms_square_t &square : squares) {
        Seen &seen = now[static_cast<std::size_t>(square.index)];
        seen.is_there = true;
        for (const auto &corner : square.corners_px) {
            seen.centre[0] += corner[0] / 4;
            seen.centre[1] += corner[1] / 4;
        }
        const Seen &before = last_[static_cast<std::size_t>(square.index)];
        if (before.is_there) {
            way_px = std::max(way_px, std::hypot(seen.centre[0] - before.centre[0],
                                                 seen.centre[1] - before.centre[1]));
        }
    }
    const std::int64_t time_ns = t_ns - last_ns_;
    const bool is_known = way_px >= 0 && time_ns > 0 && time_ns < OLD_NS;
    speed_px_s_ = is_known ? way_px * 1e9 / static_cast<double>(time_ns) : 0;
    last_ = now;
    last_ns_ = t_ns;
}

double BarMotion::speed_px_s(std::int64_t now_ns) const
{
    return now_ns - last_ns_ < OLD_NS ? speed_px_s_ : 0;
}

void BarMotion::forget()
{
    *this = BarMotion();
}

}  // namespace opms_host
