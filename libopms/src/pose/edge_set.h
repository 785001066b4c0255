/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Edges as the pose stage works on them: straight lines among the rays.
 *
 * The line n.(p - q) = 0 in the picture becomes m.(x - x_q) = 0 among the normalised rays, where
 * x_q is the ray of q, J the derivative of the lens there and m = J^T n. The side of a square is
 * straight in rays and bent in the picture, so q may sit anywhere along it. m.(x_q - x) is the
 * distance in pixels; here it is divided by the edge's sigma. */
#ifndef OPMS_POSE_EDGE_SET_H
#define OPMS_POSE_EDGE_SET_H

#include <cstdint>

#include <opms/bar.h>
#include <opms/types.h>

#include "pose/pose_algebra.h"

namespace opms::pose
{

/** Camera to bar, and the common outward shift of the edges. */
struct Placement {
    Mat3 R;
    Vec3 t;
    double shift_px;
};

/** Edges in an order of our own: the first `sample` are spread over all of them, so that a
 * start can be sought among few. Kept as columns for the vector unit, which takes four at a time:
 * there is room for three empty edges more. */
struct EdgeSet {
    static constexpr uint32_t CAPACITY = OPMS_BAR_EDGES_MAX + 4;
    uint32_t count;
    uint32_t sample;
    uint16_t order[CAPACITY]; /**< caller's index of each edge */
    alignas(32) double X[CAPACITY];
    alignas(32) double Y[CAPACITY];
    alignas(32) double mx[CAPACITY]; /**< m / sigma */
    alignas(32) double my[CAPACITY];
    alignas(32) double c[CAPACITY];  /**< m.x_q / sigma */
    alignas(32) double is[CAPACITY]; /**< the edge's part in the shift / sigma */
    double sigma_px[CAPACITY];
};

/** Choose the order; no edge is taken over yet. */
void edge_set_init(EdgeSet &set, uint32_t count);

/** Take over the edges from (inclusive) to (exclusive), in the set's order.
 *
 * @param guess  Null, or a placement near the solution, which makes it faster.
 * An edge that no ray of the lens reaches becomes an outlier. */
void edge_set_fill(EdgeSet &set, const opms_lens_t &lens, const opms_edge_t *edges, uint32_t from,
                   uint32_t to, const Placement *guess);

} // namespace opms::pose
#endif
