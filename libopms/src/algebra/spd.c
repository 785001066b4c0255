/* SPDX-License-Identifier: Apache-2.0 */
#include "algebra/spd.h"

#include <math.h>
#include <string.h>

int spd_factor(double *a, int n, double least)
{
    for (int j = 0; j < n; ++j) {
        const double whole = a[j * n + j];
        double d = whole;
        for (int k = 0; k < j; ++k) {
            d -= a[j * n + k] * a[j * n + k];
        }
        if (!(d > least * whole)) {
            return 0;
        }
        d = sqrt(d);
        a[j * n + j] = d;
        for (int i = j + 1; i < n; ++i) {
            double s = a[i * n + j];
            for (int k = 0; k < j; ++k) {
                s -= a[i * n + k] * a[j * n + k];
            }
            a[i * n + j] = s / d;
        }
    }
    return 1;
}

void spd_solve(const double *l, int n, double *b)
{
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < i; ++k) {
            b[i] -= l[i * n + k] * b[k];
        }
        b[i] /= l[i * n + i];
    }
    for (int i = n - 1; i >= 0; --i) {
        for (int k = i + 1; k < n; ++k) {
            b[i] -= l[k * n + i] * b[k];
        }
        b[i] /= l[i * n + i];
    }
}

/* To units in which the diagonal is 1: pixels, radians and metres differ by orders. */
static int scale_to_units(double *a, int n, double *unit)
{
    for (int i = 0; i < n; ++i) {
        if (!(a[i * n + i] > 0.0)) {
            return 0;
        }
        unit[i] = 1.0 / sqrt(a[i * n + i]);
    }
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j <= i; ++j) {
            a[i * n + j] *= unit[i] * unit[j];
        }
    }
    return 1;
}

int spd_solve_scaled(double *a, int n, double damping, double least, double *b)
{
    double unit[SPD_SIZE_MAX];
    if (!scale_to_units(a, n, unit)) {
        return 0;
    }
    for (int i = 0; i < n; ++i) {
        a[i * n + i] += damping;
        b[i] *= unit[i];
    }
    if (!spd_factor(a, n, least)) {
        return 0;
    }
    spd_solve(a, n, b);
    int finite = 1;
    for (int i = 0; i < n; ++i) {
        b[i] *= unit[i];
        finite = finite && isfinite(b[i]);
    }
    return finite;
}

int spd_invert(double *a, int n, double least)
{
    double unit[SPD_SIZE_MAX], factor[SPD_SIZE_MAX * SPD_SIZE_MAX], column[SPD_SIZE_MAX];
    if (!scale_to_units(a, n, unit) || !spd_factor(a, n, least)) {
        return 0;
    }
    memcpy(factor, a, (size_t)(n * n) * sizeof *factor);
    for (int j = 0; j < n; ++j) {
        memset(column, 0, (size_t)n * sizeof *column);
        column[j] = 1.0;
        spd_solve(factor, n, column);
        for (int i = j; i < n; ++i) {
            const double value = column[i] * unit[i] * unit[j];
            if (!isfinite(value)) {
                return 0;
            }
            a[i * n + j] = a[j * n + i] = value;
        }
    }
    return 1;
}
