/* SPDX-License-Identifier: Apache-2.0 */
#include "api_calls.hpp"

#include <opms/version.h>

#include "json_limits.hpp"
#include "picture_encode.hpp"
#include "scan_json.hpp"
#include "scan_summary_json.hpp"
#include "sensor_json.hpp"

namespace opms_host {

namespace {

using Json = nlohmann::ordered_json;

HttpResponse bad_query(const std::string &what)
{
    return http_error(400, "query", what);
}

/** A scan is given alone by {"name": ...}, all of it optional. */
bool read_scan_name(const nlohmann::json &body, std::string &name, std::string &error)
{
    if (body.is_null()) {
        return true;
    }
    if (!body.is_object()) {
        error = "an object is needed, as {\"name\":\"lane 3\"}";
        return false;
    }
    for (const auto &[key, value] : body.items()) {
        if (key != "name" || !value.is_string()) {
            error = key == "name" ? "\"name\" must be a text"
                                  : "there is no field \"" + key.substr(0, 40) + "\"";
            return false;
        }
        name = value.get<std::string>();
        error = scan_name_problem(name);
    }
    return error.empty();
}

}  // namespace

HttpResponse api_json(int status, const Json &json)
{
    HttpResponse response;
    response.status = status;
    response.body = json_text(json) + "\n";
    return response;
}

HttpResponse api_failure(const ControlError &error)
{
    switch (error.kind) {
    case ControlFailure::conflict: return http_error(409, "state", error.text);
    case ControlFailure::invalid: return http_error(422, "value", error.text);
    case ControlFailure::not_found: return http_error(404, "name", error.text);
    case ControlFailure::unavailable:
    case ControlFailure::none: break;
    }
    return http_error(503, "device", error.text);
}

HttpResponse api_version(const ApiCall &)
{
    return api_json(200, {{"schema", "opms.version/1"}, {"opms", opms_version()}, {"api", "v1"}});
}

HttpResponse api_state(const ApiCall &call)
{
    return api_json(200, status_json(call.context.control.status()));
}

HttpResponse api_pose(const ApiCall &call)
{
    const std::string *squares = call.target.field("squares");
    if (squares && *squares != "0" && *squares != "1") {
        return bad_query("squares is 0 or 1");
    }
    const std::shared_ptr<const PoseRecord> pose = call.context.newest_pose();
    if (!pose) {
        return http_error(404, "none-yet", "no picture has been looked at yet");
    }
    const bool detail = squares && *squares == "1";
    return api_json(200, pose_json(*pose, detail ? PoseDetail::squares : PoseDetail::pose));
}

HttpResponse api_picture(const ApiCall &call)
{
    const std::string *wanted = call.target.field("format");
    const std::string format = wanted ? *wanted : "png";
    if (format != "png" && format != "jpeg") {
        return bad_query("format is png or jpeg");
    }
    const FramePtr picture = call.context.control.newest_picture();
    if (!picture) {
        return http_error(404, "none-yet", "no picture has come yet");
    }
    HttpResponse response;
    response.content_type = "image/" + format;
    std::string error;
    if (!picture_encode(picture->image, format == "png", response.body, error)) {
        return http_error(503, "picture", error);
    }
    return response;
}

HttpResponse api_scan_start(const ApiCall &call)
{
    std::string name, scan, problem;
    if (!read_scan_name(call.body, name, problem)) {
        return http_error(422, "value", problem);
    }
    ControlError error;
    if (!call.context.control.start_scan(name, scan, error)) {
        return api_failure(error);
    }
    return api_json(201, {{"schema", "opms.started/1"}, {"scan", scan}});
}

HttpResponse api_scan_stop(const ApiCall &call)
{
    ScanEnd end;
    ControlError error;
    if (!call.context.control.stop_scan(end, error)) {
        return api_failure(error);
    }
    Json json = {{"schema", "opms.stopped/1"}};
    json.update(scan_end_json(end));
    return api_json(200, json);
}

HttpResponse api_press_start(const ApiCall &call)
{
    ControlError error;
    if (!call.context.control.press_start(error)) {
        return api_failure(error);
    }
    return api_json(202, {{"schema", "opms.pressed/1"}});
}

HttpResponse api_scans(const ApiCall &call)
{
    std::vector<ScanSummary> scans;
    std::vector<std::string> unreadable;
    ControlError error;
    if (!call.context.control.list(scans, unreadable, error)) {
        return api_failure(error);
    }
    Json rows = Json::array();
    for (const ScanSummary &scan : scans) {
        rows.push_back(scan_summary_json(scan));
    }
    return api_json(200, {{"schema", "opms.scans/1"}, {"scans", rows},
                          {"unreadable", unreadable}});
}

HttpResponse api_scan(const ApiCall &call)
{
    if (!scan_name_problem(call.name).empty()) {
        return http_error(404, "name", "there is no such scan");
    }
    ScanSummary scan;
    ControlError error;
    if (!call.context.control.find(call.name, scan, error)) {
        return api_failure(error);
    }
    return api_json(200, scan_summary_json(scan));
}

ControlError api_take_samples(const ApiContext &context, const nlohmann::json &json,
                              std::size_t &taken)
{
    ControlError error;
    std::vector<SensorSample> samples;
    taken = 0;
    if (!sensor_samples_from_json(json, samples, error.text)) {
        error.kind = ControlFailure::invalid;
        return error;
    }
    std::vector<SensorRecord> records;
    for (const SensorSample &sample : samples) {
        records.push_back(place_sample(sample, context.control.clock()));
    }
    context.control.add_samples(records, taken, error);
    return error;
}

HttpResponse api_samples(const ApiCall &call)
{
    std::size_t taken = 0;
    const ControlError error = api_take_samples(call.context, call.body, taken);
    if (error.kind != ControlFailure::none) {
        return api_failure(error);
    }
    return api_json(202, {{"schema", "opms.accepted/1"}, {"samples", taken}});
}

}  // namespace opms_host
