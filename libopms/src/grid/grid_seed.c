/* SPDX-License-Identifier: Apache-2.0 */
/* Probes in many directions from a white point meet the four lines around it. Neighbouring hits
 * that lie in one line are of the same side; four sides, each with three hits at least, make a
 * cell, and neighbouring sides cross in its corners. */
#include "grid/grid_seed.h"

#define PROBES 32
#define LEAST_DEPTH 0.12f /* of the white: lines of 1.3 px under some blur */
#define REACH 110.f       /* px, to a line: cells of up to 150 px */
#define HITS_LEAST 3      /* of a side */

/* A straight line as the points x with normal . x = offset. */
typedef struct side {
    vec2_t normal;
    float offset;
    int hits;
} side_t;

static int probe_around(const view_t *view, vec2_t around, vec2_t hits[PROBES])
{
    int count = 0;
    for (int k = 0; k < PROBES; ++k) {
        const float angle = (float)k * 6.2831853f / PROBES;
        const vec2_t unit = {cosf(angle), sinf(angle)};
        valley_t valley;
        if (!first_valley(view, around, unit, REACH, LEAST_DEPTH, &valley)) {
            return 0; /* a cell is closed all around */
        }
        hits[count++] = vec2_add(around, unit, valley.at);
    }
    return count;
}

/* The line through two hits. */
static side_t side_through(vec2_t a, vec2_t b)
{
    const vec2_t along = {b.x - a.x, b.y - a.y};
    const float length = vec2_length(along);
    side_t side = {{-along.y / length, along.x / length}, 0.f, 0};
    side.offset = side.normal.x * a.x + side.normal.y * a.y;
    return side;
}

static float distance(const side_t *side, vec2_t point)
{
    return side->normal.x * point.x + side->normal.y * point.y - side->offset;
}

/* From the hit `first` on, how many follow in one line? A hit that is out of it ends the side. */
static int follow_side(const vec2_t hits[PROBES], int first, float tolerance, side_t *side)
{
    int count = 2;
    *side = side_through(hits[first % PROBES], hits[(first + 1) % PROBES]);
    while (count < PROBES / 2) {
        const vec2_t next = hits[(first + count) % PROBES];
        /* The chord gets longer and so better with each hit. */
        const side_t longer = side_through(hits[first % PROBES], next);
        const vec2_t middle = hits[(first + count / 2) % PROBES];
        if (fabsf(distance(&longer, middle)) > tolerance ||
            fabsf(distance(side, next)) > tolerance * (float)count) {
            break;
        }
        *side = longer;
        ++count;
    }
    side->hits = count;
    return count;
}

/* Four sides around: where one ends the next begins, perhaps after a hit in the corner. */
static int split_into_sides(const vec2_t hits[PROBES], int start, float tolerance, side_t sides[4])
{
    int at = start, found = 0;
    while (at < start + PROBES && found < 5) {
        side_t side;
        const int count = follow_side(hits, at, tolerance, &side);
        if (count < HITS_LEAST) {
            ++at;
            continue;
        }
        if (found == 4) {
            return 0;
        }
        sides[found++] = side;
        at += count;
    }
    return found == 4;
}

static int crossing(const side_t *a, const side_t *b, vec2_t *point)
{
    const float det = vec2_cross(a->normal, b->normal);
    if (fabsf(det) < 0.3f) {
        return 0;
    }
    point->x = (a->offset * b->normal.y - b->offset * a->normal.y) / det;
    point->y = (b->offset * a->normal.x - a->offset * b->normal.x) / det;
    return 1;
}

static int is_plausible(const grid_cell_t *cell, vec2_t around, float min_pitch)
{
    float lengths[4];
    for (int k = 0; k < 4; ++k) {
        const vec2_t a = cell->corner[k], b = cell->corner[(k + 1) % 4];
        const vec2_t side = {b.x - a.x, b.y - a.y}, to = {around.x - a.x, around.y - a.y};
        lengths[k] = vec2_length(side);
        if (lengths[k] < min_pitch || vec2_cross(side, to) <= 0.f) {
            return 0;
        }
    }
    for (int k = 0; k < 2; ++k) {
        const float ratio = lengths[k] / lengths[k + 2];
        if (ratio < 0.7f || ratio > 1.4f) {
            return 0;
        }
    }
    const float shape = lengths[0] / lengths[1];
    return shape > 0.3f && shape < 3.3f;
}

int find_cell(const view_t *view, vec2_t around, float min_pitch, grid_cell_t *cell)
{
    vec2_t hits[PROBES];
    if (!view_holds(view, around.x, around.y, 1.0) || !probe_around(view, around, hits)) {
        return 0;
    }
    const float tolerance = 0.8f;
    for (int start = 0; start < PROBES / 4; ++start) {
        side_t sides[4];
        int good = split_into_sides(hits, start, tolerance, sides);
        for (int k = 0; k < 4 && good; ++k) {
            good = crossing(&sides[(k + 3) % 4], &sides[k], &cell->corner[k]);
        }
        if (good && is_plausible(cell, around, min_pitch)) {
            return 1;
        }
    }
    return 0;
}
