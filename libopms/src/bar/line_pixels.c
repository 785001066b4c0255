/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/line_pixels.h"

#include <math.h>

#include "algebra/lanes.h"

/** Lay a line behind the others. */
static void add_line(line_pixels_t *pixels, const fit_line_t *line)
{
    const int n = pixels->count, last = n + line->count - 1;
    const lanes_t number = {0, 1, 2, 3};
    for (int k = 0; k < line->count; k += LANES) {
        const lanes_t at = number + (float)k;
        lanes_store(&pixels->s[n + k], line->s_first + at * line->s_step);
        lanes_store(&pixels->along[n + k], line->along_first + at * line->along_step);
        lanes_store(&pixels->grey[n + k], lanes_load(&line->grey[k]));
    }
    pixels->s_high = fmaxf(pixels->s_high, fmaxf(pixels->s[n], pixels->s[last]));
    pixels->along_low = fminf(pixels->along_low, fminf(pixels->along[n], pixels->along[last]));
    pixels->along_high = fmaxf(pixels->along_high, fmaxf(pixels->along[n], pixels->along[last]));
    pixels->count = last + 1;
}

void line_pixels_gather(line_pixels_t *pixels, const fit_line_t *lines, int count)
{
    pixels->count = 0;
    pixels->s_high = pixels->along_high = -1e30f;
    pixels->along_low = 1e30f;
    for (int i = 0; i < count && pixels->count + lines[i].count <= PIXELS_MAX - LANES; ++i) {
        if (lines[i].count > 0) {
            add_line(pixels, &lines[i]);
        }
    }
    for (int k = pixels->count; k % LANES != 0; ++k) {
        pixels->s[k] = pixels->along[k] = pixels->grey[k] = 0.f;
    }
}

int line_pixels_saturated(const line_pixels_t *pixels, float white)
{
    lanes_int_t count = {0};
    for (int k = 0; k < pixels->count; k += LANES) {
        count -= lanes_load(&pixels->grey[k]) >= white; /* a comparison gives -1 where it holds */
    }
    return count[0] + count[1] + count[2] + count[3];
}
