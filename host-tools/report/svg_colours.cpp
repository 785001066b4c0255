/* SPDX-License-Identifier: Apache-2.0 */
#include "svg_colours.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace {

/* Yellow over green-blue to dark blue. */
constexpr int STOPS[][3] = {
    {255, 252, 224}, {217, 239, 189}, {139, 208, 190}, {62, 159, 191}, {36, 101, 163},
    {20, 40, 100},
};
constexpr int LAST = static_cast<int>(sizeof STOPS / sizeof *STOPS) - 1;
constexpr double DARK = 0.5;

}  // namespace

std::string svg_scale_colour(double part)
{
    const double at = std::clamp(std::isfinite(part) ? part : 0.0, 0.0, 1.0) * LAST;
    const int low = std::min(static_cast<int>(at), LAST - 1);
    const double rest = at - low;
    int rgb[3];
    for (int i = 0; i < 3; i++) {
        rgb[i] = static_cast<int>(
            std::lround(STOPS[low][i] + rest * (STOPS[low + 1][i] - STOPS[low][i])));
    }
    char text[16];
    std::snprintf(text, sizeof text, "#%02x%02x%02x", static_cast<unsigned>(rgb[0]) & 0xff,
                  static_cast<unsigned>(rgb[1]) & 0xff, static_cast<unsigned>(rgb[2]) & 0xff);
    return text;
}

bool svg_scale_is_dark(double part)
{
    return part > DARK;
}
