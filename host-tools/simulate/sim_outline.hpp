/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Plane polygons in space to polygons in the picture. */
#ifndef OPMS_SIMULATE_SIM_OUTLINE_HPP
#define OPMS_SIMULATE_SIM_OUTLINE_HPP

#include <vector>

#include "simulate/simulate.hpp"

namespace opms::simulate
{

/** A polygon in pixels and the box about it; corners so that its area is positive. */
struct Outline {
    std::vector<cv::Vec2d> corners;
    cv::Rect2d box;
    bool empty() const
    {
        return corners.empty();
    }
};

/** Projects polygons through a lens. Straight edges become curves: they are divided until no chord
 * is 1e-4 px off. What lies behind the camera or beyond the fold of the lens is cut away before. */
class Projector
{
  public:
    explicit Projector(const Camera &camera);

    /** @param corners in the camera's frame, m. */
    Outline outline(const std::vector<cv::Vec3d> &corners) const;
    /** Picture of one point; false where the camera cannot see in that direction. */
    bool point(const cv::Vec3d &p, cv::Vec2d &px) const;

  private:
    void divide(const cv::Vec3d &a, const cv::Vec3d &b, const cv::Vec2d &at_a,
                const cv::Vec2d &at_b, int depth, std::vector<cv::Vec2d> &out) const;
    std::vector<cv::Vec3d> cut(std::vector<cv::Vec3d> corners) const;

    Camera camera_;
    double radius_;
    std::vector<cv::Vec3d> sides_; /**< of the cone of view: inside where the product is >= 0 */
};

} // namespace opms::simulate
#endif
