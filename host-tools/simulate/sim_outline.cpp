/* SPDX-License-Identifier: Apache-2.0 */
/* The cone that is kept is a pyramid of 24 sides inside the fold, wider than the picture where the
 * lens allows; cutting at a plane through the camera keeps straight edges straight. */
#include "sim_outline.hpp"

#include <algorithm>
#include <cmath>

namespace opms::simulate
{
namespace
{

constexpr int SIDES = 24;
constexpr double CHORD_PX = 1e-4;
constexpr double SURELY_STRAIGHT_PX = 8; /* longer chords are divided without a look */
constexpr int DEPTH_MAX = 14;
constexpr double BESIDE = 1.25; /* how much wider than the picture the cone is */

double widest_ray(const Camera &camera, double fold)
{
    double widest = 0;
    for (int i = 0; i <= 32; ++i) {
        const double u = (camera.width - 1) * i / 32.0, v = (camera.height - 1) * i / 32.0;
        for (const cv::Vec2d &px : {cv::Vec2d(u, -0.5), cv::Vec2d(u, camera.height - 0.5),
                                    cv::Vec2d(-0.5, v), cv::Vec2d(camera.width - 0.5, v)}) {
            cv::Vec2d n;
            widest = std::max(widest, undistort(camera, px, n) ? cv::norm(n) : fold);
        }
    }
    return widest;
}

double area(const std::vector<cv::Vec2d> &corners)
{
    double twice = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const cv::Vec2d &a = corners[i], &b = corners[(i + 1) % corners.size()];
        twice += a[0] * b[1] - a[1] * b[0];
    }
    return twice / 2;
}

} // namespace

Projector::Projector(const Camera &camera) : camera_(camera)
{
    const double fold = fold_radius(camera);
    radius_ = std::min(fold * 0.9999, widest_ray(camera, fold) * BESIDE + 0.05);
    for (int i = 0; i < SIDES; ++i) {
        const double a = 2 * PI * i / SIDES;
        sides_.emplace_back(-std::cos(a), -std::sin(a), radius_ * std::cos(PI / SIDES));
    }
}

bool Projector::point(const cv::Vec3d &p, cv::Vec2d &px) const
{
    if (p[2] <= 1e-9 || std::hypot(p[0], p[1]) > radius_ * p[2]) {
        return false;
    }
    px = distort(camera_, {p[0] / p[2], p[1] / p[2]});
    return true;
}

std::vector<cv::Vec3d> Projector::cut(std::vector<cv::Vec3d> corners) const
{
    for (const cv::Vec3d &side : sides_) {
        std::vector<cv::Vec3d> kept;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const cv::Vec3d &a = corners[i], &b = corners[(i + 1) % corners.size()];
            const double in_a = side.dot(a), in_b = side.dot(b);
            if (in_a >= 0) {
                kept.push_back(a);
            }
            if ((in_a >= 0) != (in_b >= 0)) {
                kept.push_back(a + (b - a) * (in_a / (in_a - in_b)));
            }
        }
        corners = std::move(kept);
    }
    return corners;
}

void Projector::divide(const cv::Vec3d &a, const cv::Vec3d &b, const cv::Vec2d &at_a,
                       const cv::Vec2d &at_b, int depth, std::vector<cv::Vec2d> &out) const
{
    /* Half way in space, so that an edge shared by two polygons is divided alike from both. */
    const cv::Vec3d middle = (a + b) * 0.5;
    const cv::Vec2d at = distort(camera_, {middle[0] / middle[2], middle[1] / middle[2]});
    const cv::Vec2d chord = at_b - at_a, off = at - at_a;
    const double length = cv::norm(chord);
    const double cross = std::abs(chord[0] * off[1] - chord[1] * off[0]);
    if (depth < DEPTH_MAX && length > 1e-6 &&
        (length > SURELY_STRAIGHT_PX || cross > CHORD_PX * length)) {
        divide(a, middle, at_a, at, depth + 1, out);
        out.push_back(at);
        divide(middle, b, at, at_b, depth + 1, out);
    }
}

Outline Projector::outline(const std::vector<cv::Vec3d> &corners) const
{
    const std::vector<cv::Vec3d> kept = cut(corners);
    Outline outline;
    if (kept.size() < 3) {
        return outline;
    }
    std::vector<cv::Vec2d> px;
    for (const cv::Vec3d &p : kept) {
        px.push_back(p[2] > 0 ? distort(camera_, {p[0] / p[2], p[1] / p[2]})
                              : cv::Vec2d(camera_.cx, camera_.cy));
    }
    for (std::size_t i = 0; i < kept.size(); ++i) {
        const std::size_t next = (i + 1) % kept.size();
        outline.corners.push_back(px[i]);
        divide(kept[i], kept[next], px[i], px[next], 0, outline.corners);
    }
    if (area(outline.corners) < 0) {
        std::reverse(outline.corners.begin(), outline.corners.end());
    }
    cv::Vec2d low = px[0], high = px[0];
    for (const cv::Vec2d &p : outline.corners) {
        low = {std::min(low[0], p[0]), std::min(low[1], p[1])};
        high = {std::max(high[0], p[0]), std::max(high[1], p[1])};
    }
    outline.box = {low[0], low[1], high[0] - low[0], high[1] - low[1]};
    return outline;
}

} // namespace opms::simulate
