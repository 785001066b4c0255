/* SPDX-License-Identifier: Apache-2.0 */
#include "calibrate_report.hpp"

#include <cmath>

#include <opms/version.h>

#include "calibrate_text.hpp"
#include "calibrate_verdict.hpp"

namespace {

using Json = nlohmann::ordered_json;

constexpr double DEG = 180 / 3.14159265358979323846, MM_PER_M = 1e3;
constexpr int CELLS = 8; /* of the picture each way, those of opms_calib_result_t.coverage */
constexpr double NODE_DIGITS = 1e5; /* px: far below what a node's place is known to */
constexpr double BAR_TILT_DEG = 19.3;
constexpr int MAP_X = 5, MAP_Y = 9;

double rounded(double value)
{
    return std::round(value * NODE_DIGITS) / NODE_DIGITS;
}

double sigma(const double *covariance, int n, int i)
{
    return std::sqrt(covariance[i * n + i]);
}

Json lens_sigma(const double *covariance)
{
    static const char *const names[8] = {"fx_px", "fy_px", "cx_px", "cy_px",
                                         "k1",    "k2",    "p1",    "p2"};
    Json row;
    for (int i = 0; i < 8; i++) {
        row[names[i]] = sigma(covariance, 8, i);
    }
    return row;
}

Json mounting_sigma(const double *covariance)
{
    Json place = Json::array(), turn = Json::array();
    for (int i = 0; i < 3; i++) {
        turn.push_back(DEG * sigma(covariance, 6, i));
        place.push_back(MM_PER_M * sigma(covariance, 6, i + 3));
    }
    return {{"place_mm", place}, {"rotation_deg", turn}};
}

bool is_inlier(const CalibratePicture &picture, std::size_t node)
{
    return picture.weights[node] >= 0.25;
}

Json nodes_of(const CalibratePicture &picture)
{
    Json labels = Json::array(), px = Json::array(), residual = Json::array(),
         inlier = Json::array();
    for (std::size_t i = 0; i < picture.weights.size(); i++) {
        const opms_node_t &node = picture.grid.nodes[i];
        labels.push_back({node.label[0], node.label[1]});
        px.push_back({rounded(node.px[0]), rounded(node.px[1])});
        residual.push_back(
            {rounded(picture.residuals_px[2 * i]), rounded(picture.residuals_px[2 * i + 1])});
        inlier.push_back(is_inlier(picture, i) ? 1 : 0);
    }
    return {{"label", labels}, {"px", px}, {"residual_px", residual}, {"inlier", inlier}};
}

void add_nodes(Json &report, const CalibrateResult &result)
{
    double sum_px = 0;
    std::size_t count = 0;
    for (std::size_t k = 0; k < result.pictures.size(); k++) {
        const CalibratePicture &picture = result.pictures[k];
        Json &row = report["pictures"][k];
        row["number"] = k + 1;
        if (!picture.used() || picture.weights.empty()) {
            continue;
        }
        row["nodes"] = nodes_of(picture);
        for (std::size_t i = 0; i < picture.weights.size(); i++) {
            if (is_inlier(picture, i)) {
                sum_px += std::hypot(picture.residuals_px[2 * i], picture.residuals_px[2 * i + 1]);
                count++;
            }
        }
    }
    if (count > 0) {
        report["residual_mean_px"] = sum_px / static_cast<double>(count);
    }
}

Json coverage_cells(const CalibrateResult &result)
{
    std::vector<std::vector<int>> cells(CELLS, std::vector<int>(CELLS, 0));
    for (const CalibratePicture &picture : result.pictures) {
        for (std::size_t i = 0; picture.used() && i < picture.weights.size(); i++) {
            const double *px = picture.grid.nodes[i].px;
            const auto column = static_cast<int>(
                std::floor((px[0] + 0.5) * CELLS / picture.grid.width_px));
            const auto row =
                static_cast<int>(std::floor((px[1] + 0.5) * CELLS / picture.grid.height_px));
            if (column >= 0 && column < CELLS && row >= 0 && row < CELLS) {
                cells[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)]++;
            }
        }
    }
    return cells;
}

