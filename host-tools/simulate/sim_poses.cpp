/* SPDX-License-Identifier: Apache-2.0 */
/* Where the camera is: at random in a range, by a list, and while it moves. */
#include <cmath>
#include <fstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "sim_json.hpp"
#include "sim_outline.hpp"
#include "sim_random.hpp"
#include "simulate/simulate.hpp"

namespace opms::simulate
{
namespace
{

constexpr double MM = 1e-3;

cv::Matx33d about(int axis, double angle)
{
    cv::Vec3d w(0, 0, 0);
    w[axis] = angle;
    return rotation(w);
}

/** Rz(psi) Ry(phi) Rx(theta) of angles in degrees. */
cv::Matx33d attitude(const cv::Vec3d &deg)
{
    return about(2, deg[0] * RAD) * about(1, deg[1] * RAD) * about(0, deg[2] * RAD);
}

cv::Vec3d within(Random &random, const cv::Vec3d &half)
{
    const double psi = random.uniform(-half[0], half[0]);
    const double phi = random.uniform(-half[1], half[1]);
    return {psi, phi, random.uniform(-half[2], half[2])};
}

/** Looking at a point of the pattern, upright, seen from outside. */
Pose look_at(Random &random, const PoseRange &range)
{
    const cv::Vec3d point(0, random.uniform(range.along_m), 0);
    const double distance = random.uniform(range.distance_m);
    const double off = random.uniform(range.incidence_deg) * RAD;
    const double azimuth = random.uniform(range.azimuth_deg) * RAD;
    const cv::Vec3d back(std::sin(off) * std::cos(azimuth), std::sin(off) * std::sin(azimuth),
                         std::cos(off));
    const cv::Vec3d z = -back, x(-std::sin(azimuth), std::cos(azimuth), 0), y = z.cross(x);
    return {cv::Matx33d(x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]),
            point + back * distance};
}

Pose in_volume(Random &random, const PoseRange &range)
{
    Pose head;
    const double x = random.uniform(range.x_m), y = random.uniform(range.y_m);
    head.t = {x, y, random.uniform(range.z_m)};
    head.R = attitude(within(random, range.attitude_deg));
    return head;
}

Pose pose_of(const nlohmann::json &item, const Scene &scene)
{
    if (item.contains("R_bar_camera")) {
        return ground_bar(scene) * pose_from_json(item, "bar_camera");
    }
    return pose_from_json(item, "ground_detector") * scene.camera.detector_camera;
}

} // namespace

Pose ground_bar(const Scene &scene)
{
    return {about(1, -scene.tilt_rad), {0, 0, 0}};
}

Pose bar_camera(const Scene &scene)
{
    return ground_bar(scene).inverse() * scene.ground_camera;
}

Pose ground_detector(const Scene &scene)
{
    return scene.ground_camera * scene.camera.detector_camera.inverse();
}

Pose ground_camera_at(const Scene &scene, double t_s)
{
    const Pose middle = ground_detector(scene);
    const Pose now{rotation(scene.motion.rotation_rad_s * t_s) * middle.R,
                   middle.t + scene.motion.velocity_m_s * t_s};
    return t_s == 0 ? scene.ground_camera : now * scene.camera.detector_camera;
}

int count_visible(const Scene &scene, double margin_px)
{
    const Projector projector(scene.camera);
    const Pose camera_bar = bar_camera(scene).inverse();
    if (bar_camera(scene).t[2] <= 0) {
        return 0;
    }
    int count = 0;
    for (const Rect &r : scene.pattern.targets) {
        bool seen = true;
        for (const cv::Vec2d &c : {cv::Vec2d(r.x0, r.y0), cv::Vec2d(r.x1, r.y0),
                                   cv::Vec2d(r.x1, r.y1), cv::Vec2d(r.x0, r.y1)}) {
            cv::Vec2d px;
            seen = seen && projector.point(camera_bar * cv::Vec3d(c[0] * MM, c[1] * MM, 0), px) &&
                   px[0] >= margin_px && px[0] <= scene.camera.width - 1 - margin_px &&
                   px[1] >= margin_px && px[1] <= scene.camera.height - 1 - margin_px;
        }
        count += seen ? 1 : 0;
    }
    return count;
}

Pose sample_pose(const Scene &scene, const PoseRange &range, int attempt)
{
    Random random(scene.seed, Stream::POSE, static_cast<std::uint64_t>(attempt));
    Pose camera = range.distance_m[1] > 0 ? ground_bar(scene) * look_at(random, range)
                                          : in_volume(random, range) * scene.camera.detector_camera;
    camera.R = camera.R * about(2, random.uniform(range.camera_roll_deg) * RAD);
    return camera;
}

Pose sample_lift(const Scene &scene, int index, int count)
{
    constexpr double FOOTPRINT_X = 0.35, LIFT = 0.20, ASIDE = 0.02;
    Pose head;
    head.t = {FOOTPRINT_X, 0, 0};
    if (index > 0) {
        Random random(scene.seed, Stream::POSE, static_cast<std::uint64_t>(index));
        const double x = random.uniform(-ASIDE, ASIDE);
        head.t += cv::Vec3d(x, random.uniform(-ASIDE, ASIDE), LIFT * index / (count - 1));
        head.R = attitude(within(random, {18, 10, 15}));
    }
    return head * scene.camera.detector_camera;
}

std::vector<Pose> read_poses(const std::string &path, const Scene &scene)
{
    std::ifstream file(path);
    if (!file) {
        throw std::runtime_error(path + ": cannot be read");
    }
    std::vector<Pose> poses;
    try {
        const nlohmann::json all = nlohmann::json::parse(file);
        if (all.is_array()) {
            for (const nlohmann::json &item : all) {
                poses.push_back(pose_of(item, scene));
            }
        } else {
            poses.push_back(pose_of(all, scene));
        }
    } catch (const std::exception &e) {
        throw std::runtime_error(path + ": pose " + std::to_string(poses.size()) + ": " + e.what());
    }
    return poses;
}

} // namespace opms::simulate
