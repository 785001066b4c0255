/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * `opms scan --focus`: how sharp the picture is, while a person turns the lens. */
#ifndef OPMS_CLI_SCAN_FOCUS_HPP
#define OPMS_CLI_SCAN_FOCUS_HPP

#include <array>
#include <deque>
#include <string>
#include <vector>

#include "scan_listener.hpp"

/** Takes the poses, remembers the best. One thread. */
class FocusView {
public:
    void take(const opms_host::PoseRecord &pose);
    std::vector<std::string> screen() const;
    std::string line() const;

private:
    static constexpr std::size_t SMOOTHED = 5; /**< pictures whose median is shown */

    bool is_fresh() const { return !recent_.empty(); }
    double now_px() const;

    std::deque<double> recent_; /**< the larger of both blurs */
    std::array<double, 2> blur_px_{};
    opms_host::BlurVerdict verdict_ = opms_host::BlurVerdict::unknown;
    opms_bar_state_t state_ = OPMS_BAR_ABSENT;
    double best_px_ = 0; /**< 0: none yet */
    double white_ = 0;
};

#endif
