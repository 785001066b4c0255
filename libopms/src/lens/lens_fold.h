/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Where the distortion model stops being one-to-one. */
#ifndef OPMS_LENS_LENS_FOLD_H
#define OPMS_LENS_LENS_FOLD_H

#include <opms/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/** 1 where the Jacobian of the distortion is positive definite on the whole way from the optical
 * axis to the ray (x, y), so that the ray lies inside the fold; else 0. Not finite gives 0. */
int lens_inside_fold(const opms_lens_t *lens, double x, double y);

#ifdef __cplusplus
}
#endif
#endif
