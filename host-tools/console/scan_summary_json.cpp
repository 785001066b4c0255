/* SPDX-License-Identifier: Apache-2.0 */
#include "scan_summary_json.hpp"

#include <cstdio>
#include <ctime>

namespace opms_host {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t SECOND_NS = 1000000000, MILLISECOND_NS = 1000000;

Json time_or_null(std::int64_t wall_ns)
{
    return wall_ns == 0 ? Json(nullptr) : Json(utc_text(wall_ns));
}

}  // namespace

std::string utc_text(std::int64_t wall_ns)
{
    const std::int64_t fraction_ns = (wall_ns % SECOND_NS + SECOND_NS) % SECOND_NS;
    const std::time_t seconds = static_cast<std::time_t>((wall_ns - fraction_ns) / SECOND_NS);
    std::tm parts = {};
    char date[40], text[64];
    if (!gmtime_r(&seconds, &parts) ||
        std::strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%S", &parts) == 0) {
        return "";
    }
    std::snprintf(text, sizeof text, "%s.%03dZ", date,
                  static_cast<int>(fraction_ns / MILLISECOND_NS));
    return text;
}

Json scan_end_json(const ScanEnd &end)
{
    Json json = {{"reason", end.reason}, {"ended", time_or_null(end.ended_wall_ns)}};
    if (end.has_summary) {
        json["pairing"] = {{"sums_hold", end.summary.sums_hold != 0},
                           {"triggers", end.summary.counters.triggers},
                           {"triggers_paired", end.summary.counters.triggers_paired},
                           {"frames", end.summary.counters.frames},
                           {"frames_paired", end.summary.counters.frames_paired},
                           {"text", end.summary.line}};
    }
    return json;
}

Json scan_summary_json(const ScanSummary &scan)
{
    return {{"schema", "opms.scan/1"},
            {"name", scan.name},
            {"begun", time_or_null(scan.header.begun_wall_ns)},
            {"mode", scan.header.mode},
            {"box", scan.header.box_name},
            {"source", scan.header.source_name},
            {"camera_file", scan.header.camera_file_name},
            {"ended", scan.ended ? scan_end_json(scan.end) : Json(nullptr)},
            {"duration_s", scan.duration_s},
            {"triggers", scan.triggers},
            {"frames", scan.frames},
            {"pairs", scan.pairs},
            {"poses", scan.poses},
            {"poses_with_time", scan.poses_with_time},
            {"pictures", scan.pictures},
            {"events", scan.events},
            {"sensor_samples", scan.sensor_samples},
            {"bytes", scan.bytes},
            {"schema_version", scan.schema_version}};
}

}  // namespace opms_host
