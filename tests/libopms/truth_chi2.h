/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How far an error is from zero in units of a stated covariance. */
#ifndef OPMS_TRUTH_CHI2_H
#define OPMS_TRUTH_CHI2_H

#include <math.h>

#include <unity.h>

#define TRUTH_CHI2_MAX 14 /**< largest n */

/** x^T C^-1 x by Cholesky, C n x n and row-major with `stride` values a row; fails the test where C
 * is not positive definite. */
static inline double truth_chi2(const double *c, int stride, const double *x, int n)
{
    double l[TRUTH_CHI2_MAX][TRUTH_CHI2_MAX], y[TRUTH_CHI2_MAX], sum = 0.0;
    for (int i = 0; i < n; ++i) {
        y[i] = x[i];
        for (int j = 0; j <= i; ++j) {
            l[i][j] = c[stride * i + j];
            for (int k = 0; k < j; ++k) {
                l[i][j] -= l[i][k] * l[j][k];
            }
            if (j < i) {
                l[i][j] /= l[j][j];
                y[i] -= l[i][j] * y[j];
            }
        }
        TEST_ASSERT_TRUE(l[i][i] > 0.0);
        l[i][i] = sqrt(l[i][i]);
        y[i] /= l[i][i];
        sum += y[i] * y[i];
    }
    return sum;
}

#endif
