/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/line_search.h"

/* A line is read as a zigzag: a fall of at least `contrast` from the last peak, then a rise of at
 * least `contrast` from the valley. Smaller wiggles, noise among them, are not seen. */

void line_load(const view_t *view, const search_line_t *line, uint16_t *values)
{
    const int count = line->to - line->from + 1;
    if (line->upright) {
        for (int i = 0; i < count; ++i) {
            values[i] = (uint16_t)view_at(view, line->at, line->from + i);
        }
    } else if (view->wide) {
        for (int i = 0; i < count; ++i) {
            values[i] = (uint16_t)view_at(view, line->from + i, line->at);
        }
    } else {
        const uint8_t *row = view->base + (ptrdiff_t)line->at * view->stride + line->from;
        for (int i = 0; i < count; ++i) {
            values[i] = row[i];
        }
    }
}

int line_next_run(const uint16_t *values, int count, int contrast, int shortest, int longest,
                  int *cursor, dark_run_t *run)
{
    int i = *cursor;
    while (i < count) {
        /* Climb to a peak and on until it has fallen by the contrast. */
        int peak = values[i];
        while (i < count && values[i] > peak - contrast) {
            peak = values[i] > peak ? values[i] : peak;
            ++i;
        }
        if (i >= count) {
            break;
        }
        int valley = values[i];
        int fall = i, rise = i;
        while (i < count && values[i] < valley + contrast) {
            valley = values[i] < valley ? values[i] : valley;
            ++i;
        }
        if (i >= count) {
            break;
        }
        rise = i;
        int next_peak = values[i];
        for (int k = i; k < count && k < i + 8 && values[k] > next_peak - contrast; ++k) {
            next_peak = values[k] > next_peak ? values[k] : next_peak;
        }
        const int white = peak < next_peak ? peak : next_peak;
        const int half = (white + valley) / 2;
        while (fall > 0 && values[fall - 1] < half) {
            --fall;
        }
        while (fall < rise && values[fall] >= half) {
            ++fall;
        }
        while (rise > fall && values[rise - 1] >= half) {
            --rise;
        }
        const int length = rise - fall;
        *cursor = i;
        if (length >= shortest && length <= longest) {
            run->middle = (fall + rise - 1) / 2;
            run->length = length;
            run->black = valley;
            run->white = white;
            return 1;
        }
    }
    *cursor = count;
    return 0;
}
