/* SPDX-License-Identifier: Apache-2.0 */
#include "scan_view.hpp"

#include "locate_row.hpp"
#include "location_json.hpp"
#include "scan_json.hpp"
#include "text_table.hpp"

namespace {

using namespace opms_host;

using ull = unsigned long long;

const char *there(bool connected)
{
    return connected ? "connected" : "NOT THERE";
}

std::string time_text(const PoseRecord &pose)
{
    if (!pose.has_time) {
        return "no certain time";
    }
    return text_format("%.3f s%s", static_cast<double>(pose.t_scan_ns) * 1e-9,
                       pose.is_mid_exposure ? "" : " (of the trigger)");
}

std::string position_text(const PoseRecord &pose)
{
    if (pose.location.state != OPMS_BAR_LOCATED) {
        return std::string("bar ") + json_bar_state(pose.location.state);
    }
    const PoseFigures f = pose_figures(pose.location);
    return text_format("%s %8.2f %8.2f %8.2f mm ± %.2f  psi %6.2f phi %6.2f theta %6.2f deg ± %.3f",
                       f.of_detector ? "head" : "camera", f.position_mm[0], f.position_mm[1],
                       f.position_mm[2], f.sigma_mm, f.angles_deg[0], f.angles_deg[1],
                       f.angles_deg[2], f.sigma_deg);
}

std::string light_text(const PoseRecord &pose)
{
    return text_format("white %.0f %%, %.1f %% saturated, %s, next %.2f ms %+.1f dB",
                       100 * pose.light.white, 100 * pose.light.saturated,
                       exposure_state_name(pose.exposure.state), pose.exposure.exposure_us * 1e-3,
                       pose.exposure.gain_db);
}

std::string blur_text(const PoseRecord &pose)
{
    return text_format("%s, %.2f px along the bar, %.2f px across", blur_verdict_name(pose.blur),
                       pose.blur_px[0], pose.blur_px[1]);
}

std::string pairing_text(const SessionStatus &status)
{
    const opms_pair_counters_t &n = status.pairing.counters;
    return text_format("%s: %llu triggers, %llu paired, %llu missing, %llu uncertain",
                       opms_pair_state_name(status.pairing.state), static_cast<ull>(n.triggers),
                       static_cast<ull>(n.triggers_paired), static_cast<ull>(n.triggers_missing),
                       static_cast<ull>(n.triggers_uncertain));
}

std::string latency_text(const SessionStatus &status)
{
    const LatencyFigures &f = status.located_after;
    return text_format("picture to pose %.1f ms (99 %%: %.1f), %llu too late", f.p50_ms, f.p99_ms,
                       static_cast<ull>(f.missed));
}

std::string recording_text(const SessionStatus &status)
{
    return text_format("%s, %llu pictures kept, %llu not kept",
                       recording_state_name(status.recording),
                       static_cast<ull>(status.pictures_stored),
                       static_cast<ull>(status.pictures_not_stored));
}

}  // namespace

std::string scan_state_text(SessionState state)
{
    switch (state) {
    case SessionState::ready: return "READY: give the hardware start";
    case SessionState::running: return "RUNNING";
    case SessionState::interrupted: return "INTERRUPTED: the run is over, see the events";
    default: return session_state_name(state);
    }
}

std::string scan_event_text(const EventRecord &event)
{
    return std::string(severity_name(event.severity)) + " " + event.code + ": " + event.text;
}

void ScanView::take(const EventRecord &event)
{
    events_.push_back(scan_event_text(event));
    if (events_.size() > EVENTS) {
        events_.pop_front();
    }
}

std::vector<std::string> ScanView::screen(const SessionStatus &status) const
{
    std::vector<std::string> lines;
    lines.push_back("scan      " + (status.scan.empty() ? "-" : status.scan) + "  " +
                    scan_state_text(status.state));
    lines.push_back(text_format("devices   box %s, camera %s", there(status.box_connected),
                                there(status.camera_connected)));
    if (pose_) {
        lines.push_back("position  " + position_text(*pose_));
        lines.push_back(text_format("picture   %llu at ", static_cast<ull>(pose_->number)) +
                        time_text(*pose_) +
                        text_format(", %u squares", pose_->location.bar.square_count));
        lines.push_back("light     " + light_text(*pose_));
        lines.push_back("blur      " + blur_text(*pose_));
    }
    lines.push_back(text_format("poses     %llu of %llu pictures, bar absent in %llu, not certain "
                                "in %llu",
                                static_cast<ull>(status.poses), static_cast<ull>(status.frames),
                                static_cast<ull>(status.absent),
                                static_cast<ull>(status.ambiguous)));
    lines.push_back("pairing   " + pairing_text(status));
    lines.push_back("speed     " + latency_text(status));
    lines.push_back("recording " + recording_text(status));
    lines.emplace_back("events");
    for (const std::string &event : events_) {
        lines.push_back("          " + event);
    }
    return lines;
}

std::string ScanView::line(const SessionStatus &status) const
{
    return scan_state_text(status.state) + (pose_ ? "  " + time_text(*pose_) : "") +
           (pose_ ? "  " + position_text(*pose_) : "") + "  " + pairing_text(status) + "  " +
           latency_text(status);
}
