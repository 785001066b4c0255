/* SPDX-License-Identifier: Apache-2.0 */
/* What the renderer makes of light: noise, cut, motion, props; and what it writes. */
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "simulate/sim_random.hpp"
#include "synth_check.hpp"

namespace
{

using namespace synth;

struct Moments {
    double mean = 0, sigma = 0;
};

Moments exposed(const sim::Look &look, float level)
{
    const cv::Mat light(500, 500, CV_32F, cv::Scalar(level));
    cv::Scalar mean, sigma;
    cv::meanStdDev(sim::expose(light, look, 7), mean, sigma);
    return {mean[0], sigma[0]};
}

void noise_has_its_size()
{
    sim::Look look;
    look.noise_read = 3;
    Moments m = exposed(look, 100.3F);
    check_below(std::abs(m.mean - 100.3), 0.03, "mean");
    check_below(std::abs(m.sigma - std::sqrt(9 + 1.0 / 12)), 0.02, "read noise and rounding");
    look.noise_shot = 0.2;
    m = exposed(look, 100);
    check_below(std::abs(m.sigma - std::sqrt(29 + 1.0 / 12)), 0.04, "shot noise");
    look.bits = 16;
    m = exposed(look, 100);
    check_below(std::abs(m.mean / 257 - 100), 0.05, "16 bit mean");
    check_below(std::abs(m.sigma / 257 - std::sqrt(29.0)), 0.04, "16 bit noise");
    look.bits = 8;
    look.noise_read = look.noise_shot = 0;
    check(exposed(look, 400).mean == 255 && exposed(look, -5).mean == 0, "cut at both ends");
}

void numbers_are_the_same_on_every_machine()
{
    sim::Random random(1, sim::Stream::POSE);
    /* xoshiro256** after splitmix64, computed apart from this code. */
    const double wanted[3] = {0x1.703eefb7a2d4bp-1, 0x1.9071a5bdb6670p-4, 0x1.194cee65e5a7fp-1};
    for (const double value : wanted) {
        check(random.uniform() == value, "pinned random number");
    }
    double sum = 0, squares = 0, fourth = 0;
    constexpr int COUNT = 200000;
    for (int i = 0; i < COUNT; ++i) {
        const double n = random.normal();
        sum += n;
        squares += n * n;
        fourth += n * n * n * n;
    }
    check_below(std::abs(sum / COUNT), 0.01, "mean of normals");
    check_below(std::abs(squares / COUNT - 1), 0.015, "variance of normals");
    check_below(std::abs(fourth / COUNT - 3), 0.12, "fourth moment of normals");
}

bool same(const cv::Mat &a, const cv::Mat &b)
{
    return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

void a_seed_decides_all()
{
    sim::Scene scene = clean_scene(0.3, 20, 10);
    scene.look.noise_read = 3;
    scene.look.ground_contrast = 15;
    scene.look.ground = 100;
    scene.look.grass = 20;
    const cv::Mat first = sim::render(scene);
    check(same(first, sim::render(scene)), "the same scene is the same picture");
    scene.seed = 2;
    check(!same(first, sim::render(scene)), "another seed is another picture");
}

void soil_has_its_contrast()
{
    sim::Scene scene = clean_scene(0.5, 0, 0);
    scene.look.ground = 100;
    scene.look.ground_contrast = 20;
    scene.pattern.sheet = {0, 0, 1e-3, 1e-3};
    scene.pattern.black.clear();
    scene.look.blur_px = 0.3;
    double mean_all = 0, variance_all = 0;
    constexpr int SEEDS = 20;
    for (int seed = 1; seed <= SEEDS; ++seed) {
        scene.seed = static_cast<std::uint64_t>(seed);
        cv::Scalar mean, sigma;
        const cv::Mat light = sim::render_light(scene);
        mean_all += cv::mean(light)[0] / SEEDS;
        cv::Mat off = light - 100;
        variance_all += off.dot(off) / static_cast<double>(off.total()) / SEEDS;
    }
    check_below(std::abs(mean_all - 100), 8, "mean of the soil");
    check_below(std::abs(std::sqrt(variance_all) - 20), 4, "contrast of the soil");
}

/** Centre of the step along a row between two columns. */
double step_centre(const cv::Mat &light, int row, int from, int to)
{
    double weight = 0, first = 0;
    for (int x = from; x < to; ++x) {
        const double step = light.at<float>(row, x + 1) - light.at<float>(row, x);
        weight += step;
        first += step * (x + 0.5);
    }
    return first / weight;
}

void motion_is_about_mid_exposure()
{
    /* Straight down, the side x = +10 mm moves across the columns. */
    sim::Scene scene = clean_scene(0.3, 0, 0);
    scene.camera.k1 = scene.camera.k2 = scene.camera.p1 = scene.camera.p2 = 0;
    scene.ground_camera = {cv::Matx33d(1, 0, 0, 0, -1, 0, 0, 0, -1), {0, 0, 0.3}};
    const int edge = static_cast<int>(scene.camera.cx + scene.camera.fx * 0.010 / 0.3);
    const double still = step_centre(sim::render_light(scene), 147, edge - 16, edge + 16);
    scene.motion.velocity_m_s = {0.5, 0, 0};
    scene.motion.shutter_s = 0.008;
    const cv::Mat moved = sim::render_light(scene);
    check_below(std::abs(step_centre(moved, 147, edge - 16, edge + 16) - still), 0.001,
                "edge of the moving bar against the still one, px");
    /* 4 mm at 0.3 m are 7.8 px: the edge is spread over them. */
    const double half = (scene.look.white + scene.look.black) / 2;
    check(moved.at<float>(147, edge - 2) > scene.look.black + 15 &&
              moved.at<float>(147, edge + 2) < scene.look.white - 15 &&
              std::abs(moved.at<float>(147, edge) - half) < 40,
          "the edge is smeared");
    const double shift =
        cv::norm(sim::ground_camera_at(scene, 0.004).t - sim::ground_camera_at(scene, -0.004).t);
    check_below(std::abs(shift - 0.004), 1e-12, "path of the camera, m");
    scene.motion.velocity_m_s = {0, 0, 0};
    scene.motion.rotation_rad_s = {0, 0, 1};
    const sim::Pose turned =
        sim::ground_camera_at(scene, 0.1) * scene.camera.detector_camera.inverse();
    check_below(cv::norm(turned.t - sim::ground_detector(scene).t), 1e-12,
                "the detector turns about its own origin, m");
    check_below(cv::norm(turned.R - sim::rotation({0, 0, 0.1}) * sim::ground_detector(scene).R),
                1e-12, "by its rate");
}

void props_cover_and_light_falls_off()
{
    sim::Scene scene = clean_scene(0.3, 0, 0);
    const cv::Mat plain = sim::render_light(scene);
    scene.look.grass = 40;
    check(cv::norm(plain, sim::render_light(scene), cv::NORM_INF) > 50, "grass is seen");
    scene.look.grass = 0;
    scene.look.shadow = 0.5;
    scene.look.light_gradient = 0;
    double low = 0, high = 0;
    cv::minMaxLoc(sim::render_light(scene), &low, &high);
    check(low < 0.55 * scene.look.black && high <= scene.look.white + 0.1, "shadow halves levels");
    scene.look.shadow = 1;
    scene.look.gain = 1.5;
    check_below(cv::norm(sim::render_light(scene), plain * 1.5, cv::NORM_INF), 1e-3,
                "gain acts on all levels");
}

void check_fields(const std::string &truth)
{
    const char *data = std::getenv("OPMS_TEST_DATA");
    if (data == nullptr) {
        check(false, "OPMS_TEST_DATA is not set");
        return;
    }
    std::ifstream file(std::string(data) + "/bar/bar_01002.json");
    const nlohmann::json wanted = nlohmann::json::parse(file),
                         written = nlohmann::json::parse(truth);
    for (const auto &[key, value] : wanted.items()) {
        check(written.contains(key) && written[key].size() == value.size(), "field " + key);
    }
}

void truth_can_be_read_back()
{
    const std::string folder = "synth_truth";
    std::filesystem::create_directories(folder);
    sim::Scene scene = clean_scene(0.3, 30, 77);
    scene.tilt_rad = 19.3 * sim::RAD;
    scene.camera.name = "odd: name #1";
    scene.look.bits = 16;
    const cv::Mat picture = sim::render(scene);
    sim::write_picture(folder, "one", "bar", scene, picture);
    check(same(picture, cv::imread(folder + "/one.png", cv::IMREAD_UNCHANGED)), "16 bit PNG");
    const std::vector<sim::Pose> poses = sim::read_poses(folder + "/one.json", scene);
    check(poses.size() == 1 && cv::norm(poses[0].R - scene.ground_camera.R) < 1e-12 &&
              cv::norm(poses[0].t - scene.ground_camera.t) < 1e-12,
          "pose of the truth");
    sim::write_camera(folder + "/camera.yaml", scene.camera);
    const sim::Camera camera = sim::read_camera(folder + "/camera.yaml");
    check(camera.name == scene.camera.name && camera.width == 400 && camera.k2 == scene.camera.k2 &&
              camera.p2 == scene.camera.p2 && camera.cx == scene.camera.cx &&
              cv::norm(camera.detector_camera.R - scene.camera.detector_camera.R) == 0,
          "camera file");
    check_fields(sim::truth_json(scene, "bar"));
}

void throws_with(const std::function<void()> &call, const std::string &text)
{
    try {
        call();
        check(false, "no error that says " + text);
    } catch (const std::exception &e) {
        check(std::string(e.what()).find(text) != std::string::npos,
              std::string(e.what()) + " does not say " + text);
    }
}

void bad_input_is_named()
{
    throws_with([] { sim::make_pattern("hope34"); }, "hope34");
    throws_with([] { sim::optics_blur(0.1); }, "0.2887");
    throws_with([] { sim::read_camera("nowhere.yaml"); }, "nowhere.yaml: cannot be read");
    std::ofstream("synth_bad.yaml") << "image_width: 0\n";
    throws_with([] { sim::read_camera("synth_bad.yaml"); }, "synth_bad.yaml: image_width");
    std::ofstream("synth_bad.json") << R"([{"R_bar_camera":[[2,0,0],[0,1,0],[0,0,1]],)"
                                       R"("t_bar_camera_m":[0,0,1]}])";
    throws_with([] { sim::read_poses("synth_bad.json", {}); }, "R_bar_camera is no rotation");
    throws_with([] { sim::write_picture("no/folder", "a", "bar", {}, cv::Mat(2, 2, CV_8U)); },
                "no/folder/a.png");
}

} // namespace

int main()
{
    return run_all(
        {{"noise has its size", noise_has_its_size},
         {"numbers are the same on every machine", numbers_are_the_same_on_every_machine},
         {"a seed decides all", a_seed_decides_all},
         {"soil has its contrast", soil_has_its_contrast},
         {"motion is about mid-exposure", motion_is_about_mid_exposure},
         {"props cover and light falls off", props_cover_and_light_falls_off},
         {"truth can be read back", truth_can_be_read_back},
         {"bad input is named", bad_input_is_named}});
}
