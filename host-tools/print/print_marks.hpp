/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Marks around a pattern: rulers and cut marks. They never enter it. */
#ifndef OPMS_PRINT_MARKS_HPP
#define OPMS_PRINT_MARKS_HPP

#include "print_shapes.hpp"

namespace opms::print {

/** A ruler of 100 mm towards +Y from its zero, ticks every 10 mm towards -X. Measured from the
 * middle of one tick to the middle of another. */
void append_ruler_right(Point zero, Layer &black, std::vector<Text> &texts);

/** The same towards +X, ticks towards -Y. */
void append_ruler_down(Point zero, Layer &black, std::vector<Text> &texts);

/** Marks in line with the four sides of a box, off its corners by a gap. */
void append_corner_marks(const Box &box, Layer &black);

/** A fine line across the cut, along X (a cut along Y = y) or along Y (a cut along X = x). */
void append_line_along_x(double x0, double x1, double y, Layer &black);
void append_line_along_y(double x, double y0, double y1, Layer &black);

} // namespace opms::print
#endif
