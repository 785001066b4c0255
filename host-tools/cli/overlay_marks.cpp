/* SPDX-License-Identifier: Apache-2.0 */
/* What is drawn over the picture itself. Points of the bar and of the detector are projected
 * through the lens with the pose that was found, so what is drawn shows what was solved. */
#include <algorithm>
#include <cmath>
#include <optional>

#include <opms/lens.h>

#include "overlay_parts.hpp"

namespace {

constexpr double AXIS_M = 0.05;
constexpr double WHISKER_MAX_PX = 14; /* of the picture, so that an outlier does not cross it */

/** Coordinates in b of a point given in a, by the transform that takes b to a. */
void apply_inverse(const opms_transform_t &t, const double a[3], double b[3])
{
    for (int i = 0; i < 3; i++) {
        b[i] = 0;
        for (int j = 0; j < 3; j++) {
            b[i] += t.R[3 * j + i] * (a[j] - t.t_m[j]);
        }
    }
}

/** Pixel of a point of a frame that the camera is placed in; nothing where it cannot be seen. */
std::optional<cv::Point2d> project(const opms_lens_t &lens, const opms_transform_t &frame_camera,
                                   double x, double y, double z)
{
    const double point[3] = {x, y, z};
    double in_camera[3], px[2];
    apply_inverse(frame_camera, point, in_camera);
    if (opms_lens_project(&lens, in_camera, px, nullptr, nullptr, nullptr) != OPMS_OK) {
        return std::nullopt;
    }
    return cv::Point2d(px[0], px[1]);
}

cv::Point2d corner(const opms_square_t &square, int i)
{
    return {square.corners_px[i][0], square.corners_px[i][1]};
}

cv::Point2d middle(const opms_square_t &square)
{
    return (corner(square, 0) + corner(square, 1) + corner(square, 2) + corner(square, 3)) * 0.25;
}

/** Beside the bar, square across it in the picture, on the side away from the operator (-X). */
cv::Point2d label_place(const opms_square_t &square, double gap)
{
    const cv::Point2d along = corner(square, 2) + corner(square, 3) - corner(square, 0) -
                              corner(square, 1);
    const cv::Point2d far_side = (corner(square, 0) + corner(square, 3)) * 0.5 - middle(square);
    const double length = std::max(1e-6, std::hypot(along.x, along.y));
    cv::Point2d across(-along.y / length, along.x / length);
    double half_width = across.dot(far_side);
    if (half_width < 0) {
        across = -across;
        half_width = -half_width;
    }
    return middle(square) + across * (1.5 * half_width + gap);
}

void draw_squares(const Canvas &canvas, const std::vector<opms_square_t> &squares)
{
    for (const opms_square_t &square : squares) {
        std::vector<cv::Point2d> outline;
        for (int i = 0; i < 4; i++) {
            outline.push_back(corner(square, i));
        }
        canvas.polygon(outline, true, colour::square, 2);
    }
}

/** Labels as large as fits between neighbours; where squares are small, not every one. */
void draw_labels(const Canvas &canvas, const std::vector<opms_square_t> &squares)
{
    double pitch_px = 60;
    for (std::size_t i = 1; i < squares.size(); i++) {
        const cv::Point2d step = middle(squares[i]) - middle(squares[i - 1]);
        const int places = std::max(1, squares[i].index - squares[i - 1].index);
        pitch_px = std::min(pitch_px, canvas.scale() * std::hypot(step.x, step.y) / places);
    }
    const double height = std::clamp(0.42 * pitch_px, 11.0, 22.0);
    const int every = std::max(1, static_cast<int>(std::ceil(1.3 * height / pitch_px)));
    for (const opms_square_t &square : squares) {
        if (square.index % every == 0) {
            canvas.label(label_place(square, 1.1 * height / canvas.scale()),
                         std::to_string(square.index), height, colour::text);
        }
    }
}

/** Each measured point, and its residual as a whisker along the edge's normal. */
void draw_edges(const Canvas &canvas, const LocateResult &result)
{
    const double radius = std::max(1.6, canvas.scale());
    for (std::size_t i = 0; i < result.edges.size(); i++) {
        const opms_edge_t &edge = result.edges[i];
        const cv::Point2d at(edge.px[0], edge.px[1]);
        if (result.residuals_px.empty()) {
            canvas.dot(at, radius, colour::dim);
            continue;
        }
        const double residual = result.residuals_px[i];
        const cv::Scalar c = residual_colour(residual / edge.sigma_px);
        const double length =
            std::clamp(residual * RESIDUAL_MAGNIFIED, -WHISKER_MAX_PX, WHISKER_MAX_PX);
        canvas.line(at, at + cv::Point2d(edge.normal[0], edge.normal[1]) * length, c, 1);
        canvas.dot(at, radius, c);
    }
}

struct Place {
    double x, y, z;
};

void draw_axes(const Canvas &canvas, const opms_lens_t &lens, const opms_transform_t &frame_camera,
               const Place &at)
{
    const std::optional<cv::Point2d> origin = project(lens, frame_camera, at.x, at.y, at.z);
    const Place ends[3] = {{at.x + AXIS_M, at.y, at.z},
                           {at.x, at.y + AXIS_M, at.z},
                           {at.x, at.y, at.z + AXIS_M}};
    const cv::Scalar colours[3] = {colour::axis_x, colour::axis_y, colour::axis_z};
    const char *const names[3] = {"X", "Y", "Z"};
    for (int i = 0; i < 3 && origin; i++) {
        const auto end = project(lens, frame_camera, ends[i].x, ends[i].y, ends[i].z);
        if (!end) {
            continue;
        }
        canvas.arrow(*origin, *end, colours[i], 3);
        canvas.label(*origin + (*end - *origin) * 1.2, names[i], 15, colours[i]);
    }
}

/** At the bar's origin; where that is out of the picture, at the found square nearest to it. */
void draw_bar_axes(const Canvas &canvas, const OverlayScene &scene)
{
    const opms_transform_t &bar_camera = scene.result.location.pose.bar_camera.transform;
    const opms_lens_t &lens = scene.camera.lens;
    Place at{0, 0, 0};
    const auto origin = project(lens, bar_camera, 0, 0, 0);
    if ((!origin || !canvas.holds(*origin)) && !scene.result.squares.empty()) {
        int nearest = OPMS_BAR_SQUARES * 2;
        for (const opms_square_t &square : scene.result.squares) {
            const int place = square.index - OPMS_BAR_ORIGIN;
            if (std::abs(place) < std::abs(nearest) && canvas.holds(middle(square))) {
                nearest = place;
            }
        }
        at.y = nearest * OPMS_BAR_PITCH_M;
    }
    draw_axes(canvas, lens, bar_camera, at);
}

/** Outline of the head's underside and the detector's axes, where the camera sees them. */
void draw_head(const Canvas &canvas, const opms_camera_t &camera)
{
    constexpr int STEPS = 180;
    std::optional<cv::Point2d> last;
    for (int i = 0; i <= STEPS; i++) {
        const double angle = 2 * 3.14159265358979323846 * i / STEPS;
        const auto point = project(camera.lens, camera.detector_camera,
                                   HEAD_RADIUS_M * std::cos(angle),
                                   HEAD_RADIUS_M * std::sin(angle), 0);
        if (last && point && i % 3 != 0 && (canvas.holds(*last) || canvas.holds(*point))) {
            canvas.line(*last, *point, colour::head, 3);
        }
        last = point;
    }
    draw_axes(canvas, camera.lens, camera.detector_camera, {0, 0, 0});
}

}  // namespace

void overlay_draw_marks(const Canvas &canvas, const OverlayScene &scene)
{
    const LocateResult &result = scene.result;
    if (scene.camera.has_detector_camera) {
        draw_head(canvas, scene.camera);
    }
    draw_squares(canvas, result.squares);
    draw_edges(canvas, result);
    if (result.located()) {
        draw_bar_axes(canvas, scene);
    }
    if (result.location.bar.state == OPMS_BAR_LOCATED) {
        draw_labels(canvas, result.squares);
    }
}
