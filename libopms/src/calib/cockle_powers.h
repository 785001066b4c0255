/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The terms x^i y^j of a target's height, lowest degree first: a plane's own belong to the pose. */
#ifndef OPMS_CALIB_COCKLE_POWERS_H
#define OPMS_CALIB_COCKLE_POWERS_H

#include <opms/calib.h>

#define COCKLE_DEGREE 4

static const int COCKLE_POWERS[OPMS_CALIB_COCKLE_TERMS][2] = {
    {2, 0}, {1, 1}, {0, 2}, {3, 0}, {2, 1}, {1, 2}, {0, 3}, {4, 0}, {3, 1}, {2, 2}, {1, 3}, {0, 4}};

#endif
