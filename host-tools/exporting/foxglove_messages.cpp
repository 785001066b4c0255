/* SPDX-License-Identifier: Apache-2.0 */
#include "foxglove_messages.hpp"

#include <cmath>

#include "base64_text.hpp"
#include "location_json.hpp"
#include "pose_values.hpp"

namespace opms_host {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t SECOND_NS = 1000000000;

Json timestamp(std::uint64_t t_ns)
{
    return {{"sec", t_ns / SECOND_NS}, {"nsec", t_ns % SECOND_NS}};
}

Json vector3(const double v[3])
{
    return {{"x", v[0]}, {"y", v[1]}, {"z", v[2]}};
}

Json rotation(const double R[9])
{
    const Quaternion q = quaternion_from_matrix(R);
    return {{"x", q.x}, {"y", q.y}, {"z", q.z}, {"w", q.w}};
}

/** LogLevel of Foxglove's schema. */
int level_of(Severity severity)
{
    switch (severity) {
    case Severity::info: return 2;
    case Severity::warning: return 3;
    case Severity::error: break;
    }
    return 4;
}

Json number_or_null(double value)
{
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

}  // namespace

std::string message_pose_in_frame(std::uint64_t t_ns, const char *frame,
                                  const opms_transform_t &pose)
{
    return json_line({{"timestamp", timestamp(t_ns)},
                      {"frame_id", frame},
                      {"pose",
                       {{"position", vector3(pose.t_m)}, {"orientation", rotation(pose.R)}}}});
}

std::string message_frame_transform(std::uint64_t t_ns, const char *parent, const char *child,
                                    const opms_transform_t &pose)
{
    return json_line({{"timestamp", timestamp(t_ns)},
                      {"parent_frame_id", parent},
                      {"child_frame_id", child},
                      {"translation", vector3(pose.t_m)},
                      {"rotation", rotation(pose.R)}});
}

std::string message_compressed_image(std::uint64_t t_ns, const std::string &png)
{
    return json_line({{"timestamp", timestamp(t_ns)},
                      {"frame_id", "camera"},
                      {"data", base64_text(png)},
                      {"format", "png"}});
}

std::string message_camera_calibration(std::uint64_t t_ns, const opms_lens_t &lens)
{
    const Json k = {lens.fx_px, 0, lens.cx_px, 0, lens.fy_px, lens.cy_px, 0, 0, 1};
    const Json p = {lens.fx_px, 0, lens.cx_px, 0, 0, lens.fy_px, lens.cy_px, 0, 0, 0, 1, 0};
    return json_line({{"timestamp", timestamp(t_ns)},
                      {"frame_id", "camera"},
                      {"width", lens.width_px},
                      {"height", lens.height_px},
                      {"distortion_model", "plumb_bob"},
                      {"D", {lens.k1, lens.k2, lens.p1, lens.p2, 0}},
                      {"K", k},
                      {"R", {1, 0, 0, 0, 1, 0, 0, 0, 1}},
                      {"P", p}});
}

std::string message_log(std::uint64_t t_ns, const EventRecord &event)
{
    return json_line({{"timestamp", timestamp(t_ns)},
                      {"level", level_of(event.severity)},
                      {"message", event.text},
                      {"name", event.code},
                      {"file", ""},
                      {"line", 0}});
}

std::string message_sensor(std::uint64_t t_ns, const SensorRecord &sample)
{
    Json values = Json::array();
    for (const double value : sample.values) {
        values.push_back(number_or_null(value));
    }
    const Json data = sample.data_json.empty() ? Json(nullptr)
                                               : Json::parse(sample.data_json, nullptr, false);
    return json_line(
        {{"schema", "opms.sensor/1"},
         {"timestamp", timestamp(t_ns)},
         {"sensor", sample.sensor},
         {"number", sample.number},
         {"t_scan_s",
          sample.has_time ? Json(static_cast<double>(sample.t_scan_ns) * 1e-9) : Json(nullptr)},
         {"t_bound_s",
          sample.t_bound_ns > 0 ? Json(static_cast<double>(sample.t_bound_ns) * 1e-9)
                                : Json(nullptr)},
         {"values", values},
         {"data", data.is_object() ? data : Json(nullptr)}});
}

}  // namespace opms_host
