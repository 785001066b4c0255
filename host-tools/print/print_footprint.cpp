/* SPDX-License-Identifier: Apache-2.0 */
#include "print_footprint.hpp"

#include "print_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

namespace opms::print {
namespace {

constexpr double tick_mm = 6.0;
constexpr double centre_line_mm = 18.0; /* longer than a tick, and still inside a white square */
constexpr double mark_width_mm = 0.5;
constexpr double clearance_mm = 0.25; /* white between a mark and the grid lines */
constexpr double inward_penalty = 10.0;

struct Placed {
    Quad quad;
    double moved_mm;
};

/** A mark before it is moved: it starts at the head's outline and points away from the head. */
struct Wish {
    Point start;
    Point outwards; /* unit vector */
    double length;

    Point centre() const
    {
        return {start.x + outwards.x * length / 2, start.y + outwards.y * length / 2};
    }
    /** Half the extent of the mark's upright hull. */
    Point reach() const
    {
        const double along = length / 2;
        const double across = mark_width_mm / 2;
        return {std::abs(outwards.x) * along + std::abs(outwards.y) * across,
                std::abs(outwards.y) * along + std::abs(outwards.x) * across};
    }
};

Quad quad_at(const Wish &wish, Point centre)
{
    const Point along = {wish.outwards.x * wish.length / 2, wish.outwards.y * wish.length / 2};
    const Point across = {-wish.outwards.y * mark_width_mm / 2,
                          wish.outwards.x * mark_width_mm / 2};
    return {{{centre.x - along.x - across.x, centre.y - along.y - across.y},
             {centre.x + along.x - across.x, centre.y + along.y - across.y},
             {centre.x + along.x + across.x, centre.y + along.y + across.y},
             {centre.x - along.x + across.x, centre.y - along.y + across.y}}};
}

/** The nearest centre to `wanted` that leaves the mark inside the white square which begins at
 * `index` pitches; squares are alike in X and Y. */
double inside_square(double wanted, int index, double reach)
{
    const double inset = grid_line_mm / 2 + clearance_mm + reach;
    return std::clamp(wanted, index * grid_pitch_mm + inset, (index + 1) * grid_pitch_mm - inset);
}

bool touches(Point centre, Point reach, const std::vector<Box> &keep_out)
{
    const Box hull = {centre.x - reach.x, centre.x + reach.x, centre.y - reach.y,
                      centre.y + reach.y};
    return std::any_of(keep_out.begin(), keep_out.end(),
                       [&hull](const Box &box) { return hull.overlaps(box); });
}

/** Tries the white squares around and takes the one with the smallest move. A move inwards would
 * hide the mark under the head, so it costs more. */
std::optional<Placed> place(const Wish &wish, const std::vector<Box> &keep_out)
{
    const Point wanted = wish.centre();
    const Point reach = wish.reach();
    const int near_x = static_cast<int>(std::floor(wanted.x / grid_pitch_mm));
    const int near_y = static_cast<int>(std::floor(wanted.y / grid_pitch_mm));
    std::optional<Placed> best;
    double best_cost = std::numeric_limits<double>::infinity();
    for (int i = std::max(near_x - 2, -grid_half_x); i <= std::min(near_x + 2, grid_half_x - 1);
         ++i) {
        for (int j = std::max(near_y - 2, -grid_half_y); j <= std::min(near_y + 2, grid_half_y - 1);
             ++j) {
            const Point centre = {inside_square(wanted.x, i, reach.x),
                                  inside_square(wanted.y, j, reach.y)};
            const Point move = {centre.x - wanted.x, centre.y - wanted.y};
            const double outwards = move.x * wish.outwards.x + move.y * wish.outwards.y;
            const double length = std::hypot(move.x, move.y);
            const double cost = length + inward_penalty * std::max(0.0, -outwards);
            if (cost < best_cost - 1e-9 && !touches(centre, reach, keep_out)) {
                best_cost = cost;
                best = Placed{quad_at(wish, centre), length};
            }
        }
    }
    return best;
}

bool on_lines(Point point)
{
    return point.x >= grid_field.x0 && point.x <= grid_field.x1 && point.y >= grid_field.y0 &&
           point.y <= grid_field.y1;
}

/** Names the sides beyond which the outline reaches, such as "+X, -Y". */
std::string sides_beyond(const Footprint &footprint, const Box &limits)
{
    const double radius = footprint.head_diameter_mm / 2;
    std::string sides;
    const auto add = [&sides](bool beyond, const char *side) {
        if (beyond) {
            sides += (sides.empty() ? "" : ", ");
            sides += side;
        }
    };
    add(footprint.x_mm + radius > limits.x1, "+X");
    add(footprint.x_mm - radius < limits.x0, "-X");
    add(footprint.y_mm + radius > limits.y1, "+Y");
    add(footprint.y_mm - radius < limits.y0, "-Y");
    return sides;
}

std::string number(double value)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
}

struct AxisMarks {
    std::vector<Placed> placed;
    std::string words;
};

/** The marks of one axis: two ticks, or a centre line where one end is off the lines. */
AxisMarks axis_marks(const Footprint &footprint, const char *name, Point axis,
                     const std::vector<Box> &keep_out)
{
    const double radius = footprint.head_diameter_mm / 2;
    std::vector<Wish> ends;
    for (const double sign : {-1.0, 1.0}) {
        const Point outwards = {sign * axis.x, sign * axis.y};
        const Point start = {footprint.x_mm + radius * outwards.x,
                             footprint.y_mm + radius * outwards.y};
        if (on_lines(start)) {
            ends.push_back({start, outwards, tick_mm});
        }
    }
    if (ends.size() == 1) {
        ends.front().length = centre_line_mm;
    }
    AxisMarks marks;
    for (const Wish &end : ends) {
        if (const std::optional<Placed> placed = place(end, keep_out)) {
            marks.placed.push_back(*placed);
        }
    }
    if (!marks.placed.empty()) {
        marks.words = ends.size() == 2 ? std::string("two ") + name + " ticks"
                                       : std::string("the ") + name + " centre line";
    }
    return marks;
}

std::string outline_words(const Footprint &footprint)
{
    const std::string off_sheet = sides_beyond(footprint, grid_sheet);
    const std::string off_lines = sides_beyond(footprint, grid_field);
    if (!off_sheet.empty()) {
        return " The outline leaves the sheet beyond " + off_sheet + ".";
    }
    return off_lines.empty() ? "" : " The outline leaves the lines beyond " + off_lines + ".";
}

} // namespace

