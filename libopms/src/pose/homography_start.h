/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A linear start: the homography from the bar's plane to the rays. */
#ifndef OPMS_POSE_HOMOGRAPHY_START_H
#define OPMS_POSE_HOMOGRAPHY_START_H

#include "pose/edge_set.h"

namespace opms::pose
{

/** The plane seen near the middle of the edges: all that a planar pose needs. */
struct PlaneView {
    double centre_m[2]; /**< bar point */
    double ray[2];      /**< its ray (x, y) */
    double jac[4];      /**< row-major d(x, y)/d(X, Y) there, per metre */
    double shift_px;    /**< common outward shift of the edges */
};

/** Fit the homography to the first n edges, robustly.
 *
 * @return false where the edges do not determine it. */
bool homography_start(const EdgeSet &set, uint32_t n, const opms_edge_t *edges, PlaneView &view);

} // namespace opms::pose
#endif
