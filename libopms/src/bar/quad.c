/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/quad.h"

#include <limits.h>
#include <math.h>
#include <string.h>

/* The contour is followed along the cracks between dark and light pixels. Each crack gives one
 * point: where the grey level, interpolated from the dark pixel to the light one, crosses the
 * threshold. So the points are subpixel and the path needs no table. */

static const int step_x[4] = {1, 0, -1, 0};
static const int step_y[4] = {0, 1, 0, -1};

static int is_inside(const view_t *view, int x, int y)
{
    return (unsigned)x < (unsigned)view->width && (unsigned)y < (unsigned)view->height;
}

static int is_dark(const view_t *view, int x, int y, float threshold)
{
    return is_inside(view, x, y) && (float)view_at(view, x, y) < threshold;
}

/** Grey level; light beyond the picture's border. */
static int level_at(const view_t *view, int x, int y)
{
    return is_inside(view, x, y) ? view_at(view, x, y) : INT_MAX;
}

/** Follow the contour with the dark side on the right; returns the number of points, 0 if it is
 * too long or meets the border of the picture. */
static int follow(const view_t *view, int x, int y, float threshold, int longest, point_t *points)
{
    while (x > 0 && is_dark(view, x - 1, y, threshold)) {
        --x;
    }
    if (x == 0) {
        return 0;
    }
    /* (x, y) is dark and its left neighbour light: heading up with the dark side on the right. A
     * step looks at two pixels at the most; the grey levels of the others are known. */
    const int x_start = x, y_start = y, limit = (int)ceilf(threshold);
    int heading = 3, count = 0, dark = view_at(view, x, y), light = view_at(view, x - 1, y);
    do {
        const int left = (heading + 3) & 3;
        if (!is_inside(view, x + step_x[left], y + step_y[left]) || count == longest) {
            return 0;
        }
        const float part = (threshold - (float)dark) / (float)(light - dark);
        points[count].x = (float)x + part * (float)step_x[left];
        points[count].y = (float)y + part * (float)step_y[left];
        ++count;
        const int ahead_x = x + step_x[heading], ahead_y = y + step_y[heading];
        const int ahead = level_at(view, ahead_x, ahead_y);
        if (ahead >= limit) {
            heading = (heading + 1) & 3; /* turn right around the same pixel */
            light = ahead;
            continue;
        }
        const int beside_x = ahead_x + step_x[left], beside_y = ahead_y + step_y[left];
        const int beside = level_at(view, beside_x, beside_y);
        if (beside < limit) {
            x = beside_x;
            y = beside_y;
            heading = left;
            dark = beside;
        } else {
            x = ahead_x;
            y = ahead_y;
            dark = ahead;
            light = beside;
        }
    } while (x != x_start || y != y_start || heading != 3);
    return count;
}