FootprintMarks footprint_marks(const Footprint &footprint, const std::vector<Box> &keep_out)
{
    const double yaw = footprint.yaw_deg * std::acos(-1.0) / 180.0;
    const AxisMarks y_marks = axis_marks(footprint, "Y", {-std::sin(yaw), std::cos(yaw)}, keep_out);
    const AxisMarks x_marks = axis_marks(footprint, "X", {std::cos(yaw), std::sin(yaw)}, keep_out);

    FootprintMarks marks;
    double moved = 0.0;
    for (const AxisMarks *axis : {&y_marks, &x_marks}) {
        for (const Placed &placed : axis->placed) {
            marks.quads.push_back(placed.quad);
            moved = std::max(moved, placed.moved_mm);
        }
    }
    if (marks.quads.empty()) {
        throw JobError("the footprint's centre at X " + number(footprint.x_mm) + " mm, Y " +
                       number(footprint.y_mm) + " mm with a head of " +
                       number(footprint.head_diameter_mm) +
                       " mm leaves no mark on the grid's lines (X -400 to 400, Y -550 to 550 mm)");
    }
    const std::string between = x_marks.words.empty() || y_marks.words.empty() ? "" : " and ";
    marks.words = "Footprint of the head: centre X " + number(footprint.x_mm) + " mm, Y " +
                  number(footprint.y_mm) + " mm, yaw " + number(footprint.yaw_deg) +
                  " deg, diameter " + number(footprint.head_diameter_mm) + " mm." +
                  outline_words(footprint) + " Grey marks: " + y_marks.words + between +
                  x_marks.words + ", from the outline outwards, moved up to " +
                  number(std::ceil(moved * 10.0) / 10.0) + " mm off the grid lines.";
    return marks;
}

} // namespace opms::print
