/* SPDX-License-Identifier: Apache-2.0 */
#include "catalogue_state.hpp"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <ctime>
#include <filesystem>

#include "scan_times.hpp"
#include "text_table.hpp"

using namespace opms_host;

namespace {

constexpr std::int64_t SECOND_NS = 1000000000, DAY_NS = 86400 * SECOND_NS;

std::string lower(std::string text)
{
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

bool holds(const std::string &text, const std::string &part)
{
    return lower(text).find(lower(part)) != std::string::npos;
}

}  // namespace

const char *catalogue_state(const ScanSummary &scan)
{
    if (scan.being_recorded) {
        return "recording";
    }
    if (scan.recovered) {
        return "recovered";
    }
    return scan.ended ? "whole" : "cut off";
}

std::string catalogue_name(const std::string &folder)
{
    const std::filesystem::path path = std::filesystem::path(folder).lexically_normal();
    return (path.has_filename() ? path : path.parent_path()).filename().string();
}

bool catalogue_fits(const ScanSummary &scan, const CatalogueSearch &search)
{
    const std::int64_t begun = scan.header.begun_wall_ns;
    return (search.name.empty() || holds(catalogue_name(scan.folder), search.name)) &&
           (!search.from_wall_ns || begun >= *search.from_wall_ns) &&
           (!search.to_wall_ns || begun < *search.to_wall_ns);
}

bool catalogue_has_text(ScanReader &scan, const std::string &text, std::string &error)
{
    const ScanHeader &header = scan.summary().header;
    for (const std::string *field : {&header.settings_json, &header.box_name, &header.source_name,
                                     &header.source_model, &header.camera_file_name}) {
        if (holds(*field, text)) {
            return true;
        }
    }
    bool found = false;
    const bool read = scan.each_event(
        [&](const EventRecord &event) {
            found = holds(event.text, text) || holds(event.code, text) ||
                    holds(event.data_json, text);
            return !found;
        },
        error);
    return read && found;
}

bool catalogue_parse_time(const std::string &text, std::int64_t &wall_ns, std::int64_t &length_ns)
{
    std::tm parts = {};
    const char *end = strptime(text.c_str(), "%Y-%m-%d", &parts);
    length_ns = DAY_NS;
    if (end && *end != '\0') {
        length_ns = SECOND_NS;
        end = strptime(text.c_str(), "%Y-%m-%dT%H:%M:%S", &parts);
        end = end && *end == 'Z' ? end + 1 : end;
    }
    if (!end || *end != '\0') {
        return false;
    }
    const std::tm given = parts;
    wall_ns = static_cast<std::int64_t>(timegm(&parts)) * SECOND_NS;
    return parts.tm_mday == given.tm_mday && parts.tm_mon == given.tm_mon; /* no 31 February */
}

nlohmann::ordered_json catalogue_row(const ScanSummary &scan)
{
    return {{"schema", "opms.catalogue/1"},
            {"name", catalogue_name(scan.folder)},
            {"folder", scan.folder},
            {"state", catalogue_state(scan)},
            {"begun", wall_time_text(scan.header.begun_wall_ns)},
            {"duration_s", scan.duration_s},
            {"mode", scan.header.mode},
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

std::string catalogue_heading(std::size_t name_width)
{
    return text_padded("scan", name_width) +
           "  begun (UTC)           state       length s     poses  timed  pictures      MB";
}

std::string catalogue_line(const ScanSummary &scan, std::size_t name_width)
{
    return text_padded(catalogue_name(scan.folder), name_width) +
           text_format("  %-20s  %-9s  %10.1f  %8llu  %5.0f%%  %7llu  %7.1f",
                       wall_time_text(scan.header.begun_wall_ns).c_str(), catalogue_state(scan),
                       scan.duration_s, static_cast<unsigned long long>(scan.poses),
                       scan.poses > 0 ? 100.0 * static_cast<double>(scan.poses_with_time) /
                                            static_cast<double>(scan.poses)
                                      : 0.0,
                       static_cast<unsigned long long>(scan.pictures),
                       static_cast<double>(scan.bytes) * 1e-6);
}

nlohmann::ordered_json catalogue_page_row(const ScanSummary &scan)
{
    using Json = nlohmann::ordered_json;
    const ScanHeader &header = scan.header;
    const auto parsed = [](const std::string &text) {
        const Json value = Json::parse(text, nullptr, false);
        return value.is_object() ? value : Json(nullptr);
    };
    Json row = catalogue_row(scan);
    row["schema"] = "opms.catalogue.show/1";
    row["box"] = header.has_box ? Json(header.box_name) : Json(nullptr);
    row["boot_id"] = header.boot_id;
    row["session_id"] = header.session_id;
    row["source"] = header.source_name;
    row["source_model"] = header.source_model;
    row["picture_px"] = {header.width_px, header.height_px};
    row["bar"] = header.bar;
    row["bar_tilt_deg"] = header.bar_tilt_rad * 57.29577951308232;
    row["camera_file"] = header.camera_file_name;
    row["versions"] = parsed(header.versions_json);
    row["settings"] = parsed(header.settings_json);
    row["ended"] = scan.ended ? Json(wall_time_text(scan.end.ended_wall_ns)) : Json(nullptr);
    row["end_reason"] = scan.ended ? Json(scan.end.reason) : Json(nullptr);
    if (scan.ended && scan.end.has_summary) {
        const opms_pair_summary_t &summary = scan.end.summary;
        row["pairing"] = {{"sums_hold", summary.sums_hold != 0}, {"text", summary.line}};
    }
    return row;
}

std::string catalogue_page(const ScanSummary &scan)
{
    const nlohmann::ordered_json row = catalogue_page_row(scan);
    std::string page;
    for (const auto &[key, value] : row.items()) {
        if (key != "schema") {
            page += (page.empty() ? "" : "\n") + text_padded(key, 16) + "  " +
                    (value.is_string() ? value.get<std::string>() : value.dump());
        }
    }
    return page;
}
