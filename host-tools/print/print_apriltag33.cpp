/* SPDX-License-Identifier: Apache-2.0 */
/* The bar of AprilTags. The tags are kept here as pictures, so that the bar is printed the same
 * whether or not libapriltag is at hand; tests/print compares them with that library's drawing. */
#include "print_bar.hpp"

#include <array>
#include <cstdint>

namespace opms::print {
namespace {

/** The six by six inner cells of tags 0 to 32 of family 36h11, row by row from the top left cell in
 * the most significant of 36 bits; 1 = black. */
constexpr std::array<uint64_t, bar_squares> tags = {
    0x2a29d7a7b, 0x2680e74b6, 0x22d7f6ef1, 0x1b8616367, 0x1434357dd, 0x0ce254c53, 0xfa95a2f7a,
    0xef9ad1e2b, 0xdd4e20152, 0xd9a52fb8d, 0xcb016e479, 0xc0069d32a, 0xbc5dacd65, 0xb8b4bc7a0,
    0xb162dbc16, 0xadb9eb651, 0xa6680aac7, 0x97c4493b3, 0x941b58dee, 0x81cea7115, 0x7e25b6b50,
    0x7a7cc658b, 0x732ae5a01, 0x60de33d28, 0x5d3543763, 0x523a72614, 0x4e918204f, 0x473fa14c5,
    0x2da10ec62, 0x29f81e69d, 0x1b545cf89, 0xd22195c25, 0xbc2bf3987};

constexpr int inner_cells = 6;
constexpr int border_cells = 8; /* the black border is one cell around the inner ones */
constexpr double cell_mm = bar_square_mm / border_cells;

bool is_black(uint64_t tag, int row, int column)
{
    const bool border =
        row == 0 || row == border_cells - 1 || column == 0 || column == border_cells - 1;
    const int place = inner_cells * inner_cells - 1 - ((row - 1) * inner_cells + (column - 1));
    return border || (tag >> place & 1U) != 0U;
}

/** Black runs of one row: fewer shapes than single cells. */
void append_row(uint64_t tag, int row, double tag_y, std::vector<Box> &black)
{
    const double x = row * cell_mm - bar_square_mm / 2;
    const double left = tag_y - bar_square_mm / 2;
    for (int column = 0; column < border_cells;) {
        int end = column;
        while (end < border_cells && is_black(tag, row, end)) {
            ++end;
        }
        if (end > column) {
            black.push_back({x, x + cell_mm, left + column * cell_mm, left + end * cell_mm});
        }
        column = end + 1;
    }
}

} // namespace

std::vector<Box> apriltag33_black()
{
    std::vector<Box> black;
    for (int k = 0; k < bar_squares; ++k) {
        for (int row = 0; row < border_cells; ++row) {
            append_row(tags[static_cast<size_t>(k)], row, (k - bar_origin) * bar_pitch_mm, black);
        }
    }
    return black;
}

} // namespace opms::print
