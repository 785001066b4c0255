/* SPDX-License-Identifier: Apache-2.0 */
/* The figures of the camera file with their uncertainty, those of the original system beside the
 * new ones, and what was asked for. */
#include "report_parts.hpp"

namespace {

struct LensRow {
    const char *key, *name, *unit, *meaning;
    int digits;
};

constexpr LensRow LENS_ROWS[] = {
    {"fx_px", "fx", "px", "focal length across", 3},
    {"fy_px", "fy", "px", "focal length down", 3},
    {"cx_px", "cx", "px", "principal point, column (0 is the middle of the first pixel)", 3},
    {"cy_px", "cy", "px", "principal point, row", 3},
    {"k1", "k1", "", "radial distortion, second order", 6},
    {"k2", "k2", "", "radial distortion, fourth order", 6},
    {"p1", "p1", "", "tangential distortion", 6},
    {"p2", "p2", "", "tangential distortion", 6},
};

std::string lens_table(const ReportJson &report)
{
    std::string rows;
    for (const LensRow &row : LENS_ROWS) {
        rows += std::string("<tr><td class=\"w\">") + row.name + "</td><td>" +
                html_traced(report, std::string("/lens/") + row.key, row.digits) + "</td><td>" +
                html_traced(report, std::string("/lens_sigma/") + row.key, row.digits) +
                "</td><td class=\"w\">" + row.unit + "</td><td class=\"w\">" + row.meaning +
                "</td></tr>\n";
    }
    return "<table>\n<tr><th class=\"w\"></th><th>value</th><th>sigma</th><th class=\"w\"></th>"
           "<th class=\"w\">meaning</th></tr>\n" +
           rows + "</table>\n";
}

std::string three(const ReportJson &report, const std::string &pointer, int digits, double factor)
{
    std::string cells;
    for (int i = 0; i < 3; i++) {
        cells += "<td>" +
                 html_traced(report, pointer + "/" + std::to_string(i), digits, factor) + "</td>";
    }
    return cells;
}

/* Row i of the picture's axes: column i of the rotation. */
std::string axis_row(const ReportJson &report, int axis, const char *name)
{
    std::string cells;
    for (int i = 0; i < 3; i++) {
        cells += "<td>" +
                 html_traced(report, "/R_detector_camera/" + std::to_string(i) + "/" +
                                         std::to_string(axis), 5) +
                 "</td>";
    }
    return std::string("<tr><td class=\"w\">") + name + "</td>" + cells + "<td>" +
           html_traced(report, "/mounting_sigma/rotation_deg/" + std::to_string(axis), 4) +
           "</td></tr>\n";
}

std::string footprint_rows(const ReportJson &report)
{
    std::string rows;
    for (std::size_t i = 0; i < report.at("footprints").size(); i++) {
        const std::string at = "/footprints/" + std::to_string(i);
        rows += "<tr><td class=\"w\">" + html_words(report, at + "/image") + "</td><td>" +
                html_traced(report, at + "/x_m", 1, 1e3) + "</td><td>" +
                html_traced(report, at + "/y_m", 1, 1e3) + "</td><td>" +
                html_traced(report, at + "/yaw_rad", 2, 57.29577951308232) + "</td></tr>\n";
    }
    return rows;
}

std::string mounting(const ReportJson &report)
{
    if (!report_has(report, "/R_detector_camera")) {
        return std::string();
    }
    return "<h3>The camera on the detector</h3>\n<table>\n<tr><th class=\"w\"></th><th>X, towards "
           "the operator</th><th>Y, right</th><th>Z, up</th><th>turned about it,<br>sigma "
           "\xc2\xb0</th></tr>\n<tr><td class=\"w\">place, mm</td>" +
           three(report, "/t_detector_camera_m", 2, 1e3) +
           "<td></td></tr>\n<tr><td class=\"w\">sigma, mm</td>" +
           three(report, "/mounting_sigma/place_mm", 3, 1) + "<td></td></tr>\n" +
           axis_row(report, 0, "picture\xe2\x80\x99s right points to") +
           axis_row(report, 1, "picture\xe2\x80\x99s down points to") +
           axis_row(report, 2, "the camera looks along") +
           "</table>\n<h3>Footprint</h3>\n<table>\n<tr><th class=\"w\">picture</th><th>X, mm</th>"
           "<th>Y, mm</th><th>turned, \xc2\xb0</th></tr>\n" +
           footprint_rows(report) + "</table>\n<p class=\"note\">Placed with standard deviations "
           "of " + html_traced(report, "/options/footprint_sigma/place_mm", 2) + " mm and " +
           html_traced(report, "/options/footprint_sigma/turn_deg", 2) + " \xc2\xb0.</p>\n";
}

std::string option_rows(const ReportJson &options, const std::string &prefix)
{
    std::string rows;
    for (const auto &[key, value] : options.items()) {
        if (value.is_object()) {
            rows += option_rows(value, prefix + key + ", ");
            continue;
        }
        const std::string text =
            value.is_string() ? value.get<std::string>()
                              : value.dump(-1, ' ', false, ReportJson::error_handler_t::replace);
        rows += "<tr><td class=\"w\">" + html_escaped(prefix + key) +
                "</td><td class=\"w\">" + html_escaped(text) + "</td></tr>\n";
    }
    return rows;
}

}  // namespace

