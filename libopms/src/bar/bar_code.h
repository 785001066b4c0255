/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What is printed on a `hope33` bar (docs/conventions.md), in millimetres. */
#ifndef OPMS_BAR_CODE_H
#define OPMS_BAR_CODE_H

#include <stdint.h>

#include <opms/bar.h>

#define BAR_PITCH_MM 30.0
#define BAR_HALF_SQUARE_MM 10.0
#define BAR_HALF_WIDTH_MM 15.0   /* of the white bar, along X */
#define BAR_CELL_X_MM 4.5
#define BAR_CELL_Y_MM 5.0
#define BAR_CELL_GAP_MM 2.5      /* white between a square's side and the cells */
#define BAR_CELLS 6

/** Six-bit codes of the squares, bit 5 the most significant, 1 = black cell. */
extern const uint8_t bar_codes[OPMS_BAR_SQUARES];

/** Centre of the cell of a bit, relative to its square's centre: X, and Y as +15 or -15 mm. */
extern const double bar_cell_x_mm[BAR_CELLS];
extern const double bar_cell_y_mm[BAR_CELLS];

/** The black cells across the gap above side Y = +10 mm (direction +1) or -10 mm (-1) of square k,
 * as a mask over the six X positions from -11.25 mm (bit 0 of the mask) to +11.25 mm (bit 5). */
unsigned bar_gap_cells(int square, int direction);

#endif
