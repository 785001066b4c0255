/* SPDX-License-Identifier: Apache-2.0 */
#include "location_json.hpp"

#include "json_values.hpp"

namespace {

using Json = nlohmann::ordered_json;

Json json_includes(uint32_t bits)
{
    Json names = Json::array();
    if (bits & OPMS_COVARIANCE_IMAGE) {
        names.push_back("image");
    }
    if (bits & OPMS_COVARIANCE_INTRINSICS) {
        names.push_back("intrinsics");
    }
    if (bits & OPMS_COVARIANCE_DETECTOR_CAMERA) {
        names.push_back("detector_camera");
    }
    return names;
}

}  // namespace

const char *json_bar_state(opms_bar_state_t state)
{
    switch (state) {
    case OPMS_BAR_LOCATED: return "located";
    case OPMS_BAR_AMBIGUOUS: return "ambiguous";
    case OPMS_BAR_ABSENT: break;
    }
    return "absent";
}

Json json_squares(const opms_square_t *squares, std::size_t count)
{
    Json list = Json::array();
    for (std::size_t i = 0; i < count; i++) {
        list.push_back({{"index", squares[i].index},
                        {"corners_px", json_matrix(&squares[i].corners_px[0][0], 4, 2)}});
    }
    return list;
}

void json_add_pose(Json &row, const opms_location_t &location)
{
    const opms_pose_t &bar_camera = location.pose.bar_camera;
    row["R_bar_camera"] = json_matrix(bar_camera.transform.R, 3, 3);
    row["t_bar_camera_m"] = json_vector(bar_camera.transform.t_m, 3);
    row["covariance"] = json_matrix(bar_camera.covariance, 6, 6);
    if (location.has_ground_detector) {
        const opms_pose_t &detector = location.ground_detector;
        row["R_ground_detector"] = json_matrix(detector.transform.R, 3, 3);
        row["t_ground_detector_m"] = json_vector(detector.transform.t_m, 3);
        row["covariance_ground_detector"] = json_matrix(detector.covariance, 6, 6);
        row["covariance_includes"] = json_includes(location.covariance_includes);
    }
    row["edge_shift_px"] = location.pose.edge_shift_px;
    row["residual_px"] = location.pose.residual_px;
}

std::string json_line(const Json &row)
{
    return row.dump(-1, ' ', false, Json::error_handler_t::replace);
}
