/* SPDX-License-Identifier: Apache-2.0 */
#include "overlay_canvas.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace {

constexpr int SHIFT = 5; /* OpenCV draws at 1/32 px */
constexpr int FONT = cv::FONT_HERSHEY_SIMPLEX;
constexpr double CAPITAL_PX = 21; /* height of this font's capitals at scale 1 */

/** The font is ASCII; anything else shows as '?', one for each character. */
std::string printable(const std::string &s)
{
    std::string out;
    for (const char c : s) {
        const auto byte = static_cast<unsigned char>(c);
        if ((byte & 0xc0) == 0x80) {
            continue;
        }
        out += byte < 0x20 || byte > 0x7e ? '?' : c;
    }
    return out;
}

}  // namespace

cv::Point Canvas::fixed(const cv::Point2d &p) const
{
    /* Far points are pulled in: a fixed-point number of 1/32 px must not overflow. */
    const auto to_fixed = [&](double v) {
        const double px = (v + 0.5) * scale_ - 0.5;
        return static_cast<int>(std::lround(std::clamp(px, -2e4, 4e4) * (1 << SHIFT)));
    };
    return {to_fixed(p.x), to_fixed(p.y)};
}

bool Canvas::holds(const cv::Point2d &p) const
{
    return p.x > -0.5 && p.y > -0.5 && p.x < mat_.cols / scale_ - 0.5 &&
           p.y < mat_.rows / scale_ - 0.5;
}

void Canvas::line(const cv::Point2d &a, const cv::Point2d &b, const cv::Scalar &c, int width) const
{
    cv::line(mat_, fixed(a), fixed(b), c, width, cv::LINE_AA, SHIFT);
}

void Canvas::polygon(const std::vector<cv::Point2d> &points, bool closed, const cv::Scalar &c,
                     int width) const
{
    for (std::size_t i = 0; i + (closed ? 0 : 1) < points.size(); i++) {
        line(points[i], points[(i + 1) % points.size()], c, width);
    }
}

void Canvas::arrow(const cv::Point2d &a, const cv::Point2d &b, const cv::Scalar &c,
                   int width) const
{
    const cv::Point2d along = b - a;
    const double length = std::hypot(along.x, along.y);
    if (length * scale_ < 1) {
        return;
    }
    const double tip = std::min(0.35 * length, 5.0 * width / scale_);
    const cv::Point2d back = along * (tip / length);
    const cv::Point2d across(-back.y * 0.5, back.x * 0.5);
    line(a, b - back * 0.8, colour::halo, width + 3);
    line(a, b - back * 0.8, c, width);
    fill({b, b - back + across, b - back - across}, c);
}

void Canvas::dot(const cv::Point2d &p, double radius, const cv::Scalar &c) const
{
    cv::circle(mat_, fixed(p), static_cast<int>(std::lround(radius * (1 << SHIFT))), c, cv::FILLED,
               cv::LINE_AA, SHIFT);
}

void Canvas::fill(const std::vector<cv::Point2d> &points, const cv::Scalar &c) const
{
    std::vector<cv::Point> corners;
    corners.reserve(points.size());
    for (const cv::Point2d &p : points) {
        corners.push_back(fixed(p));
    }
    cv::fillConvexPoly(mat_, corners, c, cv::LINE_AA, SHIFT);
}

void Canvas::label(const cv::Point2d &centre, const std::string &s, double height,
                   const cv::Scalar &c) const
{
    const double size = height / CAPITAL_PX;
    const int weight = std::max(1, static_cast<int>(std::lround(height / 10)));
    int baseline = 0;
    const cv::Size box = cv::getTextSize(printable(s), FONT, size, weight, &baseline);
    const cv::Point2d px = (centre + cv::Point2d(0.5, 0.5)) * scale_;
    if (std::fabs(px.x) > 2e4 || std::fabs(px.y) > 2e4) {
        return;
    }
    const cv::Point at(static_cast<int>(px.x) - box.width / 2,
                       static_cast<int>(px.y) + box.height / 2);
    cv::putText(mat_, printable(s), at, FONT, size, colour::halo, weight + 3, cv::LINE_AA);
    cv::putText(mat_, printable(s), at, FONT, size, c, weight, cv::LINE_AA);
}

double Canvas::text(const cv::Point2d &baseline, const std::string &s, double height,
                    const cv::Scalar &c, int weight) const
{
    const double size = height / CAPITAL_PX;
    int below = 0;
    const cv::Size box = cv::getTextSize(printable(s), FONT, size, weight, &below);
    cv::putText(mat_, printable(s), cv::Point(baseline * scale_), FONT, size, c, weight,
                cv::LINE_AA);
    return box.width / scale_;
}

cv::Scalar residual_colour(double residual_over_sigma)
{
    const double r = std::fabs(residual_over_sigma);
    return r < 2 ? colour::good : r < 4 ? colour::fair : colour::bad;
}
