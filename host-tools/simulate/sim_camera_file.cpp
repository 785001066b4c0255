/* SPDX-License-Identifier: Apache-2.0 */
/* The camera file, read and written for the renderer alone: yaml-cpp, and nothing of libopms. */
#include <cmath>
#include <fstream>
#include <iomanip>
#include <limits>
#include <sstream>
#include <stdexcept>

#include <yaml-cpp/yaml.h>

#include "simulate/simulate.hpp"

namespace opms::simulate
{
namespace
{

constexpr int SIZE_MAX_PX = 16384;

template <typename Container>
std::string list(const Container &values)
{
    std::ostringstream text;
    text << std::setprecision(std::numeric_limits<double>::max_digits10) << "[";
    const char *comma = "";
    for (const double value : values) {
        text << comma << value;
        comma = ", ";
    }
    text << "]";
    return text.str();
}

std::vector<double> numbers(const YAML::Node &node, const std::string &name, std::size_t least)
{
    if (!node || !node.IsSequence() || node.size() < least) {
        throw std::runtime_error(name + ": a list of " + std::to_string(least) +
                                 " numbers is wanted");
    }
    const auto values = node.as<std::vector<double>>();
    for (const double value : values) {
        if (!std::isfinite(value)) {
            throw std::runtime_error(name + ": a number is not finite");
        }
    }
    return values;
}

int size_px(const YAML::Node &root, const char *name)
{
    const int value = root[name] ? root[name].as<int>() : 0;
    if (value < 1 || value > SIZE_MAX_PX) {
        throw std::runtime_error(std::string(name) + ": 1 to 16384 is wanted");
    }
    return value;
}

void read_lens(const YAML::Node &root, Camera &camera)
{
    const std::vector<double> K = numbers(root["camera_matrix"]["data"], "camera_matrix", 9);
    camera.fx = K[0];
    camera.cx = K[2];
    camera.fy = K[4];
    camera.cy = K[5];
    if (!(camera.fx > 0 && camera.fy > 0)) {
        throw std::runtime_error("camera_matrix: fx and fy must be positive");
    }
    const auto model = root["distortion_model"].as<std::string>("plumb_bob");
    if (model != "plumb_bob") {
        throw std::runtime_error("distortion_model: " + model + " is not known, plumb_bob is");
    }
    const std::vector<double> D =
        numbers(root["distortion_coefficients"]["data"], "distortion_coefficients", 4);
    for (std::size_t i = 4; i < D.size(); ++i) {
        if (D[i] != 0) {
            throw std::runtime_error("distortion_coefficients: k3 must be 0");
        }
    }
    camera.k1 = D[0];
    camera.k2 = D[1];
    camera.p1 = D[2];
    camera.p2 = D[3];
}

/** Where the file does not say how the camera is mounted, HOPE's mounting stands. */
void read_mounting(const YAML::Node &opms, Camera &camera)
{
    if (!opms || !opms["R_detector_camera"] || !opms["t_detector_camera_m"]) {
        return;
    }
    const std::vector<double> R = numbers(opms["R_detector_camera"], "R_detector_camera", 9);
    const std::vector<double> t = numbers(opms["t_detector_camera_m"], "t_detector_camera_m", 3);
    Pose &pose = camera.detector_camera;
    pose = {cv::Matx33d(R.data()), cv::Vec3d(t[0], t[1], t[2])};
    if (!(cv::norm(pose.R * pose.R.t() - cv::Matx33d::eye()) < 1e-6) ||
        cv::determinant(pose.R) < 0) {
        throw std::runtime_error("R_detector_camera: no rotation");
    }
}

} // namespace

Camera read_camera(const std::string &path)
{
    try {
        const YAML::Node root = YAML::LoadFile(path);
        if (!root.IsMap()) {
            throw std::runtime_error("no camera file");
        }
        Camera camera;
        camera.width = size_px(root, "image_width");
        camera.height = size_px(root, "image_height");
        camera.name = root["camera_name"].as<std::string>("camera");
        read_lens(root, camera);
        read_mounting(root["opms"], camera);
        return camera;
    } catch (const YAML::BadFile &) {
        throw std::runtime_error(path + ": cannot be read");
    } catch (const std::exception &e) {
        throw std::runtime_error(path + ": " + e.what());
    }
}

void write_camera(const std::string &path, const Camera &c)
{
    const Pose &mounting = c.detector_camera;
    std::ofstream file(path);
    file
        << "image_width: " << c.width << "\nimage_height: " << c.height
        << "\ncamera_name: " << YAML::Dump(YAML::Node(c.name))
        << "\ncamera_matrix:\n  rows: 3\n  cols: 3\n  data: "
        << list(std::vector<double>{c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1})
        << "\ndistortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n  data: "
        << list(std::vector<double>{c.k1, c.k2, c.p1, c.p2, 0})
        << "\nrectification_matrix:\n  rows: 3\n  cols: 3\n  data: "
        << list(std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1})
        << "\nprojection_matrix:\n  rows: 3\n  cols: 4\n  data: "
        << list(std::vector<double>{c.fx, 0, c.cx, 0, 0, c.fy, c.cy, 0, 0, 0, 1, 0})
        << "\nopms:\n  version: 1\n  R_detector_camera: "
        << list(std::vector<double>(mounting.R.val, mounting.R.val + 9))
        << "\n  t_detector_camera_m: "
        << list(std::vector<double>(mounting.t.val, mounting.t.val + 3)) << "\n";
    file.close();
    if (!file) {
        throw std::runtime_error(path + ": cannot be written");
    }
}

} // namespace opms::simulate
