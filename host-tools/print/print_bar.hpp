/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The marker bars as black rectangles in the bar frame, mm. */
#ifndef OPMS_PRINT_BAR_HPP
#define OPMS_PRINT_BAR_HPP

#include "print_shapes.hpp"

#include <vector>

namespace opms::print {

inline constexpr int bar_squares = 33;
inline constexpr int bar_origin = 16;
inline constexpr double bar_pitch_mm = 30.0;
inline constexpr double bar_square_mm = 20.0;
/** All that is printed of a bar; white where nothing is black. */
inline constexpr Box bar_outline = {-15.0, 15.0, -500.0, 500.0};

/** Squares and code cells of `hope33`. */
std::vector<Box> hope33_black();

/** Tags 0 to 32 of family 36h11, their tops towards -X. */
std::vector<Box> apriltag33_black();

} // namespace opms::print
#endif
