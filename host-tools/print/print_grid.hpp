/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Numbers of the calibration grid `a0-25`, grid frame, mm. */
#ifndef OPMS_PRINT_GRID_HPP
#define OPMS_PRINT_GRID_HPP

#include "print_shapes.hpp"

namespace opms::print {

inline constexpr double grid_pitch_mm = 25.0;
inline constexpr double grid_line_mm = 2.0;
inline constexpr int grid_half_x = 16; /* lines at X = -16 .. 16 pitches */
inline constexpr int grid_half_y = 22;
/** Middles of the outermost lines. */
inline constexpr Box grid_field = {-grid_half_x * grid_pitch_mm, grid_half_x *grid_pitch_mm,
                                   -grid_half_y *grid_pitch_mm, grid_half_y *grid_pitch_mm};
/** A0, the long side along Y. */
inline constexpr Box grid_sheet = {-420.5, 420.5, -594.5, 594.5};
/** Tells the centre node and the directions of +X and +Y. */
inline constexpr Box grid_marker = {3.0, 9.0, 3.0, 9.0};
/** Place of the bar's origin on the evaluation sheet. */
inline constexpr Point evaluation_bar = {-350.0, 0.0};

} // namespace opms::print
#endif
