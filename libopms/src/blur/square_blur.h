/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Blur of one square in all directions of the picture. */
#ifndef OPMS_BLUR_SQUARE_BLUR_H
#define OPMS_BLUR_SQUARE_BLUR_H

#include <opms/bar.h>

#include "image/view.h"

typedef struct square_blur {
    int32_t index;
    float across[2];          /**< px, across the sides along Y and along X */
    float cov_uu, cov_uv, cov_vv; /**< covariance of what a point becomes, px^2 */
} square_blur_t;

/** @return 0 where the square cannot be measured. */
int square_blur_measure(const view_t *view, const opms_square_t *square, square_blur_t *blur);

#endif
