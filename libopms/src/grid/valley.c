/* SPDX-License-Identifier: Apache-2.0 */
#include "grid/valley.h"

#include "grid/grey_inside.h"

/* Grey levels from `from` on, one a pixel; ends at the picture's border. */
static int read_to_border(const view_t *view, vec2_t from, vec2_t unit, int count, float *grey)
{
    for (int n = 0; n < count; ++n) {
        const vec2_t at = vec2_add(from, unit, (float)n);
        if (!view_holds(view, at.x, at.y, 0.0)) {
            return n;
        }
        grey[n] = view_bilinear(view, at.x, at.y);
    }
    return count;
}

static int read_probe(const view_t *view, vec2_t from, vec2_t unit, int count, float *grey)
{
    if (!is_inside(view, from) ||
        !is_inside(view, vec2_add(from, unit, (float)(count - 1)))) {
        return read_to_border(view, from, unit, count, grey);
    }
    const view_t here = *view; /* which what is written cannot be part of */
    int x = (int)(from.x * (float)FIXED_ONE), y = (int)(from.y * (float)FIXED_ONE);
    const int step_x = (int)(unit.x * (float)FIXED_ONE), step_y = (int)(unit.y * (float)FIXED_ONE);
    for (int n = 0; n < count; ++n) {
        grey[n] = fixed_grey(&here, x, y);
        x += step_x;
        y += step_y;
    }
    return count;
}

/* Vertex of the parabola through three samples. */
static float vertex(const float *grey, int i, int n)
{
    if (i < 1 || i > n - 2) {
        return (float)i;
    }
    const float bend = grey[i - 1] - 2.f * grey[i] + grey[i + 1];
    return bend > 0.f ? (float)i + 0.5f * (grey[i - 1] - grey[i + 1]) / bend : (float)i;
}

int first_valley(const view_t *view, vec2_t from, vec2_t unit, float reach, float least,
                 valley_t *valley)
{
    float grey[PROBE_MAX];
    const int wanted = reach < PROBE_MAX ? (int)reach : PROBE_MAX;
    const int n = read_probe(view, from, unit, wanted, grey);
    float white = 0.f;
    for (int i = 0, lowest = -1; i < n; ++i) {
        white = grey[i] > white ? grey[i] : white;
        if (lowest < 0 ? grey[i] < (1.f - least) * white : grey[i] < grey[lowest]) {
            lowest = i;
        }
        /* White again, by half of the depth: the valley lies behind. */
        if (lowest >= 0 && grey[i] > grey[lowest] + 0.5f * (white - grey[lowest])) {
            valley->at = vertex(grey, lowest, n);
            valley->depth = white - grey[lowest];
            valley->white = white;
            return 1;
        }
    }
    return 0;
}

int nearest_valley(const view_t *view, vec2_t middle, vec2_t unit, float reach, float least,
                   valley_t *valley)
{
    float grey[PROBE_MAX];
    const int half = reach < PROBE_MAX / 2 - 1 ? (int)reach : PROBE_MAX / 2 - 1;
    const int wanted = 2 * half + 1;
    const int n = read_probe(view, vec2_add(middle, unit, (float)-half), unit, wanted, grey);
    if (n < wanted) {
        return 0;
    }
    int lowest = 1;
    for (int i = 2; i < n - 1; ++i) {
        lowest = grey[i] < grey[lowest] ? i : lowest;
    }
    float left = 0.f, right = 0.f;
    for (int i = 0; i < n; ++i) {
        float *side = i < lowest ? &left : &right;
        *side = grey[i] > *side ? grey[i] : *side;
    }
    valley->white = left < right ? left : right;
    valley->depth = valley->white - grey[lowest];
    valley->at = vertex(grey, lowest, n) - (float)half;
    return valley->depth > least * valley->white;
}

