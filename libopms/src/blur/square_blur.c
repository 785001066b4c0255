/* SPDX-License-Identifier: Apache-2.0 */
/* A square lies in a corner's quadrant. Blurred, the corner's own level is the part of the blurred
 * point that falls into the quadrant: 1/4 + asin(r) / 2 pi of a normal distribution whose
 * components across the two sides have the correlation r. Neighbouring corners see r with opposite
 * signs, so their difference is free of what all four have in common. */
#include "blur/square_blur.h"

#include <math.h>
#include <string.h>

#include "algebra/median.h"
#include "blur/side_fit.h"

#define PI 3.14159265358979324
#define ROOT_HALF 0.70710678118654752
#define INSIDE 0.55      /* half squares from a side: 5.5 mm of black */
#define OUTSIDE_X 0.3    /* 3 mm of the 5 to the bar's border */
#define OUTSIDE_Y 0.5    /* 5 mm of the 10 to the next square, where no cell is black */
#define ALONG 0.6        /* of a side, so that its corners have no part in it */
#define BEYOND 0.5       /* 5 mm: the middle of the code's cells */
#define WHITE_X 1.24     /* half squares: in the middle between the side and the bar's border */
#define WHITE_OUT 0.24
#define LEVELS 15        /* samples of black, and of white on each side */
#define BLACK_MOST 0.35
#define SATURATED 0.995
#define SATURATED_MOST 0.1
#define CONTRAST_LEAST 0.04
#define HALF_LEAST 3.0   /* px: a square that is smaller shows no sides */
#define PARALLEL 0.3     /* sine of the angle between the sides */

static const double CORNER[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};

/* The place (x, y) of a square in half squares, corners at -1 and 1. */
static void place_of(const opms_square_t *square, double x, double y, double px[2])
{
    px[0] = px[1] = 0.0;
    for (int c = 0; c < 4; ++c) {
        const double weight = 0.25 * (1.0 + CORNER[c][0] * x) * (1.0 + CORNER[c][1] * y);
        px[0] += weight * square->corners_px[c][0];
        px[1] += weight * square->corners_px[c][1];
    }
}

static int is_in_picture(const view_t *view, const opms_square_t *square)
{
    double px[2];
    for (int c = 0; c < 4; ++c) {
        place_of(square, 1.4 * CORNER[c][0], 1.4 * CORNER[c][1], px);
        if (!(px[0] >= 1 && px[1] >= 1 && px[0] <= view->width - 2 && px[1] <= view->height - 2)) {
            return 0; /* also where a corner is not finite */
        }
    }
    return 1;
}

typedef struct levels {
    double black, white[2]; /* white beyond X = -10 mm and X = +10 mm */
} levels_t;

static int measure_levels(const view_t *view, const opms_square_t *square, levels_t *levels)
{
    float grey[LEVELS];
    double px[2];
    for (int i = 0; i < LEVELS; ++i) {
        place_of(square, BLACK_MOST * ((i % 5) / 2.0 - 1.0), BLACK_MOST * ((i / 5) - 1.0), px);
        grey[i] = (float)grey_at(view, px);
    }
    levels->black = median_of(grey, LEVELS);
    for (int side = 0; side < 2; ++side) {
        int saturated = 0;
        for (int i = 0; i < LEVELS; ++i) {
            place_of(square, side ? WHITE_X : -WHITE_X, 0.8 * (2.0 * i / (LEVELS - 1) - 1.0), px);
            grey[i] = (float)grey_at(view, px);
            saturated += grey[i] >= SATURATED * view->white_level;
        }
        levels->white[side] = median_of(grey, LEVELS);
        if (saturated > SATURATED_MOST * LEVELS ||
            levels->white[side] - levels->black < CONTRAST_LEAST * view->white_level) {
            return 0;
        }
    }
    return 1;
}

/* Side 0: X = -10 mm, 1: Y = -10 mm, 2: X = +10 mm, 3: Y = +10 mm. @return Half a square's depth
 * behind it in px, 0 where it is too small. */
static double line_of(const opms_square_t *square, int side, side_line_t *line)
{
    const double sign = side < 2 ? -1.0 : 1.0;
    const int along_y = side % 2 == 0;
    double a[2], b[2], centre[2];
    place_of(square, along_y ? sign : -1.0, along_y ? -1.0 : sign, a);
    place_of(square, along_y ? sign : 1.0, along_y ? 1.0 : sign, b);
    place_of(square, 0.0, 0.0, centre);
    const double dx = b[0] - a[0], dy = b[1] - a[1], length = sqrt(dx * dx + dy * dy);
    line->middle[0] = 0.5 * (a[0] + b[0]);
    line->middle[1] = 0.5 * (a[1] + b[1]);
    line->normal[0] = dy / length;
    line->normal[1] = -dx / length;
    double depth = line->normal[0] * (line->middle[0] - centre[0]) +
                   line->normal[1] * (line->middle[1] - centre[1]);
    if (depth < 0.0) {
        depth = -depth;
        line->normal[0] = -line->normal[0];
        line->normal[1] = -line->normal[1];
    }
    line->half_length = 0.5 * ALONG * length;
    line->inside = INSIDE * depth;
    line->outside = (along_y ? OUTSIDE_X : OUTSIDE_Y) * depth;
    line->beyond = along_y ? 0.0 : BEYOND * depth;
    return depth >= HALF_LEAST && length >= 2.0 * HALF_LEAST ? depth : 0.0;
}

