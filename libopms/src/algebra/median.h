/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Medians of a few hundred numbers. */
#ifndef OPMS_ALGEBRA_MEDIAN_H
#define OPMS_ALGEBRA_MEDIAN_H

#ifdef __cplusplus
extern "C" {
#endif

/** The value of rank count / 2, count >= 1; the values end up in another order. */
float median_of(float *values, int count);

#ifdef __cplusplus
}
#endif

#endif
