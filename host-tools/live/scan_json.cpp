/* SPDX-License-Identifier: Apache-2.0 */
#include "scan_json.hpp"

#include "json_values.hpp"
#include "location_json.hpp"

namespace opms_host {

namespace {

using Json = nlohmann::ordered_json;

Json seconds_or_null(bool known, std::int64_t ns)
{
    return known ? Json(static_cast<double>(ns) * 1e-9) : Json(nullptr);
}

Json light_json(const PoseRecord &pose)
{
    return {{"white", pose.light.white},
            {"black", pose.light.black},
            {"saturated", pose.light.saturated},
            {"state", exposure_state_name(pose.exposure.state)},
            {"next_exposure_us", pose.exposure.exposure_us},
            {"next_gain_db", pose.exposure.gain_db}};
}

Json latency_json(const LatencyFigures &figures)
{
    return {{"count", figures.count},   {"missed", figures.missed}, {"p50_ms", figures.p50_ms},
            {"p99_ms", figures.p99_ms}, {"p999_ms", figures.p999_ms}, {"most_ms", figures.most_ms}};
}

Json pairing_json(const opms_pair_summary_t &summary)
{
    const opms_pair_counters_t &n = summary.counters;
    return {{"state", opms_pair_state_name(summary.state)},
            {"sums_hold", summary.sums_hold != 0},
            {"triggers", n.triggers},
            {"triggers_paired", n.triggers_paired},
            {"triggers_missing", n.triggers_missing},
            {"triggers_uncertain", n.triggers_uncertain},
            {"triggers_pending", n.triggers_pending},
            {"frames", n.frames},
            {"frames_paired", n.frames_paired},
            {"frames_orphan", n.frames_orphan},
            {"frames_duplicate", n.frames_duplicate},
            {"frames_stale", n.frames_stale},
            {"frames_uncertain", n.frames_uncertain},
            {"frames_pending", n.frames_pending},
            {"text", summary.line}};
}

Json source_json(const SourceCounters &counters)
{
    return {{"delivered", counters.delivered}, {"damaged", counters.damaged},
            {"no_buffer", counters.no_buffer}, {"failed", counters.failed},
            {"buffers_lent", counters.lent},   {"buffers", counters.buffers}};
}

}  // namespace

Json pose_json(const PoseRecord &pose, PoseDetail detail)
{
    Json row = {{"schema", "opms.pose/1"},
                {"picture", pose.number},
                {"state", json_bar_state(pose.location.state)},
                {"pair", opms_frame_state_name(pose.frame_state)},
                {"trigger", pose.trigger_number > 0 ? Json(pose.trigger_number) : Json(nullptr)},
                {"t_scan_s", seconds_or_null(pose.has_time, pose.t_scan_ns)},
                {"mid_exposure", pose.is_mid_exposure},
                {"t_host_s", seconds_or_null(pose.t_host_ns != 0, pose.t_host_ns)}};
    if (pose.location.state == OPMS_BAR_LOCATED) {
        json_add_pose(row, pose.location);
    }
    row["squares_located"] = pose.location.bar.square_count;
    if (detail == PoseDetail::squares) {
        row["squares"] = json_squares(pose.squares.data(), pose.squares.size());
    }
    row["light"] = light_json(pose);
    row["blur"] = {{"verdict", blur_verdict_name(pose.blur)},
                   {"px", json_vector(pose.blur_px.data(), 2)}};
    row["latency_ms"] = {
        {"located", static_cast<double>(pose.located_host_ns - pose.arrival_host_ns) * 1e-6},
        {"published", static_cast<double>(pose.published_host_ns - pose.arrival_host_ns) * 1e-6}};
    return row;
}

Json event_json(const EventRecord &event)
{
    Json row = {{"schema", "opms.event/1"},
                {"t_host_s", static_cast<double>(event.t_host_ns) * 1e-9},
                {"severity", severity_name(event.severity)},
                {"code", event.code},
                {"text", event.text}};
    if (!event.data_json.empty()) {
        const Json data = Json::parse(event.data_json, nullptr, false);
        row["data"] = data.is_discarded() ? Json(event.data_json) : data;
    }
    return row;
}

Json status_json(const SessionStatus &status)
{
    return {{"schema", "opms.state/1"},
            {"state", session_state_name(status.state)},
            {"scan", status.scan.empty() ? Json(nullptr) : Json(status.scan)},
            {"box_connected", status.box_connected},
            {"camera_connected", status.camera_connected},
            {"frames", status.frames},
            {"located", status.located},
            {"ambiguous", status.ambiguous},
            {"absent", status.absent},
            {"poses", status.poses},
            {"queue_frames", status.queue_frames},
            {"display_dropped", status.display_dropped},
            {"recording",
             {{"state", recording_state_name(status.recording)},
              {"pictures_stored", status.pictures_stored},
              {"pictures_not_stored", status.pictures_not_stored}}},
            {"pairing", pairing_json(status.pairing)},
            {"latency",
             {{"located", latency_json(status.located_after)},
              {"published", latency_json(status.published_after)}}},
            {"source", source_json(status.source)},
            {"t_host_s", static_cast<double>(status.t_host_ns) * 1e-9}};
}

const char *blur_verdict_name(BlurVerdict verdict)
{
    switch (verdict) {
    case BlurVerdict::sharp: return "sharp";
    case BlurVerdict::focus: return "focus";
    case BlurVerdict::motion: return "motion";
    case BlurVerdict::aperture: return "aperture";
    case BlurVerdict::unknown: break;
    }
    return "unknown";
}

const char *severity_name(Severity severity)
{
    switch (severity) {
    case Severity::info: return "info";
    case Severity::warning: return "warning";
    case Severity::error: break;
    }
    return "error";
}

const char *recording_state_name(RecordingState state)
{
    switch (state) {
    case RecordingState::off: return "off";
    case RecordingState::on: return "on";
    case RecordingState::full: return "full";
    case RecordingState::failed: break;
    }
    return "failed";
}

const char *exposure_state_name(opms_exposure_state_t state)
{
    switch (state) {
    case OPMS_EXPOSURE_HOLDING: return "holding";
    case OPMS_EXPOSURE_MOVING: return "moving";
    case OPMS_EXPOSURE_TOO_DARK: return "too dark";
    case OPMS_EXPOSURE_TOO_BRIGHT: return "too bright";
    case OPMS_EXPOSURE_SEARCHING: break;
    }
    return "searching";
}

}  // namespace opms_host
