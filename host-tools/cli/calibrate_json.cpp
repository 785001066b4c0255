/* SPDX-License-Identifier: Apache-2.0 */
#include <cmath>

#include "calibrate_text.hpp"
#include "json_values.hpp"

namespace {

using Json = nlohmann::ordered_json;

constexpr double DEG = 180 / 3.14159265358979323846, MM_PER_M = 1e3;

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
    row["lens"] = json_lens(lens);
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

Json json_variance(const PoseVariance &variance)
{
    Json position = Json::array(), rotation = Json::array();
    for (int i = 0; i < 3; i++) {
        position.push_back(MM_PER_M * std::sqrt(variance.position_m2[i]));
        rotation.push_back(DEG * std::sqrt(variance.rotation_rad2[i]));
    }
    return {{"position_mm", position},
            {"position_rms_mm", MM_PER_M * variance.position_rms_m()},
            {"rotation_deg", rotation},
            {"rotation_rms_deg", DEG * variance.rotation_rms_rad()}};
}

/** The sheet's height over a plane: a sum of terms in X / scale and Y / scale. */
Json json_cockle(const opms_calib_result_t &calib)
{
    Json terms = Json::array();
    int k = 0;
    for (int degree = 2; degree <= 4; degree++) {
        for (int y_power = 0; y_power <= degree; y_power++, k++) {
            terms.push_back({{"x_power", degree - y_power},
                             {"y_power", y_power},
                             {"height_mm", MM_PER_M * calib.cockle_m[k]}});
        }
    }
    return {{"peak_m", calib.cockle_peak_m}, {"scale_m", calib.cockle_scale_m}, {"terms", terms}};
}

Json json_next(const CalibrateAdvice &next, const std::string &words)
{
    Json row = {{"advice", words},
                {"towards", next.towards},
                {"tilt_deg", DEG * next.tilt_rad},
                {"distance_m", next.distance_m},
                {"node_count", next.nodes},
                {"gain", next.gain}};
    if (next.now_m && next.then_m) {
        row["position_mm_now"] = MM_PER_M * *next.now_m;
        row["position_mm_then"] = MM_PER_M * *next.then_m;
    }
    row["R_grid_camera"] = json_matrix(next.grid_camera.R, 3, 3);
    row["t_grid_camera_m"] = json_vector(next.grid_camera.t_m, 3);
    return row;
}

Json json_expected(const ExpectedError &expected)
{
    const ExpectedBox box = expected_working_volume();
    opms_expect_options_t light;
    opms_expect_options_init(&light);
    Json row = {{"volume",
                 {{"x_m", {box.low_m[0], box.high_m[0]}},
                  {"y_m", {box.low_m[1], box.high_m[1]}},
                  {"z_m", {box.low_m[2], box.high_m[2]}}}},
                {"light",
                 {{"contrast", light.contrast}, {"noise", light.noise},
                  {"blur_px", light.blur_px}}},
                {"places", expected.places},
                {"places_seen", expected.places_seen}};
    if (expected.places_seen > 0) {
        row["parts"] = {{"image", json_variance(expected.image)},
                        {"lens", json_variance(expected.lens)},
                        {"placing", json_variance(expected.placing)},
                        {"calibration", json_variance(expected.calibration())},
                        {"total", json_variance(expected.total())}};
    }
    return row;
}

}  // namespace

nlohmann::ordered_json calibrate_row(const CalibrateResult &result, const std::string &out)
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
        if (result.calib.cockle_scale_m > 0) {
            row["cockle"] = json_cockle(result.calib);
        }
        if (result.state == CalibrateState::calibrated) {
            add_mounting(row, result);
            row["expected"] = json_expected(*result.expected);
        }
    }
    if (result.next) {
        row["next"] = json_next(*result.next, result.next_words);
    }
    row["pictures"] = Json::array();
    for (const CalibratePicture &picture : result.pictures) {
        row["pictures"].push_back(json_picture(picture, result.has_solution));
    }
    return row;
}

std::string calibrate_json(const CalibrateResult &result, const std::string &out)
{
    /* A file's name may be any bytes. */
    return calibrate_row(result, out).dump(-1, ' ', false, Json::error_handler_t::replace);
}
