/* SPDX-License-Identifier: Apache-2.0 */
#include "algebra/median.h"

/* Selection by partitions that have no branch on a value: half of such branches would be foretold
 * wrongly, which costs more than all else. */

#define FEW 8

/** Move what is less than the pivot, or, `equal`, not more, to the front; returns its end. */
static int partition(float *values, int from, int to, float pivot, int equal)
{
    int end = from;
    for (int i = from; i < to; ++i) {
        const float v = values[i];
        values[i] = values[end];
        values[end] = v;
        end += equal ? v <= pivot : v < pivot;
    }
    return end;
}

static float middle_of(float a, float b, float c)
{
    const float low = a < b ? a : b, high = a < b ? b : a;
    return c < low ? low : c > high ? high : c;
}

static void sort_few(float *values, int from, int to)
{
    for (int i = from + 1; i < to; ++i) {
        const float v = values[i];
        int k = i;
        for (; k > from && values[k - 1] > v; --k) {
            values[k] = values[k - 1];
        }
        values[k] = v;
    }
}

float median_of(float *values, int count)
{
    const int rank = count / 2;
    int from = 0, to = count;
    while (to - from > FEW) {
        const float pivot =
            middle_of(values[from], values[from + (to - from) / 2], values[to - 1]);
        const int less = partition(values, from, to, pivot, 0);
        if (rank < less) {
            to = less;
            continue;
        }
        const int not_more = partition(values, less, to, pivot, 1);
        if (rank < not_more || not_more == from) {
            return pivot;
        }
        from = not_more;
    }
    sort_few(values, from, to);
    return values[rank];
}
