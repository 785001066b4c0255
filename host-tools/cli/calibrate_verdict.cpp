/* SPDX-License-Identifier: Apache-2.0 */
#include "calibrate_verdict.hpp"

#include <algorithm>

#include "calibrate_text.hpp"
#include "text_table.hpp"

namespace {

constexpr double DEG = 180 / 3.14159265358979323846, MM_PER_M = 1e3;
constexpr double NEED_M = 5e-3;       /* an axis: what mine detection asks of a position */
constexpr double PLACING_MOST = 0.75; /* of the variance: then say what to do about it */

double worst_axis_m(const PoseVariance &variance)
{
    return std::sqrt(*std::max_element(variance.position_m2, variance.position_m2 + 3));
}

/** Does the camera do for what it is there for? */
bool meets_need(const CalibrateResult &result)
{
    return result.expected && result.expected->places_seen > 0 &&
           worst_axis_m(result.expected->total()) <= NEED_M;
}

std::string expected_words(const ExpectedError &expected)
{
    if (expected.places_seen == 0) {
        return "From no place of the working volume is enough of the bar in the picture: is the "
               "footprint's place, and with it the camera's on the detector, what was said?";
    }
    return text_format(
        "Positions of the head will be off by about %.2f mm (RMS over the working volume): %.2f mm "
        "from the calibration and %.2f mm from the noise of the picture. Its direction will be off "
        "by about %.2f degrees.",
        MM_PER_M * expected.total().position_rms_m(),
        MM_PER_M * expected.calibration().position_rms_m(),
        MM_PER_M * expected.image.position_rms_m(), DEG * expected.total().rotation_rms_rad());
}

std::string placing_words(const ExpectedError &expected)
{
    return text_format(
        "Nearly all of that comes from how well the head was laid on its footprint (the lens alone "
        "would give %.2f mm). To do better, add pictures from other footprints "
        "(--footprint-image), or lay the head with a stop and say so (--footprint-sigma).",
        MM_PER_M * expected.lens.position_rms_m());
}

bool placing_rules(const ExpectedError &expected)
{
    const auto square = [](double x) { return x * x; };
    return square(expected.placing.position_rms_m()) >
           PLACING_MOST * square(expected.total().position_rms_m());
}

void add_expected(const CalibrateResult &result, CalibrateVerdict &verdict)
{
    if (!result.expected) {
        return;
    }
    verdict.reasons.push_back(expected_words(*result.expected));
    if (result.expected->places_seen > 0 && placing_rules(*result.expected)) {
        verdict.reasons.push_back(placing_words(*result.expected));
    }
    if (result.expected->places_seen > 0 && !meets_need(result)) {
        verdict.reasons.push_back(text_format("That is more than the %.0f mm an axis that are "
                                              "needed.", MM_PER_M * NEED_M));
    }
}

void add_left_out(const CalibrateResult &result, CalibrateVerdict &verdict)
{
    const auto count = std::count_if(result.pictures.begin(), result.pictures.end(),
                                     [](const CalibratePicture &p) { return !p.used(); });
    if (count > 0) {
        verdict.reasons.push_back(
            text_format("%d of %zu pictures could not be used; the reasons stand below.",
                        static_cast<int>(count), result.pictures.size()));
    }
}

}  // namespace

CalibrateVerdict calibrate_verdict(const CalibrateResult &result)
{
    CalibrateVerdict verdict{"again", "Do it again: there is no camera file", {}};
    const uint32_t warnings = result.has_solution ? result.calib.warnings : 0;
    if (result.state != CalibrateState::calibrated || !result.reason.empty()) {
        verdict.reasons.push_back(result.reason);
    } else if (!meets_need(result)) {
        verdict.headline = "Do it again: positions would not be exact enough";
    } else if (warnings != 0) {
        verdict.level = "care";
        verdict.headline = "Usable, but it could be better";
    } else {
        verdict.level = "good";
        verdict.headline = "Good: the camera file can be used";
    }
    add_expected(result, verdict);
    for (const CalibrateWarning &warning : calibrate_warnings(warnings)) {
        verdict.reasons.push_back(warning.advice);
    }
    add_left_out(result, verdict);
    return verdict;
}
