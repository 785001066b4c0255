/* SPDX-License-Identifier: Apache-2.0 */
#include "camera_show.hpp"
#include "json_values.hpp"

namespace {

using Json = nlohmann::ordered_json;

void add_camera(Json &row, const opms_camera_t &camera)
{
    const opms_lens_t &lens = camera.lens;
    const CameraView view = camera_view(lens);
    row["width_px"] = lens.width_px;
    row["height_px"] = lens.height_px;
    row["lens"] = json_lens(lens);
    row["view_deg"] = {view.across_deg, view.down_deg, view.diagonal_deg};
    if (camera.has_covariance_intrinsics) {
        row["covariance_intrinsics"] = json_matrix(camera.covariance_intrinsics, 8, 8);
    }
    if (camera.has_detector_camera) {
        row["R_detector_camera"] = json_matrix(camera.detector_camera.R, 3, 3);
        row["t_detector_camera_m"] = json_vector(camera.detector_camera.t_m, 3);
    }
    if (camera.has_covariance_detector_camera) {
        row["covariance_detector_camera"] = json_matrix(camera.covariance_detector_camera, 6, 6);
    }
    if (camera.has_covariance_detector_camera_intrinsics) {
        row["covariance_detector_camera_intrinsics"] =
            json_matrix(camera.covariance_detector_camera_intrinsics, 6, 8);
    }
}

void add_history(Json &row, const opms_host::CameraFile &file)
{
    if (file.grid) {
        row["grid"] = *file.grid;
    }
    if (file.date) {
        row["date"] = *file.date;
    }
    if (file.residual_rms_px) {
        row["residual_rms_px"] = *file.residual_rms_px;
    }
    if (file.footprint) {
        row["footprint"] = {{"x_m", file.footprint->x_m},
                            {"y_m", file.footprint->y_m},
                            {"yaw_rad", file.footprint->yaw_rad}};
    }
}

}  // namespace

std::string camera_show_json(const std::string &path, const opms_host::CameraFile &file)
{
    Json row = {{"schema", "opms.camera/1"},
                {"file", path},
                {"format", camera_format_name(file.format)},
                {"name", file.name}};
    add_camera(row, file.camera);
    add_history(row, file);
    row["also"] = Json::array();
    for (const opms_host::CameraExtra &extra : file.extras) {
        row["also"].push_back(extra.name);
    }
    for (const opms_host::CameraExtra &extra : file.opms_extras) {
        row["also"].push_back("opms." + extra.name);
    }
    row["missing"] = Json::array();
    for (const CameraGap &gap : camera_gaps(file.camera)) {
        row["missing"].push_back({{"key", gap.key}, {"meaning", gap.meaning}});
    }
    /* A file's name may be any bytes. */
    return row.dump(-1, ' ', false, Json::error_handler_t::replace);
}
