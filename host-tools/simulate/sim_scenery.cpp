/* SPDX-License-Identifier: Apache-2.0 */
/* Soil is the sum of smooth random lattices of several scales; scales finer than two pixels are
 * left out, so that nothing flickers in the distance. */
#include "sim_scenery.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim_random.hpp"

namespace opms::simulate
{
namespace
{

/** Variance of a lattice of unit normals between its points, for smooth steps. */
constexpr double BETWEEN = 0.5518;

double smooth_step(double t)
{
    t = std::clamp(t, 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

} // namespace

Scenery::Scenery(const Scene &scene) : camera_(scene.camera), look_(scene.look)
{
    Random soil_random(scene.seed, Stream::GROUND);
    lattice_.resize(static_cast<std::size_t>(LATTICE) * LATTICE);
    for (float &value : lattice_) {
        value = static_cast<float>(soil_random.normal());
    }
    for (cv::Vec2d &offset : offsets_) {
        const double across = soil_random.uniform(0, LATTICE);
        offset = {across, soil_random.uniform(0, LATTICE)};
    }
    Random random(scene.seed, Stream::LIGHT);
    const double towards = random.uniform(0, 2 * PI), across = random.uniform(0, 2 * PI);
    gradient_ = cv::Vec2d(std::cos(towards), std::sin(towards)) * look_.light_gradient;
    shadow_normal_ = {std::cos(across), std::sin(across)};
    shadow_point_ = {0, random.uniform(-0.4, 0.4)};
    make_rays();
}

void Scenery::make_rays()
{
    rays_across_ = (camera_.width + RAY_STEP - 1) / RAY_STEP + 1;
    const int down = (camera_.height + RAY_STEP - 1) / RAY_STEP + 1;
    constexpr double NONE = std::numeric_limits<double>::quiet_NaN();
    for (int j = 0; j < down; ++j) {
        for (int i = 0; i < rays_across_; ++i) {
            cv::Vec2d ray(NONE, NONE), found;
            if (undistort(camera_, cv::Vec2d(i * RAY_STEP, j * RAY_STEP), found)) {
                ray = found;
            }
            rays_.push_back(ray);
        }
    }
}

void Scenery::view(const Pose &ground_camera, cv::Mat &light, cv::Mat &glow) const
{
    light.create(camera_.height, camera_.width, CV_32F);
    glow.create(camera_.height, camera_.width, CV_32F);
    for (int row = 0; row < camera_.height; ++row) {
        view_row(ground_camera, row, light.ptr<float>(row), glow.ptr<float>(row));
    }
}

void Scenery::view_row(const Pose &ground_camera, int row, float *light, float *glow) const
{
    const cv::Matx33d &R = ground_camera.R;
    const double height = ground_camera.t[2];
    const double down = static_cast<double>(row % RAY_STEP) / RAY_STEP;
    const cv::Vec2d *above =
        &rays_[static_cast<std::size_t>(row / RAY_STEP) * static_cast<std::size_t>(rays_across_)];
    const cv::Vec2d *below = above + rays_across_;
    for (int column = 0; column < camera_.width; ++column) {
        const int i = column / RAY_STEP;
        const double right = static_cast<double>(column % RAY_STEP) / RAY_STEP;
        const cv::Vec2d n = (above[i] * (1 - right) + above[i + 1] * right) * (1 - down) +
                            (below[i] * (1 - right) + below[i + 1] * right) * down;
        const double fall = R(2, 0) * n[0] + R(2, 1) * n[1] + R(2, 2);
        light[column] = 1;
        glow[column] = 0;
        if (!(fall == fall)) {
            continue; /* no ray comes here */
        }
        glow[column] = static_cast<float>(look_.ground);
        if (fall * height >= 0) {
            continue; /* the sky, as grey as the ground */
        }
        const double depth = -height / fall;
        const double x = ground_camera.t[0] + depth * (R(0, 0) * n[0] + R(0, 1) * n[1] + R(0, 2));
        const double y = ground_camera.t[1] + depth * (R(1, 0) * n[0] + R(1, 1) * n[1] + R(1, 2));
        const double px_m =
            depth / camera_.fx * std::sqrt(1 + n[0] * n[0] + n[1] * n[1]) / std::abs(fall);
        const double here = light_at(x, y);
        light[column] = static_cast<float>(here);
        glow[column] = static_cast<float>(
            here * std::max(look_.ground + look_.ground_contrast * soil(x, y, px_m), 0.0));
    }
}

double Scenery::soil(double x, double y, double px_m) const
{
    double sum = 0;
    double turn_x = 0.8, turn_y = 0.6; /* each scale is turned, so that no lattice shows */
    for (std::size_t level = 0; level < SCALES_M.size(); ++level) {
        const double scale = SCALES_M[level];
        const double weight = std::clamp(scale / (2 * px_m) - 1, 0.0, 1.0);
        if (weight == 0) {
            break;
        }
        /* Far ground is a repetition; fmod keeps the integers small. */
        const double u =
            std::fmod((turn_x * x + turn_y * y) / scale + offsets_[level][0], LATTICE) +
            2 * LATTICE;
        const double v =
            std::fmod((turn_x * y - turn_y * x) / scale + offsets_[level][1], LATTICE) +
            2 * LATTICE;
        const auto i = static_cast<unsigned>(u), j = static_cast<unsigned>(v);
        const double a = smooth_step(u - i), b = smooth_step(v - j);
        const unsigned i0 = i % LATTICE, i1 = (i + 1) % LATTICE;
        const float *r0 = &lattice_[static_cast<std::size_t>(j % LATTICE) * LATTICE];
        const float *r1 = &lattice_[static_cast<std::size_t>((j + 1) % LATTICE) * LATTICE];
        sum += weight *
               ((r0[i0] * (1 - a) + r0[i1] * a) * (1 - b) + (r1[i0] * (1 - a) + r1[i1] * a) * b);
        const double next_x = turn_x * 0.6 - turn_y * 0.8;
        turn_y = turn_x * 0.8 + turn_y * 0.6;
        turn_x = next_x;
    }
    static const double unit = 1 / std::sqrt(BETWEEN * SCALES_M.size());
    return sum * unit;
}

double Scenery::light_at(double x, double y) const
{
    double light = std::max(1 + gradient_[0] * x + gradient_[1] * y, 0.0);
    if (look_.shadow != 1) {
        const double beyond =
            shadow_normal_[0] * (x - shadow_point_[0]) + shadow_normal_[1] * (y - shadow_point_[1]);
        const double penumbra = std::max(look_.penumbra_mm * 1e-3, 1e-6);
        light *= look_.shadow + (1 - look_.shadow) * smooth_step(beyond / penumbra + 0.5);
    }
    return light;
}

std::vector<Prop> make_grass(const Scene &scene)
{
    constexpr int JOINTS = 6;
    Random random(scene.seed, Stream::GRASS);
    std::vector<Prop> blades;
    for (int i = 0; i < scene.look.grass; ++i) {
        const cv::Vec3d foot(random.uniform(-0.06, 0.06), random.uniform(-0.55, 0.55), 0);
        const double azimuth = random.uniform(0, 2 * PI), lean = random.uniform(20, 65) * RAD;
        const double length = random.uniform(0.03, 0.10), width = random.uniform(0.0015, 0.004);
        const double bow = random.uniform(0, 0.5);
        const cv::Vec3d out(std::cos(azimuth), std::sin(azimuth), 0), side(-out[1], out[0], 0);
        Prop blade;
        blade.level = random.uniform() < 0.7 ? random.uniform(25, 80) : random.uniform(150, 220);
        for (int joint = 0; joint <= 2 * JOINTS; ++joint) {
            const int k = joint <= JOINTS ? joint : 2 * JOINTS - joint;
            const double s = static_cast<double>(k) / JOINTS, angle = lean + bow * s;
            const cv::Vec3d spine = foot + out * (s * length * std::sin(angle)) +
                                    cv::Vec3d(0, 0, s * length * std::cos(angle));
            blade.corners.push_back(spine +
                                    side * ((joint <= JOINTS ? 0.5 : -0.5) * width * (1 - s)));
        }
        blades.push_back(blade);
    }
    return blades;
}

std::vector<Prop> make_head(const Scene &scene)
{
    constexpr int CORNERS = 96;
    constexpr double THICKNESS = 0.03, LEVEL = 30;
    std::vector<Prop> head;
    if (scene.look.head_diameter_mm > 0) {
        Prop disc{{}, LEVEL};
        const double radius = scene.look.head_diameter_mm * 0.5e-3;
        for (int i = 0; i < CORNERS; ++i) {
            const double a = 2 * PI * i / CORNERS;
            disc.corners.emplace_back(radius * std::cos(a), radius * std::sin(a), THICKNESS);
        }
        head.push_back(disc);
    }
    return head;
}

} // namespace opms::simulate
