/* SPDX-License-Identifier: Apache-2.0 */
#include "calibrate_check.hpp"
#include "json_values.hpp"

namespace {

using Json = nlohmann::ordered_json;

void add_lens(Json &row, const CheckResult &result)
{
    const opms_calib_lens_check_t &lens = result.lens;
    row["lens"] = {{"chi2", lens.chi2},
                   {"chi2_limit", OPMS_CALIB_CHI2_LENS},
                   {"residual_rms_px", lens.residual_rms_px},
                   {"residual_free_rms_px", lens.residual_free_rms_px},
                   {"noise_factor", lens.noise_factor},
                   {"change", json_vector(lens.change, 8)},
                   {"shows_focal", lens.shows_focal},
                   {"shows_centre_px", json_vector(lens.shows_centre_px, 2)},
                   {"covariance_assumed", result.lens_assumed}};
    row["pictures_used"] = lens.pictures_used;
    row["points_used"] = lens.points_used;
    row["outliers"] = lens.outliers;
    if (result.alone) {
        row["alone"] = {{"lens", json_lens(result.alone->lens)},
                        {"covariance_intrinsics", json_matrix(result.alone->covariance, 8, 8)},
                        {"residual_rms_px", result.alone->residual_rms_px}};
    }
}

Json json_mounting(const CheckMounting &mounting)
{
    const opms_calib_mounting_check_t &m = mounting.figures;
    return {{"image", mounting.image},
            {"chi2", m.chi2},
            {"chi2_limit", OPMS_CALIB_CHI2_MOUNTING},
            {"change", json_vector(m.change, 6)},
            {"covariance", json_matrix(m.covariance, 6, 6)},
            {"shows_turn_rad", json_vector(m.shows_turn_rad, 3)},
            {"shows_shift_m", json_vector(m.shows_shift_m, 3)},
            {"R_detector_camera", json_matrix(m.detector_camera.R, 3, 3)},
            {"t_detector_camera_m", json_vector(m.detector_camera.t_m, 3)}};
}

Json json_picture(const CalibratePicture &picture, bool has_lens)
{
    Json row = {{"image", picture.grid.image},
                {"state", picture.grid.state_name()},
                {"node_count", picture.grid.nodes.size()}};
    if (!picture.left_out.empty()) {
        row["left_out"] = picture.left_out;
    } else if (has_lens) {
        row["outliers"] = picture.solved.outliers;
        row["residual_rms_px"] = picture.solved.residual_rms_px;
    }
    return row;
}

}  // namespace

std::string check_json(const std::string &path, const opms_host::CameraFile &file,
                       const CheckResult &result)
{
    Json row = {{"schema", "opms.calibrate_check/1"},
                {"camera", path},
                {"verdict", check_verdict_name(result.verdict)},
                {"reason", result.reason}};
    if (!result.advice.empty()) {
        row["advice"] = result.advice;
    }
    if (file.residual_rms_px) {
        row["stated_residual_rms_px"] = *file.residual_rms_px;
    }
    if (result.has_lens) {
        add_lens(row, result);
        row["mountings"] = Json::array();
        for (const CheckMounting &mounting : result.mountings) {
            row["mountings"].push_back(json_mounting(mounting));
        }
    }
    row["pictures"] = Json::array();
    for (const CalibratePicture &picture : result.pictures) {
        row["pictures"].push_back(json_picture(picture, result.has_lens));
    }
    /* A file's name may be any bytes. */
    return row.dump(-1, ' ', false, Json::error_handler_t::replace);
}