static float distance_sq(point_t a, point_t b)
{
    return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

static int farthest(const point_t *points, int count, point_t from)
{
    int best = 0;
    float most = -1.f;
    for (int i = 0; i < count; ++i) {
        const float d = distance_sq(points[i], from);
        if (d > most) {
            most = d;
            best = i;
        }
    }
    return best;
}

/** Index of the point farthest to the given side (+1 or -1) of the line a to b. */
static int farthest_beside(const point_t *points, int count, point_t a, point_t b, float side)
{
    int best = -1;
    float most = 0.f;
    for (int i = 0; i < count; ++i) {
        const float d =
            side * ((b.x - a.x) * (points[i].y - a.y) - (b.y - a.y) * (points[i].x - a.x));
        if (d > most) {
            most = d;
            best = i;
        }
    }
    return best;
}

typedef struct line {
    float nx, ny, c; /* nx x + ny y = c */
} line_t;

/** Total least squares through the contour points from index a to b (cyclic), without the parts
 * next to the corners; returns the RMS distance, or -1. */
static float fit_side(const point_t *points, int count, int a, int b, line_t *line)
{
    int n = b - a;
    if (n <= 0) {
        n += count;
    }
    const int skip = n < 8 ? 1 : n / 7;
    double sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
    int used = 0;
    const point_t origin = points[a];
    for (int i = skip; i <= n - skip; ++i) {
        int k = a + i;
        k -= k >= count ? count : 0;
        const double x = points[k].x - origin.x, y = points[k].y - origin.y;
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
        syy += y * y;
        ++used;
    }
    if (used < 3) {
        return -1.f;
    }
    sx /= used;
    sy /= used;
    sxx = sxx / used - sx * sx;
    sxy = sxy / used - sx * sy;
    syy = syy / used - sy * sy;
    const double half = 0.5 * (sxx - syy);
    const double root = sqrt(half * half + sxy * sxy);
    const double least = 0.5 * (sxx + syy) - root;
    /* Direction of largest spread; its normal is the line's. */
    double dx = half + root, dy = sxy;
    if (half < 0) {
        dx = sxy;
        dy = root - half;
    }
    const double norm = sqrt(dx * dx + dy * dy);
    if (!(norm > 0)) {
        return -1.f;
    }
    line->nx = (float)(-dy / norm);
    line->ny = (float)(dx / norm);
    line->c = (float)(line->nx * (sx + origin.x) + line->ny * (sy + origin.y));
    return (float)sqrt(least > 0 ? least : 0);
}

static int intersect(const line_t *a, const line_t *b, point_t *p)
{
    const float det = a->nx * b->ny - a->ny * b->nx;
    if (fabsf(det) < 0.05f) {
        return 0;
    }
    p->x = (a->c * b->ny - a->ny * b->c) / det;
    p->y = (a->nx * b->c - a->c * b->nx) / det;
    return 1;
}

static int fit_quad(const point_t *points, int count, float shortest_side, quad_t *quad)
{
    point_t mean = {0, 0};
    for (int i = 0; i < count; ++i) {
        mean.x += points[i].x;
        mean.y += points[i].y;
    }
    mean.x /= (float)count;
    mean.y /= (float)count;
    int index[4];
    index[0] = farthest(points, count, mean);
    index[2] = farthest(points, count, points[index[0]]);
    index[1] = farthest_beside(points, count, points[index[0]], points[index[2]], -1.f);
    index[3] = farthest_beside(points, count, points[index[0]], points[index[2]], 1.f);
    if (index[1] < 0 || index[3] < 0) {
        return 0;
    }
    line_t side[4];
    for (int i = 0; i < 4; ++i) {
        const int next = index[(i + 1) & 3];
        const float length = sqrtf(distance_sq(points[index[i]], points[next]));
        const float rms = fit_side(points, count, index[i], next, &side[i]);
        if (length < shortest_side * 0.8f || rms < 0 || rms > 0.35f + 0.02f * length) {
            return 0;
        }
    }
    for (int i = 0; i < 4; ++i) {
        if (!intersect(&side[(i + 3) & 3], &side[i], &quad->corner[i]) ||
            distance_sq(quad->corner[i], points[index[i]]) >
                9.f + 0.02f * distance_sq(points[index[0]], points[index[2]])) {
            return 0;
        }
    }
    quad->shortest = 1e9f;
    quad->longest = 0;
    quad->centre.x = quad->centre.y = 0;
    for (int i = 0; i < 4; ++i) {
        const point_t a = quad->corner[i], b = quad->corner[(i + 1) & 3],
                      c = quad->corner[(i + 2) & 3];
        const float length = sqrtf(distance_sq(a, b));
        if ((b.x - a.x) * (c.y - b.y) - (b.y - a.y) * (c.x - b.x) <= 0) {
            return 0; /* not convex, or not in the sense promised */
        }
        quad->shortest = length < quad->shortest ? length : quad->shortest;
        quad->longest = length > quad->longest ? length : quad->longest;
        quad->centre.x += 0.25f * a.x;
        quad->centre.y += 0.25f * a.y;
    }
    return quad->shortest >= shortest_side && quad->longest < 6.f * quad->shortest;
}

int quad_trace(const view_t *view, int x, int y, float threshold, const quad_limits_t *limits,
               point_t *points, quad_t *quad)
{
    if (!is_dark(view, x, y, threshold)) {
        return 0;
    }
    const int count = follow(view, x, y, threshold, limits->longest_contour, points);
    if (count < 16) {
        return 0;
    }
    return fit_quad(points, count, limits->shortest_side, quad);
}
