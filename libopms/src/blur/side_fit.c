/* SPDX-License-Identifier: Apache-2.0 */
/* Two unknowns, place and width; the levels are known from further off. Pixels are taken where they
 * are, so that an edge which crosses them at a slant is seen finer than they are wide. */
#include "blur/side_fit.h"

#include <math.h>

#define PIXELS_MOST 96
#define PIXELS_LEAST 10
#define ROUNDS 12
#define ROOT_HALF 0.70710678118654752
#define ROOT_2PI_INVERSE 0.39894228040143268
#define SIGMA_LEAST 0.15
#define RESIDUAL_MOST 0.12 /* of the contrast, rms: else something else is in the way */

#define WHITE_LEAST 0.82     /* beyond the side, of the contrast: less is a cell of the code */

typedef struct sample {
    float distance, level; /* outwards from the side, px; 0 black to 1 white */
} sample_t;

double grey_at(const view_t *view, const double px[2])
{
    return (double)view_bilinear(view, (float)px[0], (float)px[1]);
}

/* Is nothing black near enough to reach over to this side of the square? */
static int is_clear(const view_t *view, const side_line_t *side, double along, double least)
{
    const double px[2] = {
        side->middle[0] - side->normal[1] * along + side->normal[0] * side->beyond,
        side->middle[1] + side->normal[0] * along + side->normal[1] * side->beyond};
    return view_holds(view, px[0], px[1], 0.0) && grey_at(view, px) >= least;
}

/* Pixels of the strip along the side. Many are thinned out by rows. */
static int gather(const view_t *view, const side_line_t *side, double black, double white,
                  sample_t samples[PIXELS_MOST])
{
    const double *n = side->normal;
    const double reach_x = fabs(n[1]) * side->half_length +
                           fabs(n[0]) * fmax(side->inside, side->outside);
    const double reach_y = fabs(n[0]) * side->half_length +
                           fabs(n[1]) * fmax(side->inside, side->outside);
    const double area = 2 * side->half_length * (side->inside + side->outside);
    const int x0 = (int)ceil(side->middle[0] - reach_x), x1 = (int)(side->middle[0] + reach_x);
    const int y0 = (int)ceil(side->middle[1] - reach_y), y1 = (int)(side->middle[1] + reach_y);
    /* Whole lines across the side are left out, so that all distances stay alike in number. */
    const int step = 1 + (int)(area / (0.75 * PIXELS_MOST));
    const int down = fabs(n[0]) > fabs(n[1]);
    const int step_x = down ? 1 : step, step_y = down ? step : 1;
    const double least = black + WHITE_LEAST * (white - black);
    int count = 0;
    for (int y = y0; y <= y1; y += step_y) {
        for (int x = x0; x <= x1; x += step_x) {
            const double dx = x - side->middle[0], dy = y - side->middle[1];
            const double across = n[0] * dx + n[1] * dy, along = n[0] * dy - n[1] * dx;
            if (fabs(along) <= side->half_length && across >= -side->inside &&
                across <= side->outside && count < PIXELS_MOST &&
                (side->beyond == 0.0 || is_clear(view, side, along, least))) {
                samples[count].distance = (float)across;
                samples[count].level = (float)((view_at(view, x, y) - black) / (white - black));
                ++count;
            }
        }
    }
    return count;
}

double side_fit(const view_t *view, const side_line_t *side, double black, double white)
{
    sample_t samples[PIXELS_MOST];
    const int count = gather(view, side, black, white, samples);
    if (count < PIXELS_LEAST) {
        return 0.0;
    }
    double place = 0.0, sigma = 0.8, squares = 0.0;
    for (int round = 0; round < ROUNDS; ++round) {
        double pp = 1e-9, ps = 0, ss = 1e-9, pr = 0, sr = 0;
        squares = 0.0;
        for (int i = 0; i < count; ++i) {
            const double z = (samples[i].distance - place) / sigma;
            const double residual = samples[i].level - 0.5 * erfc(-z * ROOT_HALF);
            const double dp = -ROOT_2PI_INVERSE * exp(-0.5 * z * z) / sigma, ds = dp * z;
            pp += dp * dp;
            ps += dp * ds;
            ss += ds * ds;
            pr += dp * residual;
            sr += ds * residual;
            squares += residual * residual;
        }
        const double determinant = pp * ss - ps * ps;
        if (!(determinant > 0.0)) {
            return 0.0;
        }
        place += fmax(-0.5, fmin(0.5, (pr * ss - sr * ps) / determinant));
        const double step = (sr * pp - pr * ps) / determinant;
        sigma += fmax(-0.5 * sigma, fmin(sigma, step));
        sigma = fmax(sigma, SIGMA_LEAST);
        if (fabs(step) < 1e-3) {
            break;
        }
    }
    const int is_edge = squares < RESIDUAL_MOST * RESIDUAL_MOST * count &&
                        fabs(place) < 0.5 * side->inside && sigma < 2.0 * side->inside;
    return is_edge ? sigma : 0.0;
}
