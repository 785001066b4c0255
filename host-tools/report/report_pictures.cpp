/* SPDX-License-Identifier: Apache-2.0 */
#include <algorithm>
#include <cmath>

#include "report_parts.hpp"
#include "svg_canvas.hpp"

namespace {

constexpr double BAR_WIDTH = 150, BAR_HEIGHT = 12;

std::string picture_at(std::size_t i)
{
    return "/pictures/" + std::to_string(i);
}

bool is_used(const ReportJson &report, std::size_t i)
{
    return report_has(report, picture_at(i) + "/residual_rms_px");
}

double worst_residual(const ReportJson &report, std::size_t count)
{
    double worst = 0;
    for (std::size_t i = 0; i < count; i++) {
        if (is_used(report, i)) {
            worst = std::max(worst, report_value(report, picture_at(i) + "/residual_rms_px"));
        }
    }
    return worst;
}

std::string bar(double part)
{
    SvgCanvas canvas(BAR_WIDTH, BAR_HEIGHT, "residual beside those of the other pictures");
    canvas.rect({0, 0}, BAR_WIDTH, BAR_HEIGHT, "bar-back");
    canvas.rect({0, 0}, BAR_WIDTH * std::clamp(part, 0.0, 1.0), BAR_HEIGHT, "bar");
    return canvas.finish();
}

std::string remark(const ReportJson &report, std::size_t i)
{
    std::string text;
    const std::string from = html_words(report, picture_at(i) + "/labelled_from");
    if (!from.empty()) {
        text = "marker hidden, labelled from " + from;
    }
    const ReportJson::json_pointer list("/footprints");
    const std::size_t count = report.contains(list) ? report.at(list).size() : 0;
    for (std::size_t k = 0; k < count; k++) {
        if (html_words(report, "/footprints/" + std::to_string(k) + "/image") ==
            html_words(report, picture_at(i) + "/image")) {
            text = "on the footprint" + (text.empty() ? text : "; " + text);
        }
    }
    return text;
}

std::string used_row(const ReportJson &report, std::size_t i, double worst)
{
    const std::string at = picture_at(i);
    return "<tr><td>" + html_traced(report, at + "/number", 0) + "</td><td class=\"w\">" +
           html_words(report, at + "/image") + "</td><td>" +
           html_traced(report, at + "/node_count", 0) + "</td><td>" +
           html_traced(report, at + "/outliers", 0) + "</td><td>" +
           html_traced(report, at + "/residual_rms_px", 4) + "</td><td class=\"w\">" +
           bar(report_value(report, at + "/residual_rms_px") / worst) + "</td><td>" +
           html_traced(report, at + "/tilt_deg", 1) + "</td><td>" +
           html_traced(report, at + "/t_grid_camera_m/2", 0, 1e3) + "</td><td>" +
           html_traced(report, at + "/gain", 2) + "</td><td class=\"w\">" + remark(report, i) +
           "</td></tr>\n";
}

std::string used_table(const ReportJson &report, std::size_t count)
{
    const double worst = worst_residual(report, count);
    std::string rows;
    for (std::size_t i = 0; i < count; i++) {
        rows += is_used(report, i) ? used_row(report, i, worst) : std::string();
    }
    if (rows.empty()) {
        return rows;
    }
    return "<table>\n<tr><th>no.</th><th class=\"w\">picture</th><th>nodes</th><th>outliers</th>"
           "<th>residual,<br>px RMS</th><th class=\"w\"></th><th>grid tilted,<br>\xc2\xb0</th>"
           "<th>camera over<br>the grid, mm</th><th>worth</th><th class=\"w\"></th></tr>\n" +
           rows +
           "</table>\n<p class=\"note\">Outliers: nodes that do not agree with the solution. "
           "Worth: how much of the lens would be unknown without this picture; the lens has 8 "
           "figures.</p>\n";
}

std::string left_out_table(const ReportJson &report, std::size_t count)
{
    std::string rows;
    for (std::size_t i = 0; i < count; i++) {
        const std::string at = picture_at(i);
        const std::string why = html_words(report, at + "/left_out");
        if (!why.empty()) {
            rows += "<tr><td>" + html_traced(report, at + "/number", 0) + "</td><td class=\"w\">" +
                    html_words(report, at + "/image") + "</td><td class=\"w\">" + why +
                    "</td></tr>\n";
        }
    }
    return rows.empty() ? "<p>No picture was left out.</p>\n"
                        : "<h3>Pictures left out</h3>\n<table>\n<tr><th>no.</th>"
                          "<th class=\"w\">picture</th><th class=\"w\">why</th></tr>\n" +
                              rows + "</table>\n";
}

}  // namespace

std::string report_pictures(const ReportJson &report)
{
    const std::size_t count = report_has(report, "/pictures") ? report.at("pictures").size() : 0;
    return html_section("The pictures", used_table(report, count) + left_out_table(report, count));
}
