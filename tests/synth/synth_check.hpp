/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the renderer's tests share: checks that count, and OpenCV as the outside judge. */
#ifndef OPMS_TESTS_SYNTH_CHECK_HPP
#define OPMS_TESTS_SYNTH_CHECK_HPP

#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include <opencv2/calib3d.hpp>

#include "simulate/simulate.hpp"

namespace synth
{

namespace sim = opms::simulate;

inline int &failures()
{
    static int count = 0;
    return count;
}

inline void check(bool good, const std::string &what)
{
    if (!good) {
        ++failures();
        std::printf("    FAILED: %s\n", what.c_str());
    }
}

inline void check_below(double value, double limit, const std::string &what)
{
    char text[160];
    std::snprintf(text, sizeof text, "%s: %.3g (limit %.3g)", what.c_str(), value, limit);
    std::printf("    %s\n", text);
    check(value < limit, text); /* NaN fails */
}

struct Test {
    const char *name;
    std::function<void()> run;
};

inline int run_all(const std::vector<Test> &tests)
{
    for (const Test &test : tests) {
        std::printf("%s\n", test.name);
        test.run();
    }
    std::printf("%d failed\n", failures());
    return failures() == 0 ? 0 : 1;
}

/** Points of the bar's plane, mm, in the picture, by OpenCV's projection. */
inline std::vector<cv::Point2d> judge_project(const sim::Scene &scene,
                                              const std::vector<cv::Vec2d> &mm)
{
    std::vector<cv::Point3d> points;
    for (const cv::Vec2d &p : mm) {
        points.emplace_back(p[0] * 1e-3, p[1] * 1e-3, 0);
    }
    const sim::Camera &c = scene.camera;
    const sim::Pose camera_bar = sim::bar_camera(scene).inverse();
    const cv::Matx33d K(c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
    const std::vector<double> lens = {c.k1, c.k2, c.p1, c.p2};
    cv::Vec3d turn;
    cv::Rodrigues(camera_bar.R, turn);
    std::vector<cv::Point2d> px;
    cv::projectPoints(points, turn, camera_bar.t, K, lens, px);
    return px;
}

/** A bar on white ground without noise, seen by a small camera from @p distance_m. */
inline sim::Scene clean_scene(double distance_m, double incidence_deg, double roll_deg)
{
    sim::Scene scene;
    scene.camera.width = 400;
    scene.camera.height = 300;
    scene.camera.cx = 204.3;
    scene.camera.cy = 146.6;
    scene.pattern = sim::make_pattern("hope33");
    scene.look.ground = scene.look.white;
    scene.look.ground_contrast = 0;
    scene.look.noise_read = 0;
    sim::PoseRange range;
    range.distance_m = {distance_m, distance_m};
    range.incidence_deg = {incidence_deg, incidence_deg};
    range.azimuth_deg = {30, 30};
    range.along_m = {0.043, 0.043};
    range.camera_roll_deg = {roll_deg, roll_deg};
    scene.ground_camera = sim::sample_pose(scene, range, 0);
    return scene;
}

} // namespace synth
#endif
