/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Products of columns among each other, summed over many rows: where a calibration spends its
 * time. */
#ifndef OPMS_CALIB_GRAM_SUMS_H
#define OPMS_CALIB_GRAM_SUMS_H

#ifdef __cplusplus
extern "C" {
#endif

#define GRAM_ROWS 32 /**< that are handed in at a time: all columns of them stay in the cache */

/** Add up. The order of the sums is the same on every machine.
 *
 * @param columns  `count` of them, GRAM_ROWS numbers each; rows that do not count are 0
 * @param count    even
 * @param gram     count x count; the upper triangle is summed up, the lower one may be anything */
void gram_add(const double *columns, int count, double *gram);

#ifdef __cplusplus
}
#endif
#endif
