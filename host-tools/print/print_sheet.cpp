/* SPDX-License-Identifier: Apache-2.0 */
/* The products: which shapes and words stand where on the sheet. */
#include "print_bar.hpp"
#include "print_footprint.hpp"
#include "print_grid.hpp"
#include "print_job.hpp"
#include "print_marks.hpp"

#include <opms/version.h>

#include <cmath>
#include <string>

namespace opms::print {
namespace {

constexpr double white = 1.0;
constexpr double black = 0.0;
constexpr double tick_grey = 0.8; /* 20 % grey: seen by a person, weak for an edge detector */

std::string version()
{
    return "opms " + std::to_string(OPMS_VERSION_MAJOR) + "." + std::to_string(OPMS_VERSION_MINOR) +
           "." + std::to_string(OPMS_VERSION_PATCH);
}

std::string title_of(const std::string &what)
{
    return "OPMS " + what + " | scale 1:1 | " + version();
}

std::vector<Box> moved(std::vector<Box> boxes, Point by)
{
    for (Box &box : boxes) {
        box = {box.x0 + by.x, box.x1 + by.x, box.y0 + by.y, box.y1 + by.y};
    }
    return boxes;
}

Sheet bar_sheet(BarKind kind)
{
    const bool tags = kind == BarKind::apriltag33;
    Sheet sheet;
    sheet.title = title_of(tags ? "marker bar apriltag33" : "marker bar hope33");
    sheet.extent = {-45.0, 145.0, -520.0, 520.0};
    sheet.tile_area = {-31.0, 27.0, -508.0, 508.0};
    /* A joint in a white strip, 2.5 mm wide, between a square and the cells beside it splits no
     * edge. Along X no joint is ever needed: any paper is higher than the bar. */
    sheet.joints_y = {bar_pitch_mm, {bar_square_mm / 2 + 1.25, -bar_square_mm / 2 - 1.25}};
    sheet.joints_x = {bar_pitch_mm, {0.0}};
    Layer pattern = {black, tags ? apriltag33_black() : hope33_black(), {}};
    append_corner_marks(bar_outline, pattern);
    sheet.content.layers.push_back(std::move(pattern));
    sheet.content.texts = {{{-25.0, -500.0},
                            4.0,
                            480.0,
                            sheet.title + " | cut along the marks: 1000.0 x 30.0 mm between them"},
                           {{24.0, -490.0}, 3.5, 240.0, "+Y to the right, square 0 at this end"},
                           {{24.0, -90.0}, 3.5, 180.0, "+X: this long side towards the operator"}};
    Layer rulers = {black, {}, {}};
    append_ruler_right({40.0, -480.0}, rulers, sheet.one_page_only.texts);
    append_ruler_down({40.0, -480.0}, rulers, sheet.one_page_only.texts);
    sheet.one_page_only.layers.push_back(std::move(rulers));
    sheet.one_page_only.texts.push_back({{56.0, -470.0},
                                         3.5,
                                         900.0,
                                         "Print at 100 %, never \"fit to page\". Both rulers must "
                                         "measure 100.0 mm from end to end, "
                                         "and the bar 1000.0 mm between its cut marks."});
    return sheet;
}

Layer grid_lines()
{
    Layer lines = {black, {}, {}};
    const double half = grid_line_mm / 2;
    for (int i = -grid_half_x; i <= grid_half_x; ++i) {
        const double x = i * grid_pitch_mm;
        lines.boxes.push_back({x - half, x + half, grid_field.y0 - half, grid_field.y1 + half});
    }
    for (int j = -grid_half_y; j <= grid_half_y; ++j) {
        const double y = j * grid_pitch_mm;
        lines.boxes.push_back({grid_field.x0 - half, grid_field.x1 + half, y - half, y + half});
    }
    lines.boxes.push_back(grid_marker);
    return lines;
}

void append_grid_words(Sheet &sheet, const std::string &footprint)
{
    sheet.content.texts = {
        {{-407.0, -550.0},
         5.0,
         720.0,
         sheet.title + " | lines 1100.0 x 800.0 mm from the first to the last"},
        {{407.5, -550.0}, 4.0, 380.0, "+X: this side towards the operator; +Y to the right"},
        {{413.0, -550.0}, 4.0, 1100.0, footprint}};
    Layer rulers = {black, {}, {}};
    append_ruler_right({-406.5, 430.0}, rulers, sheet.one_page_only.texts);
    append_ruler_down({-380.0, -565.0}, rulers, sheet.one_page_only.texts);
    sheet.one_page_only.layers.push_back(std::move(rulers));
    sheet.one_page_only.texts.push_back(
        {{-407.0, 190.0},
         3.5,
         230.0,
         "Print at 100 %, never \"fit to page\"; the rulers must measure 100.0 mm."});
}

void check_footprint(const Footprint &footprint)
{
    for (const double value : {footprint.x_mm, footprint.y_mm, footprint.yaw_deg}) {
        if (!std::isfinite(value) || std::abs(value) > 1e4) {
            throw JobError("the footprint must be three finite numbers X_MM,Y_MM,YAW_DEG, none "
                           "above 10000");
        }
    }
    if (!(footprint.head_diameter_mm >= 20.0 && footprint.head_diameter_mm <= 800.0)) {
        throw JobError("the head's diameter must be 20 to 800 mm");
    }
}

Sheet grid_sheet_of(const Job &job)
{
    check_footprint(job.footprint);
    const bool evaluation = job.product == Product::evaluation;
    /* The whole white square of the marker stays free, so that nothing can be taken for it. */
    std::vector<Box> keep_out = {{0.0, grid_pitch_mm, 0.0, grid_pitch_mm}};
    const std::vector<Box> bar_area = moved({bar_outline}, evaluation_bar);
    if (evaluation) {
        keep_out.push_back(bar_area.front());
    }
    const FootprintMarks marks = footprint_marks(job.footprint, keep_out);

    Sheet sheet;
    sheet.title = title_of(evaluation ? "evaluation sheet: grid a0-25 with bar hope33"
                                      : "calibration grid a0-25");
    sheet.extent = grid_sheet;
    sheet.tile_area = {-416.0, 416.0, -558.0, 558.0};
    /* Joints run through the middle of white squares: they cross lines and never run along one. */
    sheet.joints_x = {grid_pitch_mm, {grid_pitch_mm / 2}};
    sheet.joints_y = {grid_pitch_mm, {grid_pitch_mm / 2}};
    sheet.content.layers.push_back(grid_lines());
    sheet.content.layers.push_back({tick_grey, {}, marks.quads});
    if (evaluation) {
        sheet.content.layers.push_back({white, bar_area, {}});
        sheet.content.layers.push_back({black, moved(hope33_black(), evaluation_bar), {}});
    }
    append_grid_words(sheet, marks.words);
    return sheet;
}

} // namespace

Sheet make_sheet(const Job &job)
{
    return job.product == Product::bar ? bar_sheet(job.bar) : grid_sheet_of(job);
}

} // namespace opms::print
