/* SPDX-License-Identifier: Apache-2.0 */
/* Where the camera stood, from two sides: the sheet lies flat, each camera is a pyramid whose base
 * is its picture, and a dashed line drops from it to the sheet. */
#include <algorithm>
#include <cmath>
#include <vector>

#include <opms/lens.h>

#include "report_camera.hpp"
#include "report_parts.hpp"
#include "svg_canvas.hpp"

namespace {

constexpr double WIDTH = 540, MARGIN = 16, LIFT_RAD = 0.3;
constexpr double SHEET_X_M = 0.4, SHEET_Y_M = 0.55, LINE_M = 0.1;
constexpr double PYRAMID_M = 0.05, HEAD_RADIUS_M = 0.1;

struct Place {
    double x, y, z;
};

/** Parallel view of the grid's frame from one side, a little from above. */
class Side {
public:
    /** @param right  the grid's axis that points to the right, away: the one that points away. */
    Side(Place right, Place away) : right_(right), away_(away) {}

    SvgPoint flat(const Place &p) const
    {
        const double across = right_.x * p.x + right_.y * p.y;
        const double depth = away_.x * p.x + away_.y * p.y;
        return {across, -(p.z * std::cos(LIFT_RAD) + depth * std::sin(LIFT_RAD))};
    }
    /** Make room for @p p. */
    void include(const Place &p)
    {
        const SvgPoint at = flat(p);
        low_ = {std::min(low_.x, at.x), std::min(low_.y, at.y)};
        high_ = {std::max(high_.x, at.x), std::max(high_.y, at.y)};
    }
    double zoom() const { return (WIDTH - 2 * MARGIN) / (high_.x - low_.x); }
    double height() const { return 2 * MARGIN + zoom() * (high_.y - low_.y); }
    SvgPoint at(const Place &p) const
    {
        const SvgPoint f = flat(p);
        return {MARGIN + zoom() * (f.x - low_.x), MARGIN + zoom() * (f.y - low_.y)};
    }

private:
    Place right_, away_;
    SvgPoint low_{HUGE_VAL, HUGE_VAL}, high_{-HUGE_VAL, -HUGE_VAL};
};

struct Camera {
    Place apex;
    Place base[4];
    std::string number;
};

Camera camera_of(const ReportJson &picture, const opms_lens_t &lens)
{
    const ReportJson &R = picture.at("R_grid_camera"), &t = picture.at("t_grid_camera_m");
    const double corners[4][2] = {{0, 0},
                                  {lens.width_px - 1.0, 0},
                                  {lens.width_px - 1.0, lens.height_px - 1.0},
                                  {0, lens.height_px - 1.0}};
    Camera camera{{t[0].get<double>(), t[1].get<double>(), t[2].get<double>()},
                  {},
                  std::to_string(picture.at("number").get<int>())};
    for (int c = 0; c < 4; c++) {
        double ray[2] = {0, 0};
        opms_lens_unproject(&lens, corners[c], ray, nullptr, nullptr);
        double p[3];
        for (std::size_t i = 0; i < 3; i++) {
            p[i] = t[i].get<double>() +
                   PYRAMID_M * (R[i][0].get<double>() * ray[0] + R[i][1].get<double>() * ray[1] +
                                R[i][2].get<double>());
        }
        camera.base[c] = {p[0], p[1], p[2]};
    }
    return camera;
}

void draw_sheet(SvgCanvas &canvas, const Side &side)
{
    std::vector<std::pair<SvgPoint, SvgPoint>> lines;
    for (int i = -4; i <= 4; i++) {
        const double x = i * LINE_M;
        lines.push_back({side.at({x, -SHEET_Y_M, 0}), side.at({x, SHEET_Y_M, 0})});
    }
    for (int j = -5; j <= 5; j++) {
        const double y = j * LINE_M;
        lines.push_back({side.at({-SHEET_X_M, y, 0}), side.at({SHEET_X_M, y, 0})});
    }
    canvas.segments(lines, "grid");
    canvas.polyline({side.at({-SHEET_X_M, -SHEET_Y_M, 0}), side.at({SHEET_X_M, -SHEET_Y_M, 0}),
                     side.at({SHEET_X_M, SHEET_Y_M, 0}), side.at({-SHEET_X_M, SHEET_Y_M, 0})},
                    "edge", true);
    canvas.polyline({side.at({0, 0, 0}), side.at({LINE_M, 0, 0})}, "axis");
    canvas.polyline({side.at({0, 0, 0}), side.at({0, LINE_M, 0})}, "axis");
    canvas.text(side.at({LINE_M * 1.15, 0, 0}), "X", SvgAnchor::middle, "strong");
    canvas.text(side.at({0, LINE_M * 1.15, 0}), "Y", SvgAnchor::middle, "strong");
}

std::vector<Place> head_outline(double x, double y)
{
    std::vector<Place> outline;
    for (int i = 0; i < 36; i++) {
        const double angle = i * 3.14159265358979323846 / 18;
        outline.push_back(
            {x + HEAD_RADIUS_M * std::cos(angle), y + HEAD_RADIUS_M * std::sin(angle), 0});
    }
    return outline;
}

std::vector<std::vector<Place>> heads_of(const ReportJson &report)
{
    std::vector<std::vector<Place>> heads;
    if (report_has(report, "/footprints")) {
        for (const ReportJson &footprint : report.at("footprints")) {
            heads.push_back(
                head_outline(footprint.at("x_m").get<double>(), footprint.at("y_m").get<double>()));
        }
    }
    return heads;
}

std::string view(Side side, const std::vector<Camera> &cameras,
                 const std::vector<std::vector<Place>> &heads, const std::string &caption)
{
    for (const double sx : {-1.0, 1.0}) {
        side.include({sx * SHEET_X_M, -SHEET_Y_M, 0});
        side.include({sx * SHEET_X_M, SHEET_Y_M, 0});
    }
    for (const Camera &camera : cameras) {
        side.include(camera.apex);
        for (const Place &corner : camera.base) {
            side.include(corner);
        }
    }
    for (const auto &head : heads) {
        for (const Place &p : head) {
            side.include(p);
        }
    }
    SvgCanvas canvas(WIDTH, side.height(), "places of the camera over the grid");
    draw_sheet(canvas, side);
    for (const auto &head : heads) {
        std::vector<SvgPoint> outline;
        std::transform(head.begin(), head.end(), std::back_inserter(outline),
                       [&](const Place &p) { return side.at(p); });
        canvas.polyline(outline, "head", true);
    }
    for (const Camera &camera : cameras) {
        canvas.line(side.at(camera.apex), side.at({camera.apex.x, camera.apex.y, 0}), "drop");
    }
    for (const Camera &camera : cameras) {
        const SvgPoint apex = side.at(camera.apex);
        std::vector<SvgPoint> base;
        for (const Place &corner : camera.base) {
            base.push_back(side.at(corner));
            canvas.polyline({apex, base.back()}, "camera");
        }
        canvas.polyline(base, "camera", true);
    }
    for (const Camera &camera : cameras) {
        const SvgPoint apex = side.at(camera.apex);
        canvas.circle(apex, 2, "dot");
        canvas.text({apex.x, apex.y - 5}, camera.number, SvgAnchor::middle, "halo");
    }
    return html_figure(canvas.finish(), caption);
}

}  // namespace

std::string report_places(const ReportJson &report)
{
    if (!report_has(report, "/lens")) {
        return std::string();
    }
    const opms_lens_t lens = report_camera_lens(report);
    std::vector<Camera> cameras;
    for (const ReportJson &picture : report.at("pictures")) {
        if (picture.contains("R_grid_camera")) {
            cameras.push_back(camera_of(picture, lens));
        }
    }
    const auto heads = heads_of(report);
    return html_section(
        "Where the camera stood",
        "<div class=\"row\">\n" +
            view(Side({0, 1, 0}, {-1, 0, 0}), cameras, heads,
                 "<b>Seen by the operator.</b> The numbers are those of the pictures; lines of the "
                 "sheet are 100 mm apart; the disc is the head on the footprint.") +
            view(Side({-1, 0, 0}, {0, -1, 0}), cameras, heads,
                 "<b>Seen from the right</b>, the operator standing at the left. Pictures from "
                 "different heights, leaning to different sides, fix the lens.") +
            "</div>\n");
}
