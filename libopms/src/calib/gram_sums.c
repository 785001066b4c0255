/* SPDX-License-Identifier: Apache-2.0 */
/* Two columns with two others at a time, four rows side by side: each number that is loaded takes
 * part in two products, and all sums stay in registers. */
#include "calib/gram_sums.h"

#include "algebra/quad_lanes.h"

/* Columns a and a + 1 with b and b + 1. */
WIDE_INLINE void add_tile(const double *columns, int count, int a, int b, double *gram)
{
    const double *const left = columns + a * GRAM_ROWS, *const right = columns + b * GRAM_ROWS;
    quad_t sum[2][2] = {{{0.0}}};
    for (int i = 0; i < GRAM_ROWS; i += QUAD) {
        quad_t a0, a1, b0, b1;
        quad_load(left + i, &a0);
        quad_load(left + GRAM_ROWS + i, &a1);
        quad_load(right + i, &b0);
        quad_load(right + GRAM_ROWS + i, &b1);
        sum[0][0] += a0 * b0;
        sum[0][1] += a0 * b1;
        sum[1][0] += a1 * b0;
        sum[1][1] += a1 * b1;
    }
    for (int k = 0; k < 2; ++k) {
        gram[(a + k) * count + b] += quad_sum(&sum[k][0]);
        gram[(a + k) * count + b + 1] += quad_sum(&sum[k][1]);
    }
}

WIDE_INLINE void add_lanes(const double *columns, int count, double *gram)
{
    for (int a = 0; a < count; a += 2) {
        for (int b = a; b < count; b += 2) {
            add_tile(columns, count, a, b, gram);
        }
    }
}

WIDE_EITHER(add, (const double *columns, int count, double *gram), (columns, count, gram))

void gram_add(const double *columns, int count, double *gram)
{
    add(columns, count, gram);
}
