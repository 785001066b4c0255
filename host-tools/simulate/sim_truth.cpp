/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures and their truth on disk. */
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <vector>

#include <nlohmann/json.hpp>

#include "png_matrix.hpp"
#include "sim_json.hpp"
#include "simulate/simulate.hpp"

namespace opms::simulate
{
namespace
{

using nlohmann::ordered_json;

constexpr int PNG_LEVEL = 1;
constexpr double PIXEL_VARIANCE = 1.0 / 12; /* of a square of side 1 */

bool is_moving(const Motion &m)
{
    return m.shutter_s > 0 && cv::norm(m.velocity_m_s) + cv::norm(m.rotation_rad_s) > 0;
}

ordered_json lens_json(const Camera &c)
{
    return {{"fx", c.fx}, {"fy", c.fy}, {"cx", c.cx}, {"cy", c.cy},
            {"k1", c.k1}, {"k2", c.k2}, {"p1", c.p1}, {"p2", c.p2}};
}

/** How it was drawn. contrast, noise and blur_px stand only where these three numbers say all. */
ordered_json render_json(const Scene &scene)
{
    const Look &look = scene.look;
    ordered_json j = {{"pattern", scene.pattern.name},
                      {"black", look.black * look.gain},
                      {"white", look.white * look.gain},
                      {"noise_read", look.noise_read},
                      {"noise_shot", look.noise_shot},
                      {"optics_blur_px", look.blur_px},
                      {"bits", look.bits},
                      {"visible", count_visible(scene)}};
    const bool plain = !is_moving(scene.motion) && look.noise_shot == 0 &&
                       look.light_gradient == 0 && look.shadow == 1 && look.grass == 0 &&
                       look.white * look.gain <= 255;
    if (plain) {
        j["contrast"] = (look.white - look.black) * look.gain;
        j["noise"] = look.noise_read;
        j["blur_px"] = total_blur(look.blur_px);
    }
    return j;
}

} // namespace

double optics_blur(double total_px)
{
    const double rest = total_px * total_px - PIXEL_VARIANCE;
    if (!(rest >= 0)) {
        throw std::invalid_argument("a total blur below 0.2887 px is less than a square pixel has");
    }
    return std::sqrt(rest);
}

double total_blur(double optics_px)
{
    return std::sqrt(optics_px * optics_px + PIXEL_VARIANCE);
}

std::string truth_json(const Scene &scene, const std::string &kind)
{
    const Pose bar = bar_camera(scene), detector = ground_detector(scene);
    const Pose &mounting = scene.camera.detector_camera;
    const bool moving = is_moving(scene.motion);
    const cv::Vec3d still(0, 0, 0);
    ordered_json j;
    j["kind"] = kind;
    j["seed"] = scene.seed;
    j["image"] = {scene.camera.width, scene.camera.height};
    j["camera"] = lens_json(scene.camera);
    j["bar_tilt_deg"] = scene.tilt_rad / RAD;
    j["R_ground_bar"] = to_json(ground_bar(scene).R);
    j["R_ground_camera"] = to_json(scene.ground_camera.R);
    j["t_ground_camera_m"] = to_json(scene.ground_camera.t);
    j["R_bar_camera"] = to_json(bar.R);
    j["t_bar_camera_m"] = to_json(bar.t);
    j["R_ground_detector"] = to_json(detector.R);
    j["t_ground_detector_m"] = to_json(detector.t);
    j["R_detector_camera"] = to_json(mounting.R);
    j["t_detector_camera_m"] = to_json(mounting.t);
    j["velocity_m_s"] = to_json(moving ? scene.motion.velocity_m_s : still);
    j["shutter_s"] = scene.motion.shutter_s;
    j["rotation_rad_s"] = to_json(moving ? scene.motion.rotation_rad_s : still);
    j["render"] = render_json(scene);
    return j.dump(1);
}

void write_picture(const std::string &folder, const std::string &name, const std::string &kind,
                   const Scene &scene, const cv::Mat &picture)
{
    const std::string stem = folder + "/" + name;
    const std::vector<unsigned char> file = opms_host::png_from_matrix(picture, PNG_LEVEL);
    std::ofstream out(stem + ".png", std::ios::binary);
    out.write(reinterpret_cast<const char *>(file.data()),
              static_cast<std::streamsize>(file.size()));
    out.close();
    if (file.empty() || !out) {
        throw std::runtime_error(stem + ".png: cannot be written");
    }
    std::ofstream truth(stem + ".json");
    truth << truth_json(scene, kind) << "\n";
    truth.close();
    if (!truth) {
        throw std::runtime_error(stem + ".json: cannot be written");
    }
}

} // namespace opms::simulate
