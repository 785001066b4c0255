/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/bar_code.h"

const uint8_t bar_codes[OPMS_BAR_SQUARES] = {
    57, 8,  46, 36, 61, 19, 56, 62, 50, 1,  35, 28, 38, 10, 37, 58, 2,
    6,  13, 54, 23, 22, 53, 24, 33, 47, 55, 44, 14, 3,  17, 49, 5,
};

const double bar_cell_x_mm[BAR_CELLS] = {11.25, 6.75, 2.25, -2.25, -6.75, -11.25};
const double bar_cell_y_mm[BAR_CELLS] = {-15, -15, -15, 15, 15, 15};

unsigned bar_gap_cells(int square, int direction)
{
    /* Every gap holds the upper cells (-X) of the square before it and the lower cells (+X) of the
     * square after it. Bits 5, 4, 3 run from -11.25 to -2.25 mm and bits 2, 1, 0 from 2.25 on. */
    const int before = direction > 0 ? square : square - 1;
    const int after = before + 1;
    unsigned mask = 0;
    if (before >= 0) {
        const unsigned code = bar_codes[before];
        mask |= (code >> 5 & 1u) | (code >> 4 & 1u) << 1 | (code >> 3 & 1u) << 2;
    }
    if (after < OPMS_BAR_SQUARES) {
        const unsigned code = bar_codes[after];
        mask |= (code >> 2 & 1u) << 3 | (code >> 1 & 1u) << 4 | (code & 1u) << 5;
    }
    return mask;
}
