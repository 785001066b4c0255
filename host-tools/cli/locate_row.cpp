/* SPDX-License-Identifier: Apache-2.0 */
#include "locate_row.hpp"

#include <algorithm>
#include <cmath>

#include "location_json.hpp"
#include "text_table.hpp"

namespace {

using Json = nlohmann::ordered_json;

constexpr double DEG = 180 / 3.14159265358979323846;

/** Whole microseconds, rounded so that the total stays at least the sum of its parts. */
Json json_times(const LocateTimes &time)
{
    return {{"detect", static_cast<long long>(std::floor(time.detect_us))},
            {"pose", static_cast<long long>(std::floor(time.pose_us))},
            {"total", static_cast<long long>(std::ceil(time.total_us))}};
}

}  // namespace

PoseFigures pose_figures(const opms_location_t &location)
{
    PoseFigures figures;
    figures.of_detector = location.has_ground_detector != 0;
    const opms_pose_t &pose =
        figures.of_detector ? location.ground_detector : location.pose.bar_camera;
    const double *R = pose.transform.R;
    figures.angles_deg[0] = DEG * std::atan2(R[3], R[0]);
    figures.angles_deg[1] = DEG * std::atan2(-R[6], std::hypot(R[7], R[8]));
    figures.angles_deg[2] = DEG * std::atan2(R[7], R[8]);
    double variance = 0;
    for (int i = 0; i < 3; i++) {
        figures.position_mm[i] = 1e3 * pose.transform.t_m[i];
        variance += pose.covariance[(3 + i) * 7];
        figures.sigma_deg = std::max(figures.sigma_deg, DEG * std::sqrt(pose.covariance[i * 7]));
    }
    figures.sigma_mm = 1e3 * std::sqrt(variance);
    return figures;
}

std::string locate_json_row(const LocateResult &result)
{
    Json row;
    row["schema"] = "opms.locate/1";
    row["image"] = result.image;
    row["state"] = result.state_name();
    if (!result.reason.empty()) {
        row["reason"] = result.reason;
    } else {
        /* Squares are given with their labels or not at all. */
        const bool labelled = result.location.bar.state == OPMS_BAR_LOCATED;
        row["squares"] =
            json_squares(result.squares.data(), labelled ? result.squares.size() : 0);
        if (result.located()) {
            json_add_pose(row, result.location);
        }
        row["time_us"] = json_times(result.time);
    }
    return json_line(row);
}

std::string locate_table_heading(bool of_detector, std::size_t name_width)
{
    const std::string what = of_detector ? "detector in ground" : "camera in bar frame";
    return text_padded("", name_width) + "             " + what + "\n" +
           text_padded("picture", name_width) +
           "  state         X mm     Y mm     Z mm   sigma  psi deg  phi deg  theta deg   sigma"
           "  squares      ms";
}

std::string locate_table_line(const LocateResult &result, std::size_t name_width)
{
    const std::string start =
        text_padded(result.image, name_width) + text_format("  %-9s", result.state_name());
    if (!result.reason.empty()) {
        return start + "  " + result.reason;
    }
    const double ms = result.time.total_us * 1e-3;
    if (!result.located()) {
        return start + text_format("%*s%8.3f", 77, "", ms);
    }
    const PoseFigures f = pose_figures(result.location);
    return start + text_format(" %8.2f %8.2f %8.2f  %6.3f %8.3f %8.3f   %8.3f  %6.4f %8zu%8.3f",
                               f.position_mm[0], f.position_mm[1], f.position_mm[2], f.sigma_mm,
                               f.angles_deg[0], f.angles_deg[1], f.angles_deg[2], f.sigma_deg,
                               result.squares.size(), ms);
}
