/* SPDX-License-Identifier: Apache-2.0 */
/* The printed patterns of docs/conventions.md as rectangles. The tags are kept here as pictures, so
 * that no library decides what is drawn; the tests compare them with libapriltag's own table. */
#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include "simulate/sim_rects.hpp"
#include "simulate/simulate.hpp"

namespace opms::simulate
{
namespace
{

constexpr int SQUARES = 33, ORIGIN_SQUARE = 16;
constexpr double PITCH = 30, SIDE = 20;
constexpr Rect BAR{-15, -500, 15, 500};

constexpr std::array<unsigned, SQUARES> CODES = {57, 8,  46, 36, 61, 19, 56, 62, 50, 1,  35,
                                                 28, 38, 10, 37, 58, 2,  6,  13, 54, 23, 22,
                                                 53, 24, 33, 47, 55, 44, 14, 3,  17, 49, 5};

/** The 6 x 6 inner cells of tags 0 to 32 of family 36h11, row by row from the top left cell in the
 * most significant of 36 bits; 1 = white. */
constexpr std::array<std::uint64_t, SQUARES> TAGS = {
    0xd5d628584, 0xd97f18b49, 0xdd280910e, 0xe479e9c98, 0xebcbca822, 0xf31dab3ac, 0x056a5d085,
    0x10652e1d4, 0x22b1dfead, 0x265ad0472, 0x34fe91b86, 0x3ff962cd5, 0x43a25329a, 0x474b4385f,
    0x4e9d243e9, 0x5246149ae, 0x5997f5538, 0x683bb6c4c, 0x6be4a7211, 0x7e3158eea, 0x81da494af,
    0x858339a74, 0x8cd51a5fe, 0x9f21cc2d7, 0xa2cabc89c, 0xadc58d9eb, 0xb16e7dfb0, 0xb8c05eb3a,
    0xd25ef139d, 0xd607e1962, 0xe4aba3076, 0x2dde6a3da, 0x43d40c678};

Rect centred(double x, double y, double size_x, double size_y)
{
    return {x - size_x / 2, y - size_y / 2, x + size_x / 2, y + size_y / 2};
}

double square_y(std::size_t k)
{
    return (static_cast<double>(k) - ORIGIN_SQUARE) * PITCH;
}

std::vector<Rect> squares()
{
    std::vector<Rect> all;
    for (std::size_t k = 0; k < SQUARES; ++k) {
        all.push_back(centred(0, square_y(k), SIDE, SIDE));
    }
    return all;
}

std::vector<Rect> hope33_black()
{
    std::vector<Rect> black = squares();
    for (std::size_t k = 0; k < SQUARES; ++k) {
        for (unsigned bit = 0; bit < 6; ++bit) {
            if ((CODES[k] >> bit & 1U) != 0) {
                /* Bit 5 at the far side, bit 0 at the operator's; 5 to 3 to the right. */
                const double x = -11.25 + 4.5 * (5 - static_cast<double>(bit));
                black.push_back(centred(x, square_y(k) + (bit >= 3 ? 15 : -15), 4.5, 5));
            }
        }
    }
    return black;
}

std::vector<Rect> apriltag33_black()
{
    constexpr double CELL = SIDE / 8;
    std::vector<Rect> white;
    for (std::size_t k = 0; k < SQUARES; ++k) {
        for (int cell = 0; cell < 36; ++cell) {
            if ((TAGS[k] >> (35 - cell) & 1U) != 0) {
                const double x = (cell / 6 - 2.5) * CELL;
                white.push_back(centred(x, square_y(k) + (cell % 6 - 2.5) * CELL, CELL, CELL));
            }
        }
    }
    return subtract(squares(), white);
}

std::vector<Rect> grid_black()
{
    constexpr double STEP = 25, WIDTH = 2;
    std::vector<Rect> black = {{3, 3, 9, 9}};
    for (int i = -16; i <= 16; ++i) {
        black.push_back(centred(i * STEP, 0, WIDTH, 44 * STEP + WIDTH));
    }
    for (int j = -22; j <= 22; ++j) {
        black.push_back(centred(0, j * STEP, 32 * STEP + WIDTH, WIDTH));
    }
    return black;
}

Rect moved_x(Rect r, double by)
{
    return {r.x0 + by, r.y0, r.x1 + by, r.y1};
}

Pattern bar_pattern(const std::string &name)
{
    Pattern bar{name, BAR, {}, squares()};
    bar.black = name == "hope33" ? hope33_black() : apriltag33_black();
    return bar;
}

Pattern grid_pattern(const std::string &name)
{
    Pattern grid{name, centred(0, 0, 841, 1189), grid_black(), {}};
    if (name == "evaluation") {
        constexpr double BAR_X = -350;
        grid.black = subtract(grid.black, {moved_x(BAR, BAR_X)});
        for (const Rect &r : hope33_black()) {
            grid.black.push_back(moved_x(r, BAR_X));
        }
    }
    for (int i = -16; i <= 16; ++i) {
        for (int j = -22; j <= 22; ++j) {
            const Rect node = centred(i * 25.0, j * 25.0, 2, 2);
            if (name != "evaluation" || i != -14 || j < -20 || j > 20) {
                grid.targets.push_back(node);
            }
        }
    }
    return grid;
}

} // namespace

Pattern make_pattern(const std::string &name, double gain_mm)
{
    Pattern pattern;
    if (name == "hope33" || name == "apriltag33") {
        pattern = bar_pattern(name);
    } else if (name == "a0-25" || name == "evaluation") {
        pattern = grid_pattern(name);
    } else {
        throw std::invalid_argument("there is no pattern \"" + name +
                                    "\"; hope33, apriltag33, a0-25 and evaluation are known");
    }
    pattern.black = grow(pattern.black, gain_mm);
    return pattern;
}

} // namespace opms::simulate
