/* SPDX-License-Identifier: Apache-2.0 */
/* The tags of apriltag33 against libapriltag's own table. */
#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>

#include "synth_check.hpp"

namespace
{

using namespace synth;

bool is_black(const sim::Pattern &pattern, double x, double y)
{
    for (const sim::Rect &r : pattern.black) {
        if (r.x0 < x && x < r.x1 && r.y0 < y && y < r.y1) {
            return true;
        }
    }
    return false;
}

/** A cell of the 8 x 8 that make a tag's border square; the family lists where its bits are. */
bool is_white(const apriltag_family_t &family, int tag, unsigned row, unsigned column)
{
    for (unsigned bit = 0; bit < family.nbits; ++bit) {
        if (family.bit_y[bit] == row && family.bit_x[bit] == column) {
            return (family.codes[tag] >> (family.nbits - 1 - bit) & 1U) != 0;
        }
    }
    return false;
}

void tags_are_those_of_libapriltag()
{
    const sim::Pattern bar = sim::make_pattern("apriltag33");
    apriltag_family_t *family = tag36h11_create();
    check(family->width_at_border == 8 && !family->reversed_border, "8 cells, border black");
    for (int k = 0; k < 33; ++k) {
        int wrong = 0;
        for (unsigned row = 0; row < 8; ++row) {
            for (unsigned column = 0; column < 8; ++column) {
                const double x = (row - 3.5) * 2.5, y = (k - 16) * 30.0 + (column - 3.5) * 2.5;
                wrong += is_white(*family, k, row, column) == is_black(bar, x, y) ? 1 : 0;
            }
        }
        check(wrong == 0, "tag " + std::to_string(k));
    }
    tag36h11_destroy(family);
}

} // namespace

int main()
{
    return run_all({{"tags are those of libapriltag", tags_are_those_of_libapriltag}});
}
