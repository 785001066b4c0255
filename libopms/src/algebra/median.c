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

static void swap(float *a, float *b)
{
    const float kept = *a;
    *a = *b;
    *b = kept;
}

/** Bring the middle one of the first value, the last and one in between to the end. */
static void choose_pivot(float *values, int from, int to)
{
    float *const first = &values[from], *const last = &values[to - 1];
    float *const between = &values[from + (to - from) / 2];
    if (*between < *first) {
        swap(between, first);
    }
    if (*last < *first) {
        swap(last, first);
    }
    if (*between < *last) {
        swap(between, last);
    }
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
        choose_pivot(values, from, to);
        const float pivot = values[to - 1];
        const int less = partition(values, from, to - 1, pivot, 0);
        swap(&values[less], &values[to - 1]);
        if (rank == less) {
            return pivot;
        }
        if (rank < less) {
            to = less;
            continue;
        }
        /* Where nothing is less there may be many of the same. */
        const int not_more = less > from ? less + 1 : partition(values, from, to, pivot, 1);
        if (rank < not_more || not_more == from) {
            return pivot;
        }
        from = not_more;
    }
    sort_few(values, from, to);
    return values[rank];
}
