/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Sets of points made of axis-parallel rectangles. */
#ifndef OPMS_SIMULATE_SIM_RECTS_HPP
#define OPMS_SIMULATE_SIM_RECTS_HPP

#include <vector>

#include "simulate/simulate.hpp"

namespace opms::simulate
{

/** The points of @p a that are not in @p b, as disjoint rectangles. Rectangles of either list may
 * overlap, so that subtract(a, {}) is the union of a. */
std::vector<Rect> subtract(const std::vector<Rect> &a, const std::vector<Rect> &b);
/** Every border of the set moved outwards by @p mm (inwards where negative); disjoint. */
std::vector<Rect> grow(const std::vector<Rect> &set, double mm);

} // namespace opms::simulate
#endif
