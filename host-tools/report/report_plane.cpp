/* SPDX-License-Identifier: Apache-2.0 */
/* Which parts of the picture held nodes, what the lens does there, and how flat the sheet is. */
#include <algorithm>
#include <cmath>

#include "report_parts.hpp"
#include "svg_canvas.hpp"
#include "svg_colours.hpp"

namespace {

constexpr double WIDTH = 540, SHEET_SCALE = 0.42; /* drawing units a millimetre */
constexpr double HALF_X_M = 0.4, HALF_Y_M = 0.55, CELL_M = 0.05;
constexpr double LEFT = 44, FOOT = 34;
constexpr double FLAT_MM = 0.5; /* less from end to end is shown as nearly one colour */

std::string coverage(const ReportJson &report)
{
    const ReportJson::json_pointer list("/coverage_cells");
    if (!report.contains(list)) {
        return std::string();
    }
    const ReportJson &cells = report.at(list);
    const double height = WIDTH * report_value(report, "/height_px") /
                          report_value(report, "/width_px");
    double most = 1;
    for (const ReportJson &row : cells) {
        for (const ReportJson &count : row) {
            most = std::max(most, count.get<double>());
        }
    }
    SvgCanvas canvas(WIDTH, height, "nodes in each part of the picture");
    for (std::size_t r = 0; r < cells.size(); r++) {
        const double h = height / static_cast<double>(cells.size());
        const double w = WIDTH / static_cast<double>(cells[r].size());
        for (std::size_t c = 0; c < cells[r].size(); c++) {
            const double count = cells[r][c].get<double>(), part = 0.75 * count / most;
            const SvgPoint at{w * static_cast<double>(c), h * static_cast<double>(r)};
            const SvgPoint middle{at.x + w / 2, at.y + h / 2 + 4};
            canvas.rect(at, w, h, count > 0 ? "cell" : "empty",
                        count > 0 ? svg_scale_colour(part) : std::string());
            canvas.text(middle, html_number(count, 0), SvgAnchor::middle,
                        svg_scale_is_dark(part) ? "light" : "");
        }
    }
    return html_figure(canvas.finish(),
                       "<b>Nodes in each part of the picture</b>, all pictures together: " +
                           html_traced(report, "/coverage", 0, 100) +
                           " % of the parts held nodes. Where there are none (dashed), the lens "
                           "is not measured.");
}

/** Height in mm at (x, y) in m: terms x^i y^j, 2 <= i + j <= 4, in the order of opms/calib.h. */
double cockle_mm(const ReportJson &cockle, double x_m, double y_m)
{
    const double scale = cockle.at("scale_m").get<double>();
    double height = 0;
    for (const ReportJson &term : cockle.at("terms")) {
        height += term.at("height_mm").get<double>() *
                  std::pow(x_m / scale, term.at("x_power").get<int>()) *
                  std::pow(y_m / scale, term.at("y_power").get<int>());
    }
    return height;
}

std::string cockle(const ReportJson &report)
{
    if (!report_has(report, "/cockle")) {
        return std::string();
    }
    const ReportJson &cockle = report.at("cockle");
    const int rows = static_cast<int>(std::lround(2 * HALF_X_M / CELL_M));
    const int columns = static_cast<int>(std::lround(2 * HALF_Y_M / CELL_M));
    const double size = 1e3 * CELL_M * SHEET_SCALE;
    const auto height_at = [&](int r, int c) {
        return cockle_mm(cockle, -HALF_X_M + CELL_M * (r + 0.5), -HALF_Y_M + CELL_M * (c + 0.5));
    };
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (int i = 0; i < rows * columns; i++) {
        low = std::min(low, height_at(i / columns, i % columns));
        high = std::max(high, height_at(i / columns, i % columns));
    }
    SvgCanvas canvas(LEFT + columns * size + 4, rows * size + FOOT, "height of the sheet");
    for (int i = 0; i < rows * columns; i++) {
        const int r = i / columns, c = i % columns;
        const double part = 0.75 * (height_at(r, c) - low) / std::max(FLAT_MM, high - low);
        const SvgPoint at{LEFT + c * size, r * size};
        canvas.rect(at, size, size, "cell", svg_scale_colour(part));
        if (r % 2 == 1 && c % 2 == 1) {
            canvas.text({at.x + size / 2, at.y + size / 2 + 4}, html_number(height_at(r, c), 2),
                        SvgAnchor::middle, svg_scale_is_dark(part) ? "light" : "");
        }
    }
    canvas.text({LEFT, rows * size + 16}, "Y from -550 to 550 mm, to the right");
    canvas.text({4, rows * size / 2}, "X");
    return html_figure(canvas.finish(),
                       "<b>Height of the sheet over a plane</b>, mm, seen from the operator: " +
                           html_traced(report, "/cockle/peak_m", 2, 1e3) +
                           " mm from the lowest to the highest node.");
}

}  // namespace

std::string report_plane(const ReportJson &report)
{
    const std::string body = coverage(report) + report_distortion(report) + cockle(report);
    return body.empty() ? body
                        : html_section("Picture and sheet",
                                       "<div class=\"row\">\n" + body + "</div>\n");
}
