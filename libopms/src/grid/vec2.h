/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Points and directions in the picture. */
#ifndef OPMS_GRID_VEC2_H
#define OPMS_GRID_VEC2_H

#include <math.h>

/** A point or direction in the picture. */
typedef struct vec2 {
    float x, y;
} vec2_t;

static inline vec2_t vec2_add(vec2_t a, vec2_t b, float part)
{
    const vec2_t sum = {a.x + part * b.x, a.y + part * b.y};
    return sum;
}

static inline vec2_t vec2_between(vec2_t from, vec2_t to)
{
    const vec2_t way = {to.x - from.x, to.y - from.y};
    return way;
}

static inline float vec2_length(vec2_t a)
{
    return sqrtf(a.x * a.x + a.y * a.y);
}

static inline float vec2_cross(vec2_t a, vec2_t b)
{
    return a.x * b.y - a.y * b.x;
}

#endif
