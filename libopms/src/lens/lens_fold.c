/* SPDX-License-Identifier: Apache-2.0 */
/* The distortion is the gradient of a potential, so its Jacobian is symmetric; it is the identity
 * on the axis. A map with a positive definite symmetric Jacobian is one-to-one, and on the way out
 * the first eigenvalue to reach zero takes the determinant with it. So the fold along a direction
 * is the first positive root of the determinant. In the frame of the direction e, at distance s,
 * with a = p2 ex + p1 ey and b = p1 ex - p2 ey,
 *   det(s) = (1 + 6 a s + 3 k1 s^2 + 5 k2 s^4) (1 + 2 a s + k1 s^2 + k2 s^4) - 4 b^2 s^2,
 * a polynomial of degree 8. Whether it is positive on [0, s] is decided without root finding from
 * its Bernstein coefficients: all positive proves it, a value at an end refutes it, else halve. */
#include "lens/lens_fold.h"

#include <math.h>

#define DEGREE 8
#define DEPTH_MAX 40

/* Cheap proof for the common case: bound every negative term by its value at the far end. */
static int plainly_inside(const opms_lens_t *lens, double s)
{
    const double s2 = s * s;
    const double radial = 3.0 * fmin(lens->k1, 0.0) + 5.0 * fmin(lens->k2, 0.0) * s2;
    return 1.0 + radial * s2 - 8.0 * (fabs(lens->p1) + fabs(lens->p2)) * s > 0.0;
}

/* Monomial coefficients of det over the parameter s/length in [0, 1]. */
static void determinant(const opms_lens_t *lens, double ex, double ey, double length,
                        double c[DEGREE + 1])
{
    const double a = (lens->p2 * ex + lens->p1 * ey) * length;
    const double b = (lens->p1 * ex - lens->p2 * ey) * length;
    const double k1 = lens->k1 * length * length;
    const double k2 = lens->k2 * length * length * length * length;
    const double along[5] = {1.0, 6.0 * a, 3.0 * k1, 0.0, 5.0 * k2};
    const double across[5] = {1.0, 2.0 * a, k1, 0.0, k2};
    for (int i = 0; i <= DEGREE; ++i) {
        c[i] = 0.0;
    }
    for (int i = 0; i < 5; ++i) {
        for (int j = 0; j < 5; ++j) {
            c[i + j] += along[i] * across[j];
        }
    }
    c[2] -= 4.0 * b * b;
}

/* b_i = sum_{j <= i} C(i, j) / C(n, j) c_j */
static void to_bernstein(double c[DEGREE + 1])
{
    static const double binomial[DEGREE + 1] = {1, 8, 28, 56, 70, 56, 28, 8, 1};
    for (int j = 0; j <= DEGREE; ++j) {
        c[j] /= binomial[j];
    }
    for (int level = 1; level <= DEGREE; ++level) {
        for (int i = DEGREE; i >= level; --i) {
            c[i] += c[i - 1];
        }
    }
}

/* De Casteljau at one half: `c` becomes the left half, `right` the right one. */
static void halve(double c[DEGREE + 1], double right[DEGREE + 1])
{
    for (int level = 0; level <= DEGREE; ++level) {
        right[DEGREE - level] = c[DEGREE];
        for (int i = DEGREE; i > level; --i) {
            c[i] = 0.5 * (c[i] + c[i - 1]);
        }
    }
}

static int all_positive(const double c[DEGREE + 1])
{
    for (int i = 0; i <= DEGREE; ++i) {
        if (!(c[i] > 0.0)) {
            return 0;
        }
    }
    return 1;
}

/* Depth first, nearest interval first; the pending right halves are a stack. */
static int positive_on_unit_interval(double c[DEGREE + 1])
{
    double pending[DEPTH_MAX][DEGREE + 1];
    int depth = 0;
    for (;;) {
        if (!(c[0] > 0.0) || !(c[DEGREE] > 0.0)) {
            return 0;
        }
        if (all_positive(c)) {
            if (depth == 0) {
                return 1;
            }
            --depth;
            for (int i = 0; i <= DEGREE; ++i) {
                c[i] = pending[depth][i];
            }
        } else {
            if (depth == DEPTH_MAX) {
                return 0; /* closer to zero than can be told apart from it */
            }
            halve(c, pending[depth]);
            ++depth;
        }
    }
}

int lens_inside_fold(const opms_lens_t *lens, double x, double y)
{
    const double s = hypot(x, y);
    if (!isfinite(s)) {
        return 0;
    }
    if (plainly_inside(lens, s)) {
        return 1;
    }
    double c[DEGREE + 1];
    determinant(lens, x / s, y / s, s, c);
    to_bernstein(c);
    return positive_on_unit_interval(c);
}
