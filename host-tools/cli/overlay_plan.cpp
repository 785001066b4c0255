/* SPDX-License-Identifier: Apache-2.0 */
/* A map of the bar with the detector (or, without its transform, the camera) seen from above:
 * operator at the bottom, as he stands. */
#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "overlay_parts.hpp"

namespace {

constexpr double TURN = 2 * 3.14159265358979323846;

/** Y runs to the right and X down; the map shows the whole bar and the place of the detector. */
class Plan {
public:
    Plan(cv::Mat &panel, const cv::Rect &area, double x_m, double y_m) : canvas_(panel, 1)
    {
        const double y_least = std::min(-0.55, y_m - 0.15), y_most = std::max(0.55, y_m + 0.15);
        const double x_least = std::min(-0.12, x_m - 0.15), x_most = std::max(0.3, x_m + 0.15);
        scale_ = 0.92 * std::min(area.width / (y_most - y_least), area.height / (x_most - x_least));
        middle_px_ = {area.x + area.width * 0.5, area.y + area.height * 0.5};
        middle_m_ = {(y_least + y_most) / 2, (x_least + x_most) / 2};
    }
    cv::Point2d at(double x_m, double y_m) const
    {
        return middle_px_ + (cv::Point2d(y_m, x_m) - middle_m_) * scale_;
    }
    const Canvas &canvas() const { return canvas_; }

private:
    Canvas canvas_;
    double scale_;
    cv::Point2d middle_px_, middle_m_;
};

void draw_bar(const Plan &plan, const std::vector<opms_square_t> &found)
{
    plan.canvas().fill({plan.at(-0.015, -0.5), plan.at(-0.015, 0.5), plan.at(0.015, 0.5),
                        plan.at(0.015, -0.5)},
                       colour::text);
    for (int k = 0; k < OPMS_BAR_SQUARES; k++) {
        const bool seen = std::any_of(found.begin(), found.end(), [k](const opms_square_t &s) {
            return s.index == k;
        });
        const double y = (k - OPMS_BAR_ORIGIN) * OPMS_BAR_PITCH_M, half = OPMS_BAR_SQUARE_M / 2;
        plan.canvas().fill({plan.at(-half, y - half), plan.at(-half, y + half),
                            plan.at(half, y + half), plan.at(half, y - half)},
                           seen ? colour::square : colour::dim);
    }
}

void draw_place(const Plan &plan, const opms_transform_t &pose, bool head, double letter_px)
{
    const double x = pose.t_m[0], y = pose.t_m[1];
    if (head) {
        std::vector<cv::Point2d> outline;
        for (int i = 0; i < 72; i++) {
            const double c = HEAD_RADIUS_M * std::cos(TURN * i / 72);
            const double s = HEAD_RADIUS_M * std::sin(TURN * i / 72);
            outline.push_back(plan.at(x + pose.R[0] * c + pose.R[1] * s,
                                      y + pose.R[3] * c + pose.R[4] * s));
        }
        plan.canvas().polygon(outline, true, colour::head, 3);
    }
    const cv::Scalar colours[2] = {colour::axis_x, colour::axis_y};
    const char *const names[2] = {"X", "Y"};
    for (int i = 0; i < 2; i++) {
        const cv::Point2d end = plan.at(x + 0.08 * pose.R[i], y + 0.08 * pose.R[3 + i]);
        plan.canvas().arrow(plan.at(x, y), end, colours[i], 3);
        plan.canvas().label(plan.at(x + 0.13 * pose.R[i], y + 0.13 * pose.R[3 + i]), names[i],
                            letter_px, colours[i]);
    }
    plan.canvas().dot(plan.at(x, y), letter_px * 0.35, colour::text);
}

}  // namespace

void overlay_draw_plan(cv::Mat &panel, const cv::Rect &area, const OverlayScene &scene)
{
    const opms_location_t &location = scene.result.location;
    const bool head = location.has_ground_detector != 0;
    const opms_transform_t &pose =
        (head ? location.ground_detector : location.pose.bar_camera).transform;
    const double unit = panel.rows / 1000.0;
    const cv::Rect inner(area.x, area.y + static_cast<int>(44 * unit), area.width,
                         area.height - static_cast<int>(52 * unit));
    if (inner.height < 60 * unit) {
        return;
    }
    const Canvas page(panel, 1);
    page.text({24 * unit, area.y + 30 * unit}, "SEEN FROM ABOVE, OPERATOR AT THE BOTTOM", 11 * unit,
              colour::dim);
    const Plan plan(panel, inner, pose.t_m[0], pose.t_m[1]);
    draw_bar(plan, scene.result.squares);
    draw_place(plan, pose, head, 13 * unit);
}
