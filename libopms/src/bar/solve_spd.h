/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Small symmetric positive definite systems, in place. */
#ifndef OPMS_BAR_SOLVE_SPD_H
#define OPMS_BAR_SOLVE_SPD_H

/** Factor the lower triangle of the n x n row-major `a` into L L^T. 0 if not positive definite. */
int spd_factor(double *a, int n);

/** Solve L L^T x = b with the factor of spd_factor(), b in and x out. */
void spd_solve(const double *l, int n, double *b);

#endif