/* Mean blur across the two sides along Y (along 0) or along X (1); 0 where neither shows it. */
static double measure_pair(const view_t *view, const opms_square_t *square,
                           const levels_t *levels, int along, double normal[2], double *depth)
{
    double sum = 0.0;
    int count = 0;
    for (int end = 0; end < 2; ++end) {
        side_line_t line;
        *depth = line_of(square, along + 2 * end, &line);
        if (*depth == 0.0) {
            return 0.0;
        }
        const double white =
            along == 0 ? levels->white[end] : 0.5 * (levels->white[0] + levels->white[1]);
        const double fitted = side_fit(view, &line, levels->black, white);
        sum += fitted;
        count += fitted > 0.0;
        memcpy(normal, line.normal, sizeof line.normal); /* in the end that of the + side */
    }
    return count > 0 ? sum / count : 0.0;
}

/* What of the square's black reaches to where the white was measured is made good. */
static void correct_levels(levels_t *levels, double sigma, double depth)
{
    const double part = 1.0 - 0.5 * erfc(WHITE_OUT * depth / sigma * ROOT_HALF);
    for (int side = 0; side < 2; ++side) {
        levels->white[side] = levels->black + (levels->white[side] - levels->black) / part;
    }
}

/* Blur across the sides along Y, and along X. */
static int measure_sides(const view_t *view, const opms_square_t *square, levels_t *levels,
                         double sigma[2], double normal[2][2])
{
    double depth = 0.0;
    sigma[0] = measure_pair(view, square, levels, 0, normal[0], &depth);
    if (sigma[0] == 0.0) {
        return 0;
    }
    correct_levels(levels, sigma[0], depth);
    sigma[0] = measure_pair(view, square, levels, 0, normal[0], &depth);
    sigma[1] = measure_pair(view, square, levels, 1, normal[1], &depth);
    return sigma[0] > 0.0 && sigma[1] > 0.0;
}

/* Correlation of the blur's components along the normals of the + sides. */
static double corner_correlation(const view_t *view, const opms_square_t *square,
                                 const levels_t *levels)
{
    double difference = 0.0;
    for (int c = 0; c < 4; ++c) {
        const double *px = square->corners_px[c];
        const double white = levels->white[CORNER[c][0] > 0];
        const double grey = grey_at(view, px);
        const double black_part = (white - grey) / (white - levels->black);
        difference += CORNER[c][0] * CORNER[c][1] * black_part;
    }
    const double angle = 0.5 * PI * difference; /* of two corners each */
    return sin(fmax(-0.5 * PI, fmin(0.5 * PI, angle)));
}

int square_blur_measure(const view_t *view, const opms_square_t *square, square_blur_t *blur)
{
    levels_t levels;
    double sigma[2], normal[2][2];
    if (!is_in_picture(view, square) || !measure_levels(view, square, &levels) ||
        !measure_sides(view, square, &levels, sigma, normal)) {
        return 0;
    }
    const double *p = normal[0], *q = normal[1];
    const double sine = p[0] * q[1] - p[1] * q[0];
    if (fabs(sine) < PARALLEL) {
        return 0;
    }
    const double limit = 0.95 * sigma[0] * sigma[1];
    const double mixed = fmax(-limit, fmin(limit, corner_correlation(view, square, &levels) *
                                                      sigma[0] * sigma[1]));
    /* p'C p, q'C q and p'C q are known: C = N^-1 S N^-T with the normals as rows of N. */
    const double a[2] = {q[1] / sine, -p[1] / sine}, b[2] = {-q[0] / sine, p[0] / sine};
    const double s0 = sigma[0] * sigma[0], s1 = sigma[1] * sigma[1];
    blur->index = square->index;
    blur->across[0] = (float)sigma[0];
    blur->across[1] = (float)sigma[1];
    blur->cov_uu = (float)(a[0] * a[0] * s0 + 2 * a[0] * a[1] * mixed + a[1] * a[1] * s1);
    blur->cov_vv = (float)(b[0] * b[0] * s0 + 2 * b[0] * b[1] * mixed + b[1] * b[1] * s1);
    blur->cov_uv = (float)(a[0] * b[0] * s0 + (a[0] * b[1] + a[1] * b[0]) * mixed +
                           a[1] * b[1] * s1);
    return 1;
}
