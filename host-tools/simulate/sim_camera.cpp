/* SPDX-License-Identifier: Apache-2.0 */
/* The camera model of docs/conventions.md, forwards and backwards. */
#include <algorithm>
#include <cmath>

#include "simulate/simulate.hpp"

namespace opms::simulate
{
namespace
{

constexpr double RADIUS_MAX = 10; /* a view of 168 degrees; no lens of this model is wider */

struct Bent {
    cv::Vec2d at;
    cv::Matx22d by; /* derivative of at */
};

Bent bend(const Camera &c, const cv::Vec2d &n)
{
    const double x = n[0], y = n[1], r2 = x * x + y * y;
    const double g = 1 + r2 * (c.k1 + c.k2 * r2);
    const double g1 = 2 * (c.k1 + 2 * c.k2 * r2); /* dg/dx = g1 x, dg/dy = g1 y */
    Bent bent;
    bent.at = {x * g + 2 * c.p1 * x * y + c.p2 * (r2 + 2 * x * x),
               y * g + c.p1 * (r2 + 2 * y * y) + 2 * c.p2 * x * y};
    const double cross = x * y * g1 + 2 * c.p1 * x + 2 * c.p2 * y;
    bent.by = {g + x * x * g1 + 2 * c.p1 * y + 6 * c.p2 * x, cross, cross,
               g + y * y * g1 + 6 * c.p1 * y + 2 * c.p2 * x};
    return bent;
}

/** One to one all around at this radius: the derivative has not changed its sense. */
bool is_upright(const Camera &camera, double radius)
{
    constexpr int DIRECTIONS = 32;
    for (int i = 0; i < DIRECTIONS; ++i) {
        const double a = 2 * PI * i / DIRECTIONS;
        const cv::Matx22d by = bend(camera, {radius * std::cos(a), radius * std::sin(a)}).by;
        if (by(0, 0) * by(1, 1) - by(0, 1) * by(1, 0) <= 0 || by(0, 0) + by(1, 1) <= 0) {
            return false;
        }
    }
    return true;
}

} // namespace

cv::Matx33d rotation(const cv::Vec3d &w)
{
    const double angle = cv::norm(w);
    if (angle < 1e-15) {
        return cv::Matx33d::eye();
    }
    const cv::Vec3d k = w * (1 / angle);
    const cv::Matx33d K(0, -k[2], k[1], k[2], 0, -k[0], -k[1], k[0], 0);
    return cv::Matx33d::eye() + std::sin(angle) * K + (1 - std::cos(angle)) * (K * K);
}

Pose Camera::hope_mounting()
{
    const double c = std::cos(25 * RAD), s = std::sin(25 * RAD);
    return {cv::Matx33d(-c, 0, -s, 0, 1, 0, s, 0, -c), {-0.10, 0, 0.40}};
}

cv::Vec2d distort(const Camera &camera, const cv::Vec2d &normalised)
{
    const cv::Vec2d at = bend(camera, normalised).at;
    return {camera.fx * at[0] + camera.cx, camera.fy * at[1] + camera.cy};
}

double fold_radius(const Camera &camera)
{
    constexpr double STEP = 0.02;
    double inside = 0, outside = STEP;
    while (outside < RADIUS_MAX && is_upright(camera, outside)) {
        inside = outside;
        outside += STEP;
    }
    for (int i = 0; i < 40 && outside < RADIUS_MAX; ++i) {
        const double middle = (inside + outside) / 2;
        (is_upright(camera, middle) ? inside : outside) = middle;
    }
    return inside;
}

bool undistort(const Camera &camera, const cv::Vec2d &px, cv::Vec2d &normalised)
{
    const cv::Vec2d wanted((px[0] - camera.cx) / camera.fx, (px[1] - camera.cy) / camera.fy);
    /* Outwards along the ray: Newton from the centre meets the branch before the fold first. */
    cv::Vec2d n(0, 0);
    for (int part = 1; part <= 8; ++part) {
        const cv::Vec2d goal = wanted * (part / 8.0);
        for (int i = 0; i < (part < 8 ? 2 : 8); ++i) {
            const Bent bent = bend(camera, n);
            const double det = bent.by(0, 0) * bent.by(1, 1) - bent.by(0, 1) * bent.by(1, 0);
            if (!(det > 1e-9)) {
                return false;
            }
            const cv::Vec2d miss = goal - bent.at;
            n += cv::Vec2d(bent.by(1, 1) * miss[0] - bent.by(0, 1) * miss[1],
                           bent.by(0, 0) * miss[1] - bent.by(1, 0) * miss[0]) *
                 (1 / det);
        }
    }
    normalised = n;
    return cv::norm(bend(camera, n).at - wanted) < 1e-12 * (1 + cv::norm(wanted));
}

} // namespace opms::simulate
