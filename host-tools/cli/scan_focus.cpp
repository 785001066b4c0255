/* SPDX-License-Identifier: Apache-2.0 */
#include "scan_focus.hpp"

#include <algorithm>
#include <cmath>

#include "location_json.hpp"
#include "scan_json.hpp"
#include "text_table.hpp"

namespace {

using namespace opms_host;

constexpr double BAR_PX = 4;  /**< blur that fills the gauge */
constexpr int BAR_CELLS = 40;
constexpr double NEAR_BEST = 1.1;

/** "#####|....": the sharper the shorter, with a mark at the best so far. */
std::string gauge(double blur_px, double best_px)
{
    const auto cell = [](double px) {
        return std::clamp(static_cast<int>(std::lround(px / BAR_PX * BAR_CELLS)), 0,
                          BAR_CELLS - 1);
    };
    std::string text(BAR_CELLS, '.');
    std::fill(text.begin(), text.begin() + cell(blur_px), '#');
    if (best_px > 0) {
        text[static_cast<std::size_t>(cell(best_px))] = '|';
    }
    return text;
}

const char *what_to_do(BlurVerdict verdict, bool at_best)
{
    switch (verdict) {
    case BlurVerdict::motion: return "hold the detector still: the picture moves";
    case BlurVerdict::aperture:
        return "sharp in part alone: close it by a stop, or focus on the bar's middle";
    case BlurVerdict::focus:
        return at_best ? "the best so far: if turning on makes it worse, this is the place"
                       : "turn the lens towards a shorter gauge";
    case BlurVerdict::sharp:
        return at_best ? "fix the lens here" : "but it has been sharper";
    case BlurVerdict::unknown: break;
    }
    return "not to be told from this picture";
}

}  // namespace

void FocusView::take(const PoseRecord &pose)
{
    state_ = pose.location.state;
    white_ = pose.light.white;
    if (state_ != OPMS_BAR_LOCATED) {
        recent_.clear();
        return;
    }
    blur_px_ = pose.blur_px;
    verdict_ = pose.blur;
    recent_.push_back(std::max(blur_px_[0], blur_px_[1]));
    if (recent_.size() > SMOOTHED) {
        recent_.pop_front();
    }
    /* A picture that moved says nothing of the lens; a single one may be sharp by chance. */
    if (recent_.size() == SMOOTHED && verdict_ != BlurVerdict::motion &&
        (best_px_ == 0 || now_px() < best_px_)) {
        best_px_ = now_px();
    }
}

double FocusView::now_px() const
{
    std::vector<double> sorted(recent_.begin(), recent_.end());
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
}

std::vector<std::string> FocusView::screen() const
{
    if (!is_fresh()) {
        return {std::string("bar ") + json_bar_state(state_),
                text_format("white at %.0f %%", 100 * white_),
                "lay the bar where it will lie in a scan, all of it in the picture", ""};
    }
    const double now = now_px();
    const bool at_best = best_px_ > 0 && now <= NEAR_BEST * best_px_;
    return {text_format("blur %5.2f px  [%s]  best %.2f px", now, gauge(now, best_px_).c_str(),
                        best_px_),
            text_format("along the bar %.2f px, across it %.2f px; white at %.0f %%", blur_px_[0],
                        blur_px_[1], 100 * white_),
            std::string(blur_verdict_name(verdict_)) + ": " + what_to_do(verdict_, at_best), ""};
}

std::string FocusView::line() const
{
    return is_fresh() ? text_format("blur %.2f px (best %.2f)  %s", now_px(), best_px_,
                                    blur_verdict_name(verdict_))
                      : std::string("bar ") + json_bar_state(state_);
}
