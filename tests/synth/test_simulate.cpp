/* SPDX-License-Identifier: Apache-2.0 */
/* Where the renderer draws: lens, patterns, areas, edges, blur; OpenCV judges. */
#include <algorithm>
#include <bitset>

#include "simulate/sim_outline.hpp"
#include "simulate/sim_rects.hpp"
#include "synth_check.hpp"

namespace
{

using namespace synth;

void points_fall_where_opencv_says()
{
    sim::Scene scene;
    scene.pattern = sim::make_pattern("hope33");
    scene.tilt_rad = 19.3 * sim::RAD;
    const sim::Pose detector{sim::rotation({0.05, -0.1, 0.2}), {0.4, 0.1, 0.05}};
    scene.ground_camera = detector * scene.camera.detector_camera;
    const sim::Projector projector(scene.camera);
    const sim::Pose camera_bar = sim::bar_camera(scene).inverse();
    double worst = 0;
    int seen = 0;
    for (int y = -500; y <= 500; y += 10) {
        const cv::Point2d wanted = judge_project(scene, {cv::Vec2d(3, y)})[0];
        cv::Vec2d px;
        if (projector.point(camera_bar * cv::Vec3d(0.003, y * 1e-3, 0), px)) {
            worst = std::max(worst, std::hypot(px[0] - wanted.x, px[1] - wanted.y));
            ++seen;
        }
    }
    check_below(worst, 1e-9, "distance to cv::projectPoints, px");
    check(seen > 60, "most of the bar is projected");
}

void the_lens_is_inverted_up_to_the_corner()
{
    const sim::Camera camera;
    double worst = 0;
    for (int x = 0; x <= 1023; x += 93) {
        for (int y = 0; y <= 767; y += 59) {
            cv::Vec2d n;
            check(sim::undistort(camera, cv::Vec2d(x, y), n), "every pixel has a ray");
            worst = std::max(worst, cv::norm(sim::distort(camera, n) - cv::Vec2d(x, y)));
        }
    }
    check_below(worst, 1e-9, "distort after undistort, px");
}

void beyond_the_fold_nothing_is_seen()
{
    sim::Camera camera;
    camera.k1 = -0.35;
    camera.k2 = camera.p1 = camera.p2 = 0;
    const double fold = std::sqrt(1 / (3 * 0.35));
    check_below(std::abs(sim::fold_radius(camera) - fold), 1e-6, "fold radius");
    cv::Vec2d n;
    check(!sim::undistort(camera, {camera.cx + camera.fx * 0.7, camera.cy}, n),
          "no ray where the lens has no picture");
    const sim::Projector projector(camera);
    cv::Vec2d px;
    check(!projector.point({1.5, 0, 1}, px), "a point beyond the fold is not seen");
    check(!projector.point({0, 0, -1}, px), "nor one behind the camera");
    check(projector.outline({{1.4, -0.1, 1}, {1.6, -0.1, 1}, {1.6, 0.1, 1}}).empty(),
          "a polygon beyond the fold is cut away");
    const sim::Outline part = projector.outline({{0, -0.1, 1}, {1.6, -0.1, 1}, {1.6, 0.1, -1}});
    check(!part.empty() && part.box.x + part.box.width < camera.cx + camera.fx * 0.66,
          "of a polygon across the fold the near part is left");
}

double area(const std::vector<sim::Rect> &rects)
{
    double sum = 0;
    for (const sim::Rect &r : rects) {
        sum += (r.x1 - r.x0) * (r.y1 - r.y0);
    }
    return sum;
}

bool is_black(const sim::Pattern &pattern, double x, double y)
{
    return std::any_of(pattern.black.begin(), pattern.black.end(), [&](const sim::Rect &r) {
        return r.x0 < x && x < r.x1 && r.y0 < y && y < r.y1;
    });
}

void the_bar_has_its_squares_and_codes()
{
    const sim::Pattern bar = sim::make_pattern("hope33");
    const int codes[33] = {57, 8,  46, 36, 61, 19, 56, 62, 50, 1,  35, 28, 38, 10, 37, 58, 2,
                           6,  13, 54, 23, 22, 53, 24, 33, 47, 55, 44, 14, 3,  17, 49, 5};
    int cells = 0;
    for (int k = 0; k < 33; ++k) {
        const double y = (k - 16) * 30.0;
        check(is_black(bar, 9.9, y - 9.9) && !is_black(bar, 10.1, y), "a square of 20 mm");
        int read = 0;
        for (int i = 0; i < 3; ++i) {
            read |= is_black(bar, -11.25 + 4.5 * i, y + 15) ? 32 >> i : 0;
            read |= is_black(bar, 2.25 + 4.5 * i, y - 15) ? 4 >> i : 0;
        }
        check(read == codes[k], "code of square " + std::to_string(k));
        cells += static_cast<int>(std::bitset<6>(static_cast<unsigned>(codes[k])).count());
    }
    check_below(std::abs(area(bar.black) - (33 * 400 + cells * 22.5)), 1e-6, "black area, mm2");
}

void the_grid_has_its_lines_marker_and_bar()
{
    const sim::Pattern grid = sim::make_pattern("a0-25");
    check(grid.targets.size() == 33 * 45, "33 x 45 nodes");
    check(is_black(grid, 400.9, 12) && is_black(grid, 12, -550.9), "outermost lines");
    check(is_black(grid, 8.9, 3.1) && !is_black(grid, -6, 6), "marker in +X +Y");
    check(!is_black(grid, 12.5, 12.5), "white between the lines");
    const sim::Pattern sheet = sim::make_pattern("evaluation");
    check(sheet.targets.size() == 33 * 45 - 41, "41 nodes hidden by the bar");
    check(is_black(sheet, -350.5, 480) && !is_black(sheet, -362, 0), "bar on the sheet");
}

void ink_runs_by_the_print_gain()
{
    const sim::Pattern bold = sim::make_pattern("hope33", 0.2);
    const sim::Pattern thin = sim::make_pattern("hope33", -0.2);
    check(is_black(bold, 10.19, 0) && !is_black(bold, 10.21, 0), "0.2 mm outwards");
    check(is_black(thin, 9.79, 0) && !is_black(thin, 9.81, 0), "0.2 mm inwards");
    const std::vector<sim::Rect> two = {{0, 0, 4, 4}, {2, 2, 6, 6}};
    check_below(std::abs(area(sim::subtract(two, {})) - 28), 1e-12, "area of a union");
    /* Two squares of 4 that share one of 2: inwards by 1, two squares of 2 that meet in a point. */
    check_below(std::abs(area(sim::grow(two, -1)) - 8), 1e-12, "area of a union moved inwards");
}

/** Area in px of a rectangle in the plane, from a fine polygon of judged points. */
double judged_area(const sim::Scene &scene, const sim::Rect &r)
{
    std::vector<cv::Vec2d> border;
    const cv::Vec2d corners[4] = {{r.x0, r.y0}, {r.x1, r.y0}, {r.x1, r.y1}, {r.x0, r.y1}};
    for (int side = 0; side < 4; ++side) {
        for (int i = 0; i < 64; ++i) {
            border.push_back(corners[side] +
                             (corners[(side + 1) % 4] - corners[side]) * (i / 64.0));
        }
    }
    const std::vector<cv::Point2d> px = judge_project(scene, border);
    double twice = 0;
    for (std::size_t i = 0; i < px.size(); ++i) {
        twice += px[i].cross(px[(i + 1) % px.size()]);
    }
    return std::abs(twice) / 2;
}

void black_covers_its_projected_area()
{
    const sim::Scene scene = clean_scene(1.6, 20, 50); /* all of the bar in the picture */
    check(sim::count_visible(scene) == 33, "all squares visible");
    sim::Scene blank = scene; /* the same roundings */
    blank.look.black = blank.look.white;
    const cv::Mat lost = sim::render_light(blank) - sim::render_light(scene);
    const double dark = cv::sum(lost)[0] / (scene.look.white - scene.look.black);
    double wanted = 0;
    for (const sim::Rect &r : scene.pattern.black) {
        wanted += judged_area(scene, r);
    }
    check_below(std::abs(dark / wanted - 1), 1e-5, "relative error of the black area");
}

/** Standard normal quantile by bisection. */
double quantile(double part)
{
    double low = -8, high = 8;
    while (high - low > 1e-12) {
        const double middle = (low + high) / 2;
        (std::erfc(-middle / std::sqrt(2.0)) / 2 < part ? low : high) = middle;
    }
    return low;
}

/** Where a row (or column) of the picture passes half way from black to white near @p start. A
 * blurred step is nearly straight as a normal quantile, so that two pixels suffice. */
bool half_way(const sim::Scene &scene, const cv::Mat &light, bool row, int line, double start,
              double &found)
{
    const auto at = [&](int i) {
        const double v = row ? light.at<float>(line, i) : light.at<float>(i, line);
        return (v - scene.look.black) / (scene.look.white - scene.look.black);
    };
    for (int i = static_cast<int>(start) - 2; i <= static_cast<int>(start) + 2; ++i) {
        if ((at(i) < 0.5) != (at(i + 1) < 0.5)) {
            const double a = quantile(at(i)), b = quantile(at(i + 1));
            found = i + a / (a - b);
            return true;
        }
    }
    return false;
}

/** Error of the edge x = @p x mm where it meets the pixel line next to the point at @p y mm. */
double edge_error(const sim::Scene &scene, const cv::Mat &light, double x, double y)
{
    const std::vector<cv::Point2d> px = judge_project(scene, {{x, y}, {x, y + 0.01}});
    const cv::Point2d along = px[1] - px[0];
    const bool row = std::abs(along.y) > std::abs(along.x);
    const int line = static_cast<int>(std::lround(row ? px[0].y : px[0].x));
    /* Along the edge to the line: Newton with the chord's slope. */
    cv::Point2d at = px[0];
    double mm = y;
    for (int i = 0; i < 5; ++i) {
        mm += 0.01 * (row ? (line - at.y) / along.y : (line - at.x) / along.x);
        at = judge_project(scene, {{x, mm}})[0];
    }
    double found = 0;
    if (!half_way(scene, light, row, line, row ? at.x : at.y, found)) {
        return 1;
    }
    return std::abs(found - (row ? at.x : at.y));
}

void edges_cross_half_way_where_they_are()
{
    double worst = 0;
    int count = 0;
    for (int roll = 0; roll < 360; roll += 24) {
        sim::Scene scene = clean_scene(0.30, 35, roll);
        scene.look.blur_px = 0.9;
        const cv::Mat light = sim::render_light(scene);
        for (const sim::Rect &square : scene.pattern.targets) {
            for (const double x : {square.x0, square.x1}) {
                for (double off = -4; off <= 4; off += 2) {
                    const double y = (square.y0 + square.y1) / 2 + off;
                    const cv::Point2d px = judge_project(scene, {{x, y}})[0];
                    if (px.x > 8 && px.y > 8 && px.x < 392 && px.y < 292) {
                        worst = std::max(worst, edge_error(scene, light, x, y));
                        ++count;
                    }
                }
            }
        }
    }
    std::printf("    %d edge points\n", count);
    check(count > 500, "enough edge points");
    check_below(worst, 0.001, "50 % crossing, px");
}

void blur_has_its_width()
{
    for (const double sigma : {0.1, 0.3, 0.692219, 2.0}) {
        sim::Scene scene = clean_scene(0.2, 0, 0);
        scene.camera = sim::Camera();
        scene.camera.k1 = scene.camera.k2 = scene.camera.p1 = scene.camera.p2 = 0;
        scene.camera.width = 400;
        scene.camera.height = 300;
        scene.camera.cx = 200.37;
        scene.camera.cy = 150;
        /* Straight down, bar up and down in the picture; the edge lies at x = +10 mm. */
        scene.ground_camera = {cv::Matx33d(1, 0, 0, 0, -1, 0, 0, 0, -1), {0, 0, 0.2}};
        scene.look.blur_px = sigma;
        const cv::Mat light = sim::render_light(scene);
        const double mean_at = scene.camera.cx + scene.camera.fx * 0.010 / 0.2;
        double weight = 0, first = 0, second = 0;
        for (int x = static_cast<int>(mean_at) - 12; x < static_cast<int>(mean_at) + 13; ++x) {
            const double step = light.at<float>(150, x + 1) - light.at<float>(150, x);
            weight += step;
            first += step * (x + 0.5 - mean_at);
            second += step * (x + 0.5 - mean_at) * (x + 0.5 - mean_at);
        }
        first /= weight;
        /* Differences of pixels add another pixel's square to the pixel's own. */
        const double variance = second / weight - first * first - 1.0 / 12;
        check_below(std::abs(first), 0.002 + (sigma < 0.2 ? 0.01 : 0), "centre of the edge, px");
        if (sigma > 0.5) { /* a sharper edge cannot be measured by its pixels' moments */
            check_below(std::abs(std::sqrt(variance) - sim::total_blur(sigma)), 0.002,
                        "width of the edge, px");
        }
    }
    check_below(std::abs(sim::total_blur(sim::optics_blur(0.75)) - 0.75), 1e-12, "total blur");
}

void poses_are_drawn_from_their_range()
{
    sim::Scene scene;
    scene.pattern = sim::make_pattern("hope33");
    scene.tilt_rad = 0.3;
    sim::PoseRange range;
    range.attitude_deg = {5, 5, 5};
    sim::PoseRange look;
    look.distance_m = {0.3, 0.6};
    look.incidence_deg = {10, 50};
    look.camera_roll_deg = {0, 360};
    for (int seed = 1; seed <= 200; ++seed) {
        scene.seed = static_cast<std::uint64_t>(seed);
        scene.ground_camera = sim::sample_pose(scene, range, 0);
        const sim::Pose head = sim::ground_detector(scene);
        check(head.t[0] >= 0.15 && head.t[0] <= 0.55 && std::abs(head.t[1]) <= 0.5 &&
                  head.t[2] >= 0 && head.t[2] <= 0.115,
              "head in the working volume");
        check(std::acos(head.R(2, 2)) < 8 * sim::RAD, "head nearly level");
        scene.ground_camera = sim::sample_pose(scene, look, 0);
        const sim::Pose bar = sim::bar_camera(scene);
        const cv::Vec3d axis(bar.R(0, 2), bar.R(1, 2), bar.R(2, 2));
        const double distance = -bar.t[2] / axis[2], off = std::acos(-axis[2]) / sim::RAD;
        check(distance > 0.2999 && distance < 0.6001 && off > 9.999 && off < 50.001,
              "distance and incidence");
        check(std::abs((bar.t + axis * distance)[0]) < 1e-9, "looks at the bar's middle line");
    }
    scene.tilt_rad = 0;
    scene.ground_camera = sim::sample_lift(scene, 0, 12);
    check(cv::norm(sim::ground_detector(scene).t - cv::Vec3d(0.35, 0, 0)) < 1e-12,
          "the lift begins on the footprint");
}

} // namespace

int main()
{
    return run_all(
        {{"points fall where OpenCV says", points_fall_where_opencv_says},
         {"the lens is inverted up to the corner", the_lens_is_inverted_up_to_the_corner},
         {"beyond the fold nothing is seen", beyond_the_fold_nothing_is_seen},
         {"the bar has its squares and codes", the_bar_has_its_squares_and_codes},
         {"the grid has its lines, marker and bar", the_grid_has_its_lines_marker_and_bar},
         {"ink runs by the print gain", ink_runs_by_the_print_gain},
         {"black covers its projected area", black_covers_its_projected_area},
         {"edges cross half way where they are", edges_cross_half_way_where_they_are},
         {"blur has its width", blur_has_its_width},
         {"poses are drawn from their range", poses_are_drawn_from_their_range}});
}
