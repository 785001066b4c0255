/* SPDX-License-Identifier: Apache-2.0 */
#include "print_bar.hpp"

#include <array>

namespace opms::print {
namespace {

constexpr std::array<unsigned, bar_squares> codes = {57, 8,  46, 36, 61, 19, 56, 62, 50, 1,  35,
                                                     28, 38, 10, 37, 58, 2,  6,  13, 54, 23, 22,
                                                     53, 24, 33, 47, 55, 44, 14, 3,  17, 49, 5};

/** A code cell, relative to the centre of its square. */
struct Cell {
    unsigned bit;
    double x_mm;
    double dy_mm;
};

/* The upper half of the gap on the right holds the high bits, the lower half of the gap on the left
 * the low ones: so every gap is shared by its two squares. */
constexpr std::array<Cell, 6> cells = {{{5, -11.25, 15.0},
                                        {4, -6.75, 15.0},
                                        {3, -2.25, 15.0},
                                        {2, 2.25, -15.0},
                                        {1, 6.75, -15.0},
                                        {0, 11.25, -15.0}}};

constexpr double cell_x_mm = 4.5;
constexpr double cell_y_mm = 5.0;

Box centred(double x, double y, double size_x, double size_y)
{
    return {x - size_x / 2, x + size_x / 2, y - size_y / 2, y + size_y / 2};
}

} // namespace

std::vector<Box> hope33_black()
{
    std::vector<Box> black;
    for (int k = 0; k < bar_squares; ++k) {
        const double y = (k - bar_origin) * bar_pitch_mm;
        black.push_back(centred(0.0, y, bar_square_mm, bar_square_mm));
        for (const Cell &cell : cells) {
            if ((codes[static_cast<size_t>(k)] >> cell.bit & 1U) != 0U) {
                black.push_back(centred(cell.x_mm, y + cell.dy_mm, cell_x_mm, cell_y_mm));
            }
        }
    }
    return black;
}

} // namespace opms::print
