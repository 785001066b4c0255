/* SPDX-License-Identifier: Apache-2.0 */
#include "foxglove_schemas.hpp"

#include <nlohmann/json.hpp>

namespace opms_host {

namespace {

using Json = nlohmann::ordered_json;

Json of_type(const char *type)
{
    return {{"type", type}};
}

Json object(const Json &properties)
{
    return {{"type", "object"}, {"properties", properties}};
}

Json number_or_null()
{
    return {{"type", {"number", "null"}}};
}

Json numbers()
{
    return {{"type", "array"}, {"items", of_type("number")}};
}

Json numbers(int count)
{
    Json list = numbers();
    list["minItems"] = count;
    list["maxItems"] = count;
    return list;
}

Json matrix()
{
    return {{"type", "array"}, {"items", numbers()}};
}

Json count()
{
    return {{"type", "integer"}, {"minimum", 0}};
}

Json timestamp()
{
    return {{"title", "time"},
            {"type", "object"},
            {"properties",
             {{"sec", count()},
              {"nsec", {{"type", "integer"}, {"minimum", 0}, {"maximum", 999999999}}}}}};
}

Json vector3()
{
    return object({{"x", of_type("number")}, {"y", of_type("number")}, {"z", of_type("number")}});
}

Json quaternion()
{
    Json fields = vector3();
    fields["properties"]["w"] = of_type("number");
    return fields;
}

McapSchema schema(const std::string &name, const char *description, const Json &properties)
{
    Json whole = {{"title", name}, {"description", description}};
    whole.update(object(properties));
    return {name, whole.dump()};
}

}  // namespace

McapSchema schema_pose_in_frame()
{
    return schema("foxglove.PoseInFrame", "Pose of the detector",
                  {{"timestamp", timestamp()},
                   {"frame_id", of_type("string")},
                   {"pose", object({{"position", vector3()}, {"orientation", quaternion()}})}});
}

McapSchema schema_frame_transform()
{
    return schema("foxglove.FrameTransform", "Where one frame stands in another",
                  {{"timestamp", timestamp()},
                   {"parent_frame_id", of_type("string")},
                   {"child_frame_id", of_type("string")},
                   {"translation", vector3()},
                   {"rotation", quaternion()}});
}

McapSchema schema_compressed_image()
{
    return schema("foxglove.CompressedImage", "Picture of the camera",
                  {{"timestamp", timestamp()},
                   {"frame_id", of_type("string")},
                   {"data", {{"type", "string"}, {"contentEncoding", "base64"}}},
                   {"format", of_type("string")}});
}

McapSchema schema_camera_calibration()
{
    return schema("foxglove.CameraCalibration", "Lens of the camera",
                  {{"timestamp", timestamp()},
                   {"frame_id", of_type("string")},
                   {"width", count()},
                   {"height", count()},
                   {"distortion_model", of_type("string")},
                   {"D", numbers()},
                   {"K", numbers(9)},
                   {"R", numbers(9)},
                   {"P", numbers(12)}});
}

McapSchema schema_log()
{
    return schema("foxglove.Log", "Event of the scan",
                  {{"timestamp", timestamp()},
                   {"level", {{"type", "integer"}, {"minimum", 0}, {"maximum", 5}}},
                   {"message", of_type("string")},
                   {"name", of_type("string")},
                   {"file", of_type("string")},
                   {"line", count()}});
}

McapSchema schema_opms_pose()
{
    return schema("opms.pose/1", "What one picture gave",
                  {{"schema", of_type("string")},
                   {"picture", count()},
                   {"state", of_type("string")},
                   {"pair", of_type("string")},
                   {"trigger", {{"type", {"integer", "null"}}}},
                   {"t_scan_s", number_or_null()},
                   {"mid_exposure", of_type("boolean")},
                   {"t_host_s", number_or_null()},
                   {"R_bar_camera", matrix()},
                   {"t_bar_camera_m", numbers(3)},
                   {"covariance", matrix()},
                   {"R_ground_detector", matrix()},
                   {"t_ground_detector_m", numbers(3)},
                   {"covariance_ground_detector", matrix()},
                   {"edge_shift_px", of_type("number")},
                   {"residual_px", of_type("number")},
                   {"squares_located", count()}});
}

McapSchema schema_opms_sensor()
{
    return schema("opms.sensor/1", "Sample of another sensor",
                  {{"schema", of_type("string")},
                   {"timestamp", timestamp()},
                   {"sensor", of_type("string")},
                   {"number", count()},
                   {"t_scan_s", number_or_null()},
                   {"t_bound_s", number_or_null()},
                   {"values", {{"type", "array"}, {"items", number_or_null()}}},
                   {"data", {{"type", {"object", "null"}}}}});
}

}  // namespace opms_host
