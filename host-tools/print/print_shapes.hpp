/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What a print is made of: filled shapes and words, all in millimetres of the pattern's own frame.
 *
 * There is one frame from the layout to the drawing: +X down in print (towards the operator), +Y to
 * the right, the origin that of the bar or the grid. Only the drawing turns it into paper. */
#ifndef OPMS_PRINT_SHAPES_HPP
#define OPMS_PRINT_SHAPES_HPP

#include <array>
#include <string>
#include <vector>

namespace opms::print {

struct Point {
    double x;
    double y;
};

/** An upright rectangle: X from x0 to x1 (down), Y from y0 to y1 (right). */
struct Box {
    double x0;
    double x1;
    double y0;
    double y1;

    double height() const { return x1 - x0; }
    double width() const { return y1 - y0; }
    bool overlaps(const Box &other) const
    {
        return x0 < other.x1 && other.x0 < x1 && y0 < other.y1 && other.y0 < y1;
    }
};

using Quad = std::array<Point, 4>;

/** Shapes of one grey level (0 black, 1 white), filled as one path so that shapes which touch
 * leave no hairline between them. */
struct Layer {
    double grey;
    std::vector<Box> boxes;
    std::vector<Quad> quads;
};

/** One line of words. Its letters shrink until the line is no longer than `room_mm`. */
struct Text {
    Point at; /**< left end of the base line */
    double size_mm;
    double room_mm;
    std::string words;
    bool upwards = false; /**< runs towards -X instead of +Y */
};

/** Layers are drawn in order, then the words. */
struct Ink {
    std::vector<Layer> layers;
    std::vector<Text> texts;
};

/** Where a sheet may be cut into tiles: at any of `offsets_mm` plus a multiple of `pitch_mm`. */
struct Joints {
    double pitch_mm;
    std::vector<double> offsets_mm;
};

/** A whole product before it is put on paper. */
struct Sheet {
    std::string title;
    Box extent;    /**< the paper of a one-page print */
    Box tile_area; /**< what tiles must cover; the pattern, its marks and its words */
    Joints joints_x;
    Joints joints_y;
    Ink content;
    Ink one_page_only; /**< rulers: tiles have their own */
};

/** One piece of paper. */
struct Page {
    unsigned number; /**< from 1 */
    unsigned row;    /**< from 1, counted towards +X */
    unsigned column; /**< from 1, counted towards +Y */
    Box paper;       /**< the part of the pattern's plane that the paper covers */
    Box window;      /**< the part of the content that is drawn on it */
    Ink margin;      /**< drawn on this page alone, outside the window */
};

} // namespace opms::print
#endif
