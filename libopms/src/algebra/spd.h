/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Small symmetric positive definite matrices, n x n and row-major, by Cholesky's factors: plain
 * loops, because a solver unrolled for every size costs the library more code than it saves time.
 * `least` is the smallest pivot, in parts of its diagonal element, that still counts as one: what
 * the unknowns before it leave open. */
#ifndef OPMS_ALGEBRA_SPD_H
#define OPMS_ALGEBRA_SPD_H

#ifdef __cplusplus
extern "C" {
#endif

#define SPD_SIZE_MAX 20 /**< largest n where it is said */
#define SPD_PIVOT_LEAST 1e-14 /**< rounding, and hardly more */

/** Factor the lower triangle of `a` into L L^T, in place. 0 where a pivot is too small. */
int spd_factor(double *a, int n, double least);

/** Solve L L^T x = b with the factor of spd_factor(), b in and x out. */
void spd_solve(const double *l, int n, double *b);

/** Solve a x = b for unknowns that may differ by any number of orders: in units in which the
 * diagonal is 1, to which `damping` is added. Only the lower triangle of `a` is read, and spoilt;
 * n <= SPD_SIZE_MAX.
 * @return 0 where a pivot is too small or x is not finite. */
int spd_solve_scaled(double *a, int n, double damping, double least, double *b);

/** Invert `a`, n <= SPD_SIZE_MAX, in place; only its lower triangle is read, all of it is written.
 * The unknowns may differ by any number of orders.
 * @return 0 where a pivot is too small or the inverse is not finite; `a` then is spoilt. */
int spd_invert(double *a, int n, double least);

#ifdef __cplusplus
}
#endif
#endif
