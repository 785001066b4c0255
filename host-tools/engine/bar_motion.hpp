/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How fast the bar moves through the pictures. */
#ifndef OPMS_ENGINE_BAR_MOTION_HPP
#define OPMS_ENGINE_BAR_MOTION_HPP

#include <array>
#include <cstdint>
#include <vector>

#include <opms/bar.h>

namespace opms_host {

/** Speed by the squares that two pictures in a row share. One thread at a time. */
class BarMotion {
public:
    /** A picture's squares; none: it was not located. @param t_ns  When it was taken. */
    void take(const std::vector<opms_square_t> &squares, std::int64_t t_ns);
    /** Of the fastest square; 0: not known, or older than half a second at @p now_ns. */
    double speed_px_s(std::int64_t now_ns) const;
    void forget();

private:
    using Centre = std::array<double, 2>;
    struct Seen {
        bool is_there = false;
        Centre centre{};
    };
    std::array<Seen, OPMS_BAR_SQUARES> last_{};
    std::int64_t last_ns_ = 0;
    double speed_px_s_ = 0;
};

}  // namespace opms_host
#endif
