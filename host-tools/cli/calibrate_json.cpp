/* SPDX-License-Identifier: Apache-2.0 */
#include <nlohmann/json.hpp>

#include "calibrate_text.hpp"

namespace {

using Json = nlohmann::ordered_json;

constexpr double DEG = 180 / 3.14159265358979323846;

Json json_vector(const double *values, int count)
{
    return Json(std::vector<double>(values, values + count));
}

Json json_matrix(const double *values, int rows, int cols)
{
    Json matrix = Json::array();
    for (int r = 0; r < rows; r++) {
        matrix.push_back(json_vector(values + r * cols, cols));
    }
    return matrix;
}

const char *state_name(CalibrateState state)
{
    switch (state) {
    case CalibrateState::calibrated:
        return "calibrated";
    case CalibrateState::undetermined:
        return "undetermined";
    case CalibrateState::unsolved:
        return "unsolved";
    case CalibrateState::bad_pictures:
        break;
    }
    return "error";
}

Json json_picture(const CalibratePicture &picture, bool has_solution)
{
    Json row = {{"image", picture.grid.image},
                {"state", picture.grid.state_name()},
                {"node_count", picture.grid.nodes.size()}};
    if (!picture.grid.labelled_from.empty()) {
        row["labelled_from"] = picture.grid.labelled_from;
    }
    if (!picture.left_out.empty()) {
        row["left_out"] = picture.left_out;
    } else if (has_solution && picture.used()) {
        row["outliers"] = picture.solved.outliers;
        row["residual_rms_px"] = picture.solved.residual_rms_px;
        row["tilt_deg"] = DEG * picture.solved.tilt_rad;
        row["gain"] = picture.solved.gain;
        row["R_grid_camera"] = json_matrix(picture.solved.target_camera.transform.R, 3, 3);
        row["t_grid_camera_m"] = json_vector(picture.solved.target_camera.transform.t_m, 3);
        row["covariance"] = json_matrix(picture.solved.target_camera.covariance, 6, 6);
    }
    return row;
}

void add_lens(Json &row, const opms_calib_result_t &calib)
{
    const opms_lens_t &lens = calib.lens;
    row["width_px"] = lens.width_px;
    row["height_px"] = lens.height_px;
    row["lens"] = {{"fx_px", lens.fx_px}, {"fy_px", lens.fy_px}, {"cx_px", lens.cx_px},
                   {"cy_px", lens.cy_px}, {"k1", lens.k1},       {"k2", lens.k2},
                   {"p1", lens.p1},       {"p2", lens.p2}};
    row["covariance_intrinsics"] = json_matrix(calib.covariance, 8, 8);
    row["residual_rms_px"] = calib.residual_rms_px;
    row["chi2_dof"] = calib.chi2_dof;
    row["coverage"] = calib.coverage;
    row["pictures_used"] = calib.pictures_used;
    row["points_used"] = calib.points_used;
    row["outliers"] = calib.outliers;
    Json warnings = Json::array();
    for (const CalibrateWarning &warning : calibrate_warnings(calib.warnings)) {
        warnings.push_back({{"name", warning.name}, {"advice", warning.advice}});
    }
    row["warnings"] = warnings;
}

void add_mounting(Json &row, const CalibrateResult &result)
{
    const opms_camera_t &camera = result.camera;
    row["R_detector_camera"] = json_matrix(camera.detector_camera.R, 3, 3);
    row["t_detector_camera_m"] = json_vector(camera.detector_camera.t_m, 3);
    row["covariance_detector_camera"] = json_matrix(camera.covariance_detector_camera, 6, 6);
    Json footprints = Json::array();
    for (const FootprintPlace &place : result.footprints) {
        footprints.push_back({{"image", place.image},
                              {"x_m", place.x_m},
                              {"y_m", place.y_m},
                              {"yaw_rad", place.yaw_rad}});
    }
    row["footprints"] = footprints;
}

}  // namespace

std::string calibrate_json(const CalibrateResult &result, const std::string &out)
{
    Json row;
    row["schema"] = "opms.calibrate/1";
    row["state"] = state_name(result.state);
    if (!result.reason.empty()) {
        row["reason"] = result.reason;
    }
    if (!out.empty()) {
        row["out"] = out;
    }
    if (result.has_solution) {
        add_lens(row, result.calib);
        if (result.state == CalibrateState::calibrated) {
            add_mounting(row, result);
        }
    }
    row["pictures"] = Json::array();
    for (const CalibratePicture &picture : result.pictures) {
        row["pictures"].push_back(json_picture(picture, result.has_solution));
    }
    /* A file's name may be any bytes. */
    return row.dump(-1, ' ', false, Json::error_handler_t::replace);
}
