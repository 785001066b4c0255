/* SPDX-License-Identifier: Apache-2.0 */
/* What the user of a position cares for: how far off it will be, where, and why. */
#include <algorithm>
#include <cmath>

#include "report_parts.hpp"
#include "svg_canvas.hpp"
#include "svg_colours.hpp"

namespace {

constexpr double CELL_WIDTH = 50, CELL_HEIGHT = 34, LEFT = 62, TOP = 44, BOTTOM = 30;
constexpr double RANGE_LEAST = 0.3; /* of the largest figure, from palest to darkest */

struct Part {
    const char *key, *title;
    bool sum;
};

constexpr Part PARTS[] = {
    {"image", "noise of the picture of the bar", false},
    {"lens", "lens, with the camera\xe2\x80\x99s place as it follows from it", false},
    {"placing", "placing of the head on the footprint", false},
    {"calibration", "calibration: lens and placing", true},
    {"total", "all together", true},
};

std::string part_row(const ReportJson &report, const Part &part)
{
    const std::string at = std::string("/expected/parts/") + part.key;
    std::string row = std::string("<tr") + (part.sum ? " class=\"sum\"" : "") +
                      "><td class=\"w\">" + part.title + "</td>";
    for (int axis = 0; axis < 3; axis++) {
        row += "<td>" + html_traced(report, at + "/position_mm/" + std::to_string(axis), 3) +
               "</td>";
    }
    return row + "<td>" + html_traced(report, at + "/position_rms_mm", 3) + "</td><td>" +
           html_traced(report, at + "/rotation_rms_deg", 4) + "</td></tr>\n";
}

std::string parts_table(const ReportJson &report)
{
    std::string rows;
    for (const Part &part : PARTS) {
        rows += part_row(report, part);
    }
    return "<table>\n<tr><th class=\"w\">standard deviation from</th><th>X, mm</th><th>Y, mm</th>"
           "<th>height Z, mm</th><th>3-D, mm</th><th>direction, \xc2\xb0</th></tr>\n" +
           rows + "</table>\n";
}

std::string heights_table(const ReportJson &report)
{
    const ReportJson::json_pointer list("/expected/heights");
    if (!report.contains(list)) {
        return std::string();
    }
    std::string rows;
    for (std::size_t i = 0; i < report.at(list).size(); i++) {
        const std::string at = "/expected/heights/" + std::to_string(i);
        rows += "<tr><td>" + html_traced(report, at + "/head_z_m", 1, 1e3) + "</td><td>" +
                html_traced(report, at + "/bar_tilt_deg", 1) + "</td><td>" +
                html_traced(report, at + "/image_mm", 3) + "</td><td>" +
                html_traced(report, at + "/calibration_mm", 3) + "</td><td>" +
                html_traced(report, at + "/total_mm", 3) + "</td><td>" +
                html_traced(report, at + "/total_deg", 4) + "</td></tr>\n";
    }
    return "<h3>By height of the head and tilt of the bar</h3>\n<table>\n<tr><th>height, mm</th>"
           "<th>bar tilted, \xc2\xb0</th><th>noise, 3-D mm</th><th>calibration, 3-D mm</th>"
           "<th>all, 3-D mm</th><th>direction, \xc2\xb0</th></tr>\n" +
           rows + "</table>\n";
}

double largest(const ReportJson &rows)
{
    double most = 0;
    for (const ReportJson &row : rows) {
        for (const ReportJson &value : row) {
            most = value.is_number() ? std::max(most, value.get<double>()) : most;
        }
    }
    return most;
}

double smallest(const ReportJson &rows)
{
    double least = HUGE_VAL;
    for (const ReportJson &row : rows) {
        for (const ReportJson &value : row) {
            least = value.is_number() ? std::min(least, value.get<double>()) : least;
        }
    }
    return least;
}

void draw_cells(SvgCanvas &canvas, const ReportJson &rows)
{
    // Colours that differ stand for figures that do.
    const double least = smallest(rows);
    const double range = std::max(RANGE_LEAST * largest(rows), largest(rows) - least);
    for (std::size_t r = 0; r < rows.size(); r++) {
        for (std::size_t c = 0; c < rows[r].size(); c++) {
            const SvgPoint at{LEFT + CELL_WIDTH * static_cast<double>(c),
                              TOP + CELL_HEIGHT * static_cast<double>(r)};
            const SvgPoint middle{at.x + CELL_WIDTH / 2, at.y + CELL_HEIGHT / 2 + 4};
            if (!rows[r][c].is_number()) {
                canvas.rect(at, CELL_WIDTH, CELL_HEIGHT, "empty");
                canvas.text(middle, "no bar", SvgAnchor::middle, "quiet");
                continue;
            }
            const double value = rows[r][c].get<double>();
            const double part = 0.75 * (value - least) / range;
            canvas.rect(at, CELL_WIDTH, CELL_HEIGHT, "cell", svg_scale_colour(part));
            canvas.text(middle, html_number(value, value < 9.995 ? 2 : 1), SvgAnchor::middle,
                        svg_scale_is_dark(part) ? "light" : "");
        }
    }
}

/* As the operator sees it: Y to the right, the bar at the far side, X towards him. */
std::string map_of(const ReportJson &map, const char *key, const std::string &caption)
{
    const ReportJson &x = map.at("x_m"), &y = map.at("y_m"), &rows = map.at(key);
    const double width = LEFT + CELL_WIDTH * static_cast<double>(y.size()) + 8;
    const double bottom = TOP + CELL_HEIGHT * static_cast<double>(x.size());
    SvgCanvas canvas(width, bottom + BOTTOM, "expected position error over the working volume");
    canvas.rect({LEFT, TOP - 22}, width - LEFT - 8, 8, "marker");
    canvas.text({LEFT, TOP - 28}, "the bar", SvgAnchor::start, "strong");
    draw_cells(canvas, rows);
    for (std::size_t r = 0; r < x.size(); r++) {
        canvas.text({LEFT - 6, TOP + CELL_HEIGHT * (static_cast<double>(r) + 0.5) + 4},
                    "X " + html_number(1e3 * x[r].get<double>(), 0), SvgAnchor::end);
    }
    for (std::size_t c = 0; c < y.size(); c++) {
        canvas.text({LEFT + CELL_WIDTH * (static_cast<double>(c) + 0.5), bottom + 16},
                    html_number(1e3 * y[c].get<double>(), 0), SvgAnchor::middle);
    }
    canvas.text({LEFT - 6, bottom + 16}, "Y, mm", SvgAnchor::end);
    return html_figure(canvas.finish(), caption);
}

std::string maps(const ReportJson &report)
{
    if (!report_has(report, "/expected/map")) {
        return std::string();
    }
    const ReportJson &map = report.at("expected").at("map");
    const std::string where = " 3-D standard deviation in mm, head level, " +
                              html_traced(report, "/expected/map/head_z_m", 1, 1e3) +
                              " mm above the ground.";
    return "<div class=\"row\">\n" +
           map_of(map, "unplaced_mm",
                  "<b>Lens and noise</b>, had the head been laid exactly on its footprint." +
                      where) +
           map_of(map, "total_mm", "<b>All together.</b>" + where) + "</div>\n";
}

}  // namespace

std::string report_expected(const ReportJson &report)
{
    if (!report_has(report, "/expected")) {
        return std::string();
    }
    const std::string light =
        "<p class=\"note\">Over the working volume: head at X " +
        html_traced(report, "/expected/volume/x_m/0", 2) + " to " +
        html_traced(report, "/expected/volume/x_m/1", 2) + " m, Y " +
        html_traced(report, "/expected/volume/y_m/0", 1) + " to " +
        html_traced(report, "/expected/volume/y_m/1", 1) + " m, height " +
        html_traced(report, "/expected/volume/z_m/0", 0, 1e3) + " to " +
        html_traced(report, "/expected/volume/z_m/1", 0, 1e3) +
        " mm, level, over a flat bar in full view; the bar is seen from " +
        html_traced(report, "/expected/places_seen", 0) + " of " +
        html_traced(report, "/expected/places", 0) + " places. Contrast " +
        html_traced(report, "/expected/light/contrast", 0) + " and noise " +
        html_traced(report, "/expected/light/noise", 1) + " grey levels, blur " +
        html_traced(report, "/expected/light/blur_px", 2) + " px.</p>\n";
    return html_section("How exact positions will be",
                        parts_table(report) + light + maps(report) + heights_table(report));
}