std::string report_lens(const ReportJson &report)
{
    if (!report_has(report, "/lens")) {
        return std::string();
    }
    return html_section("The camera\xe2\x80\x99s figures", lens_table(report) + mounting(report));
}

std::string report_original(const ReportJson &report)
{
    if (!report_has(report, "/original") || !report_has(report, "/lens")) {
        return std::string();
    }
    const bool has_expected = report_has(report, "/expected");
    const auto expected = [&](const char *pointer, int digits) {
        return has_expected ? html_traced(report, pointer, digits) : std::string("\xe2\x80\x93");
    };
    return html_section(
        "Beside the original system",
        "<table>\n<tr><th class=\"w\"></th><th>2001</th><th>this calibration</th></tr>\n"
        "<tr><td class=\"w\">residual of the nodes, mean length, px</td><td>" +
            html_traced(report, "/original/residual_mean_px", 3) + "</td><td>" +
            html_traced(report, "/residual_mean_px", 3) + "</td></tr>\n" +
            "<tr><td class=\"w\">position of the head, 3-D RMS, mm</td><td>" +
            html_traced(report, "/original/position_rms_mm", 2) + "</td><td>" +
            expected("/expected/parts/total/position_rms_mm", 2) + " (expected)</td></tr>\n" +
            "<tr><td class=\"w\">angles of the head, RMS, \xc2\xb0</td><td>" +
            html_traced(report, "/original/angle_rms_deg/0", 1) + " to " +
            html_traced(report, "/original/angle_rms_deg/1", 1) + "</td><td>" +
            expected("/expected/parts/total/rotation_rms_deg", 3) +
            " (expected, three axes together)</td></tr>\n</table>\n" +
            "<p class=\"note\">2001: what C. Beumier and Y. Yvinec measured with the HOPE "
            "project\xe2\x80\x99s positioning system in the field, " +
            html_traced(report, "/original/need_mm_per_axis", 0) +
            " mm an axis being what was needed. The new figures are what follows from this "
            "calibration and the noise stated above; grass over the bar, motion and shadow come on "
            "top.</p>\n");
}

std::string report_origin(const ReportJson &report)
{
    if (!report_has(report, "/options")) {
        return std::string();
    }
    return html_section("How this was made",
                        "<table>\n<tr><td class=\"w\">program</td><td class=\"w\">opms " +
                            html_words(report, "/program/version") + "</td></tr>\n" +
                            option_rows(report.at("options"), "") +
                            "</table>\n<p class=\"note\">All figures of this page, and the nodes "
                            "with their residuals, are in report.json beside it. Axes: X towards "
                            "the operator, Y to his right, Z up.</p>\n");
}
