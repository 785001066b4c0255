// SPDX-License-Identifier: Apache-2.0
#include "calib/calib_start.h"

#include <algorithm>

#include "calib/calib_solve.h"
#include "calib/plane_view.h"

namespace opms::calib
{

namespace
{

constexpr uint32_t POINTS_EACH = 60;      // of a picture are enough to choose
constexpr int ITERATIONS = 12;
constexpr double GOOD_ENOUGH_PX = 0.5;    // no other focal length needs to be tried
// In units of the picture's longer side: from a fish-eye's view to a tele lens.
constexpr double LADDER[] = {1.0, 0.6, 1.7, 0.4, 3.0, 6.0};

void reset_lens(opms_calibrator &calibrator, double focal_px)
{
    const opms_calib_options_t &options = calibrator.options;
    calibrator.shape = {};
    calibrator.shape.lens = {options.width_px,
                             options.height_px,
                             focal_px,
                             focal_px,
                             0.5 * (options.width_px - 1),
                             0.5 * (options.height_px - 1),
                             0.0,
                             0.0,
                             0.0,
                             0.0};
}

uint32_t stride_of(const opms_calibrator &calibrator)
{
    uint32_t most = 0;
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        most = std::max(most, calibrator.pictures[k].count);
    }
    return std::max(1U, most / POINTS_EACH);
}

/* Median residual in px: comparable between attempts, whatever each one's weights. */
double attempt(opms_calibrator &calibrator, double focal_px, const SolvePlan &plan)
{
    reset_lens(calibrator, focal_px);
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        pose_from_homography(focal_px, calibrator.pictures[k]);
    }
    const SolveEnd end = solve_jointly(calibrator, plan);
    return std::isfinite(end.cost) ? end.scale : HUGE_VAL;
}

double mean_sigma_px(const opms_calibrator &calibrator)
{
    double sum = 0.0;
    uint32_t count = 0;
    for (uint32_t k = 0; k < calibrator.picture_count; ++k) {
        const Picture &picture = calibrator.pictures[k];
        for (uint32_t i = 0; in_use(picture) && i < picture.count; ++i, ++count) {
            sum += picture.points[i].sigma_px;
        }
    }
    return count > 0 ? sum / count : 1.0;
}

} // namespace

bool start_solution(opms_calibrator &calibrator)
{
    const SolvePlan plan{stride_of(calibrator), ITERATIONS, false};
    const double longer = std::max(calibrator.options.width_px, calibrator.options.height_px);
    const double good = GOOD_ENOUGH_PX / mean_sigma_px(calibrator);
    double best = HUGE_VAL, best_focal = 0.0, last = 0.0;
    const double said = focal_from_homographies(calibrator);
    for (int i = -1; i < (int)(sizeof LADDER / sizeof *LADDER) && !(best < good); ++i) {
        const double focal = i < 0 ? said : LADDER[i] * longer;
        if (focal < 0.05 * longer || focal > 100.0 * longer) {
            continue;
        }
        last = focal;
        const double scale = attempt(calibrator, focal, plan);
        if (scale < best) {
            best = scale;
            best_focal = focal;
        }
    }
    if (!std::isfinite(best)) {
        return false;
    }
    if (best_focal != last) {
        attempt(calibrator, best_focal, plan);
    }
    return true;
}

} // namespace opms::calib
