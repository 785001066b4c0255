/* SPDX-License-Identifier: Apache-2.0 */
/* From a sheet to paper. Each tile shows a window of the sheet that begins where it is to be cut
 * (left and top) and runs on under the next tile by the overlap, so that a tile is cut, laid on its
 * neighbour's overlap and glued there. */
#include "print_job.hpp"
#include "print_marks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace opms::print {
namespace {

constexpr double margin_mm = 12.0;  /* most printers leave 5 mm white; marks need the rest */
constexpr double overlap_mm = 10.0; /* least overlap of neighbours */
constexpr double black = 0.0;

struct PaperSize {
    double width;
    double height;
};

PaperSize landscape_of(Paper paper)
{
    return paper == Paper::a3 ? PaperSize{420.0, 297.0} : PaperSize{297.0, 210.0};
}

/** Where windows of a length must begin to cover from `from` to `to`: the first at `from`, the
 * others on joints, each over the one before by the overlap or more. */
std::vector<double> window_starts(double from, double to, double length, const Joints &joints)
{
    std::vector<double> starts = {from};
    while (starts.back() + length < to) {
        const double latest = starts.back() + length - overlap_mm;
        double start = -std::numeric_limits<double>::infinity();
        for (const double offset : joints.offsets_mm) {
            const double steps = std::floor((latest - offset) / joints.pitch_mm);
            start = std::max(start, offset + steps * joints.pitch_mm);
        }
        starts.push_back(start);
    }
    return starts;
}

struct Tiling {
    PaperSize paper;
    std::vector<double> x;
    std::vector<double> y;

    size_t count() const { return x.size() * y.size(); }
};

Tiling tiling_of(const Sheet &sheet, PaperSize paper)
{
    const Box &area = sheet.tile_area;
    return {paper, window_starts(area.x0, area.x1, paper.height - 2 * margin_mm, sheet.joints_x),
            window_starts(area.y0, area.y1, paper.width - 2 * margin_mm, sheet.joints_y)};
}

/** Which edges of a tile are cut, and where its right and lower neighbours will lie over it. */
struct Seams {
    bool cut_left;
    bool cut_top;
    bool next_right;
    double right_start;
    bool next_below;
    double below_start;
};

Seams seams_of(const Tiling &tiling, size_t row, size_t column)
{
    const bool right = column + 1 < tiling.y.size();
    const bool below = row + 1 < tiling.x.size();
    return {column > 0, row > 0,
            right,      right ? tiling.y[column + 1] : 0.0,
            below,      below ? tiling.x[row + 1] : 0.0};
}

/** A solid mark: cut here. */
void append_cut_marks(const Box &window, const Seams &seams, Layer &ink)
{
    if (seams.cut_left) {
        append_line_along_x(window.x0 - 6.0, window.x0 - 1.0, window.y0, ink);
        append_line_along_x(window.x1 + 1.0, window.x1 + 6.0, window.y0, ink);
    }
    if (seams.cut_top) {
        append_line_along_y(window.x0, window.y0 - 6.0, window.y0 - 1.0, ink);
        append_line_along_y(window.x0, window.y1 + 1.0, window.y1 + 6.0, ink);
    }
}

/** A broken mark: the cut edge of the next tile comes here. */
void append_overlap_marks(const Box &window, const Seams &seams, Layer &ink)
{
    for (const double off : {1.0, 2.6, 4.2}) {
        if (seams.next_right) {
            append_line_along_x(window.x0 - off - 0.8, window.x0 - off, seams.right_start, ink);
            append_line_along_x(window.x1 + off, window.x1 + off + 0.8, seams.right_start, ink);
        }
        if (seams.next_below) {
            append_line_along_y(seams.below_start, window.y0 - off - 0.8, window.y0 - off, ink);
            append_line_along_y(seams.below_start, window.y1 + off, window.y1 + off + 0.8, ink);
        }
    }
}

std::string neighbours(const Seams &seams, const Page &page, size_t columns)
{
    std::string words;
    if (seams.cut_left) {
        words += "cut the left side at the solid marks, lay it over tile " +
                 std::to_string(page.number - 1) + " up to the broken marks there; ";
    }
    if (seams.cut_top) {
        words += "cut the top, lay it over tile " + std::to_string(page.number - columns) + "; ";
    }
    return words;
}

void append_page_words(const Sheet &sheet, const Tiling &tiling, const Seams &seams, Page &page)
{
    const size_t columns = tiling.y.size();
    const double room = page.window.width() - 10.0;
    const Point at = {page.window.x1, page.window.y0 + 5.0};
    page.margin.texts.push_back(
        {{at.x + 3.6, at.y},
         2.4,
         room,
         "TILE " + std::to_string(page.number) + " of " + std::to_string(tiling.count()) +
             " (row " + std::to_string(page.row) + " of " + std::to_string(tiling.x.size()) +
             ", column " + std::to_string(page.column) + " of " + std::to_string(columns) + ") | " +
             sheet.title + " | print at 100 %"});
    page.margin.texts.push_back(
        {{at.x + 6.8, at.y},
         2.4,
         room,
         "Check both rulers first: 100.0 mm. To join: " + neighbours(seams, page, columns) +
             "build whole rows first; glue so that lines run on across the joint."});
}

Page tile_at(const Sheet &sheet, const Tiling &tiling, size_t row, size_t column)
{
    const double x = tiling.x[row];
    const double y = tiling.y[column];
    const Box paper = {x - margin_mm, x - margin_mm + tiling.paper.height, y - margin_mm,
                       y - margin_mm + tiling.paper.width};
    const Box window = {paper.x0 + margin_mm, paper.x1 - margin_mm, paper.y0 + margin_mm,
                        paper.y1 - margin_mm};
    Page page = {static_cast<unsigned>(row * tiling.y.size() + column + 1),
                 static_cast<unsigned>(row + 1),
                 static_cast<unsigned>(column + 1),
                 paper,
                 window,
                 {}};
    const Seams seams = seams_of(tiling, row, column);
    Layer ink = {black, {}, {}};
    append_cut_marks(window, seams, ink);
    append_overlap_marks(window, seams, ink);
    append_ruler_right({window.x0 - 2.5, window.y0 + 12.0}, ink, page.margin.texts);
    append_ruler_down({window.x0 + 25.0, window.y0 - 2.5}, ink, page.margin.texts);
    page.margin.layers.push_back(std::move(ink));
    append_page_words(sheet, tiling, seams, page);
    return page;
}

} // namespace

std::vector<Page> make_pages(const Sheet &sheet, Paper paper)
{
    if (paper == Paper::one_page) {
        return {{1, 1, 1, sheet.extent, sheet.extent, sheet.one_page_only}};
    }
    const PaperSize landscape = landscape_of(paper);
    const Tiling across = tiling_of(sheet, landscape);
    const Tiling upright = tiling_of(sheet, {landscape.height, landscape.width});
    const Tiling &tiling = upright.count() < across.count() ? upright : across;
    std::vector<Page> pages;
    for (size_t row = 0; row < tiling.x.size(); ++row) {
        for (size_t column = 0; column < tiling.y.size(); ++column) {
            pages.push_back(tile_at(sheet, tiling, row, column));
        }
    }
    return pages;
}

} // namespace opms::print
