/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The pixels of a stretch's lines one behind the other, as columns for the vector unit. */
#ifndef OPMS_BAR_LINE_PIXELS_H
#define OPMS_BAR_LINE_PIXELS_H

#include "algebra/wide_lanes.h"
#include "bar/stretch_fit.h"

#define PIXELS_MAX 1024 /* of a stretch, a multiple of WIDE */

typedef struct line_pixels {
    int count; /**< what fills up the last lanes is 0 and does not count */
    float s_high, along_low, along_high; /**< extremes of the columns */
    float s[PIXELS_MAX], along[PIXELS_MAX], grey[PIXELS_MAX];
} line_pixels_t;

static inline float larger_of(float a, float b)
{
    return a > b ? a : b;
}

/** Grey levels of a line; behind its last one there may be others. */
WIDE_INLINE void line_pixels_grey(const fit_lines_t *lines, const fit_line_t *line, float *grey)
{
    if (line->in_row) {
        for (int k = 0; k < line->count; k += WIDE) {
            uint8_t near[WIDE];
            memcpy(near, line->first + k, sizeof near);
            for (int i = 0; i < WIDE; ++i) {
                grey[k + i] = (float)near[i];
            }
        }
        return;
    }
    const uint8_t *at = line->first;
    for (int k = 0; k < line->count; ++k, at += lines->pixel_bytes) {
        grey[k] = lines->wide ? (float)*(const uint16_t *)(const void *)at : (float)*at;
    }
}

/** Lay all lines one behind the other. */
WIDE_INLINE void line_pixels_gather(line_pixels_t *pixels, const fit_lines_t *lines)
{
    const wide_t number = wide_number();
    float s_high = -1e30f, low = 1e30f, high = -1e30f;
    int n = 0;
    for (int i = 0; i < lines->count; ++i) {
        const fit_line_t *line = &lines->line[i];
        if (n + line->count > PIXELS_MAX - WIDE) {
            break;
        }
        for (int k = 0; k < line->count; k += WIDE) {
            const wide_t at = number + (float)k;
            wide_store(&pixels->s[n + k], line->s_first + at * line->s_step);
            wide_store(&pixels->along[n + k], line->along_first + at * line->along_step);
        }
        line_pixels_grey(lines, line, &pixels->grey[n]);
        const float span = (float)(line->count - 1);
        const float s_last = line->s_first + span * line->s_step;
        const float last = line->along_first + span * line->along_step;
        s_high = larger_of(s_high, larger_of(line->s_first, s_last));
        low = -larger_of(-low, larger_of(-line->along_first, -last));
        high = larger_of(high, larger_of(line->along_first, last));
        n += line->count;
    }
    for (int k = n; k % WIDE != 0; ++k) {
        pixels->s[k] = pixels->along[k] = pixels->grey[k] = 0.f;
    }
    pixels->count = n;
    pixels->s_high = s_high;
    pixels->along_low = low;
    pixels->along_high = high;
}

#endif