Json heights_of(const CalibrateResult &result)
{
    Json rows = Json::array();
    for (const double tilt_deg : {0.0, BAR_TILT_DEG}) {
        for (const double part : {0.0, 0.5, 1.0}) {
            ExpectedBox box = expected_working_volume();
            const double z_m = box.low_m[2] + part * (box.high_m[2] - box.low_m[2]);
            box.low_m[2] = box.high_m[2] = z_m;
            box.steps[2] = 1;
            box.bar_tilt_rad = tilt_deg / DEG;
            const ExpectedError error = expected_over(result.camera, result.placed, box);
            if (error.places_seen > 0) {
                rows.push_back(
                    {{"head_z_m", z_m},
                     {"bar_tilt_deg", tilt_deg},
                     {"image_mm", MM_PER_M * error.image.position_rms_m()},
                     {"calibration_mm", MM_PER_M * error.calibration().position_rms_m()},
                     {"total_mm", MM_PER_M * error.total().position_rms_m()},
                     {"total_deg", DEG * error.total().rotation_rms_rad()}});
            }
        }
    }
    return rows;
}

/** One place of the map; null where the bar is not seen. */
void add_place(Json &unplaced, Json &total, const CalibrateResult &result,
               const ExpectedBox &box)
{
    const ExpectedError error = expected_over(result.camera, result.placed, box);
    const bool seen = error.places_seen > 0;
    const PoseVariance exact = error.image + error.lens;
    unplaced.push_back(seen ? Json(MM_PER_M * exact.position_rms_m()) : Json());
    total.push_back(seen ? Json(MM_PER_M * error.total().position_rms_m()) : Json());
}

Json map_of(const CalibrateResult &result)
{
    ExpectedBox box = expected_working_volume();
    const double z_m = 0.5 * (box.low_m[2] + box.high_m[2]);
    box.steps[0] = MAP_X;
    box.steps[1] = MAP_Y;
    Json x_m = Json::array(), y_m = Json::array(), unplaced = Json::array(),
         total = Json::array();
    for (int i = 0; i < MAP_X; i++) {
        Json unplaced_row = Json::array(), total_row = Json::array();
        x_m.push_back(box.place_m(0, i));
        for (int j = 0; j < MAP_Y; j++) {
            const double x = box.place_m(0, i), y = box.place_m(1, j);
            add_place(unplaced_row, total_row, result,
                      {{x, y, z_m}, {x, y, z_m}, {1, 1, 1}, 0});
        }
        unplaced.push_back(unplaced_row);
        total.push_back(total_row);
    }
    for (int j = 0; j < MAP_Y; j++) {
        y_m.push_back(box.place_m(1, j));
    }
    return {{"head_z_m", z_m},
            {"x_m", x_m},
            {"y_m", y_m},
            {"unplaced_mm", unplaced},
            {"total_mm", total}};
}

Json options_of(const CalibrateJob &job, const CalibrateAsked &asked)
{
    Json options = {{"name", asked.name},
                    {"grid", asked.grid},
                    {"out", asked.out},
                    {"white_level", job.white_level},
                    {"cockle_mm", MM_PER_M * job.cockle_sigma_m},
                    {"footprint_sigma",
                     {{"place_mm", MM_PER_M * job.footprint_sigma_m},
                      {"turn_deg", DEG * job.footprint_sigma_rad}}}};
    for (const FootprintPlace &place : job.footprints) {
        options["footprints"][place.image] = {{"x_mm", MM_PER_M * place.x_m},
                                              {"y_mm", MM_PER_M * place.y_m},
                                              {"yaw_deg", DEG * place.yaw_rad}};
    }
    return options;
}

/** Published figures of the system that this one follows. */
Json original_system()
{
    return {{"residual_mean_px", 0.185},
            {"position_rms_mm", 12.93},
            {"angle_rms_deg", {1.2, 2.0}},
            {"need_mm_per_axis", 5}};
}

}  // namespace

nlohmann::ordered_json calibrate_report(const CalibrateJob &job, const CalibrateAsked &asked,
                                        const CalibrateResult &result, const std::string &written)
{
    Json report = calibrate_row(result, written);
    report["schema"] = "opms.calibrate-report/1";
    const CalibrateVerdict verdict = calibrate_verdict(result);
    report["verdict"] = {{"level", verdict.level},
                         {"headline", verdict.headline},
                         {"reasons", verdict.reasons}};
    report["program"] = {{"version", opms_version()}};
    report["options"] = options_of(job, asked);
    report["pictures_given"] = result.pictures.size();
    add_nodes(report, result);
    if (result.has_solution) {
        report["lens_sigma"] = lens_sigma(result.calib.covariance);
        report["coverage_cells"] = coverage_cells(result);
        report["original"] = original_system();
    }
    if (result.state == CalibrateState::calibrated) {
        report["mounting_sigma"] = mounting_sigma(result.camera.covariance_detector_camera);
    }
    if (report.contains("expected")) {
        report["expected"]["heights"] = heights_of(result);
        report["expected"]["map"] = map_of(result);
    }
    return report;
}
