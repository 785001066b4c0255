/* SPDX-License-Identifier: Apache-2.0 */
#include "print_marks.hpp"

namespace opms::print {
namespace {

constexpr double line_mm = 0.2;
constexpr double ruler_mm = 100.0;
constexpr int ruler_steps = 10;
constexpr double tick_mm = 2.0;
constexpr double end_tick_mm = 3.5;
constexpr double label_mm = 2.2;
constexpr double label_room_mm = 9.0;
constexpr double mark_gap_mm = 1.5;
constexpr double mark_mm = 5.0;

double tick_length(int step)
{
    return step == 0 || step == ruler_steps ? end_tick_mm : tick_mm;
}

} // namespace

void append_line_along_x(double x0, double x1, double y, Layer &black)
{
    black.boxes.push_back({x0, x1, y - line_mm / 2, y + line_mm / 2});
}

void append_line_along_y(double x, double y0, double y1, Layer &black)
{
    black.boxes.push_back({x - line_mm / 2, x + line_mm / 2, y0, y1});
}

void append_ruler_right(Point zero, Layer &black, std::vector<Text> &texts)
{
    append_line_along_y(zero.x, zero.y - line_mm / 2, zero.y + ruler_mm + line_mm / 2, black);
    for (int step = 0; step <= ruler_steps; ++step) {
        const double y = zero.y + ruler_mm * step / ruler_steps;
        append_line_along_x(zero.x - tick_length(step), zero.x, y, black);
    }
    texts.push_back({{zero.x, zero.y + ruler_mm + 1.0}, label_mm, label_room_mm, "100 mm"});
}

void append_ruler_down(Point zero, Layer &black, std::vector<Text> &texts)
{
    append_line_along_x(zero.x - line_mm / 2, zero.x + ruler_mm + line_mm / 2, zero.y, black);
    for (int step = 0; step <= ruler_steps; ++step) {
        const double x = zero.x + ruler_mm * step / ruler_steps;
        append_line_along_y(x, zero.y - tick_length(step), zero.y, black);
    }
    /* Reads upwards and ends short of the ruler's end. */
    texts.push_back({{zero.x + ruler_mm + label_room_mm + 1.0, zero.y},
                     label_mm,
                     label_room_mm,
                     "100 mm",
                     true});
}

void append_corner_marks(const Box &box, Layer &black)
{
    for (const double y : {box.y0, box.y1}) {
        append_line_along_x(box.x0 - mark_gap_mm - mark_mm, box.x0 - mark_gap_mm, y, black);
        append_line_along_x(box.x1 + mark_gap_mm, box.x1 + mark_gap_mm + mark_mm, y, black);
    }
    for (const double x : {box.x0, box.x1}) {
        append_line_along_y(x, box.y0 - mark_gap_mm - mark_mm, box.y0 - mark_gap_mm, black);
        append_line_along_y(x, box.y1 + mark_gap_mm, box.y1 + mark_gap_mm + mark_mm, black);
    }
}

} // namespace opms::print
