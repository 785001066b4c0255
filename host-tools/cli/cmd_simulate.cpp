/* SPDX-License-Identifier: Apache-2.0 */
/* opms simulate: pictures of the bar or of the grid with their truth, from the project's own
 * renderer. */
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "simulate/simulate.hpp"

namespace
{

namespace sim = opms::simulate;

using Numbers = std::vector<double>;

struct Arguments {
    std::string kind; /**< "bar" or "grid" */
    std::string out, name, camera, poses;
    std::string bar = "hope33", grid = "a0-25";
    bool evaluation = false, json = false;
    int count = 1, min_visible = 0;
    std::uint64_t seed = 1;
    double tilt_deg = 0, blur_total = 0.75, print_gain_mm = 0, shutter_ms = 0;
    Numbers velocity = {0, 0, 0}, rotation = {0, 0, 0}, attitude = {0};
    sim::Look look;
    sim::PoseRange range;
    const CLI::Option *blur = nullptr;
};

/** Tries before a range is said to show too little of the pattern. */
constexpr int TRIES_MAX = 1000;

struct Work {
    sim::Scene scene;             /**< all but pose and seed */
    std::vector<sim::Pose> poses; /**< empty: at random */
};

sim::Motion motion_of(const Arguments &a)
{
    sim::Motion motion;
    motion.shutter_s = a.shutter_ms * 1e-3;
    motion.velocity_m_s = {a.velocity[0], a.velocity[1], a.velocity[2]};
    motion.rotation_rad_s = {a.rotation[0], a.rotation[1], a.rotation[2]};
    return motion;
}

Work prepare(const Arguments &a)
{
    Work work;
    sim::Scene &scene = work.scene;
    if (!a.camera.empty()) {
        scene.camera = sim::read_camera(a.camera);
    }
    const std::string pattern = a.kind == "bar" ? a.bar : a.evaluation ? "evaluation" : a.grid;
    scene.pattern = sim::make_pattern(pattern, a.print_gain_mm);
    scene.tilt_rad = a.tilt_deg * sim::RAD;
    scene.look = a.look;
    if (a.blur->count() == 0) {
        scene.look.blur_px = sim::optics_blur(a.blur_total);
    }
    scene.motion = motion_of(a);
    if (!a.poses.empty()) {
        work.poses = sim::read_poses(a.poses, scene);
    }
    std::error_code failure;
    std::filesystem::create_directories(a.out, failure);
    if (failure) {
        throw std::runtime_error(a.out + ": " + failure.message());
    }
    sim::write_camera(a.out + "/camera.yaml", scene.camera);
    return work;
}

sim::PoseRange range_of(const Arguments &a)
{
    sim::PoseRange range = a.range;
    const Numbers &deg = a.attitude;
    if (deg.size() == 2) {
        throw std::invalid_argument("--attitude-deg: one number or three are wanted");
    }
    range.attitude_deg = {deg.front(), deg.size() == 3 ? deg[1] : deg.front(), deg.back()};
    return range;
}

/** Place the camera for picture @p index. */
void place(const Arguments &a, const Work &work, int index, sim::Scene &scene)
{
    if (!work.poses.empty()) {
        scene.ground_camera = work.poses[static_cast<std::size_t>(index)];
        return;
    }
    if (a.kind == "grid" && a.range.distance_m[1] <= 0) {
        scene.ground_camera = sim::sample_lift(scene, index, a.count);
        return;
    }
    const sim::PoseRange range = range_of(a);
    for (int attempt = 0; attempt < TRIES_MAX; ++attempt) {
        scene.ground_camera = sim::sample_pose(scene, range, attempt);
        if (sim::count_visible(scene) >= a.min_visible) {
            return;
        }
    }
    throw std::invalid_argument("no pose in this range shows " + std::to_string(a.min_visible) +
                                (a.kind == "bar" ? " squares" : " nodes") +
                                "; lower --min-visible or change the range");
}

void report(const Arguments &a, const sim::Scene &scene, const std::string &stem, double ms)
{
    if (!a.json) {
        std::printf("%s.png  seed %llu  visible %d\n", stem.c_str(),
                    static_cast<unsigned long long>(scene.seed), sim::count_visible(scene));
        return;
    }
    const nlohmann::ordered_json row = {{"schema", "opms.simulate/1"},
                                        {"image", stem + ".png"},
                                        {"truth", stem + ".json"},
                                        {"seed", scene.seed},
                                        {"visible", sim::count_visible(scene)},
                                        {"render_ms", ms}};
    std::printf("%s\n", row.dump().c_str());
}

void simulate_one(const Arguments &a, const Work &work, int index)
{
    using Clock = std::chrono::steady_clock;
    sim::Scene scene = work.scene;
    scene.seed = a.seed + static_cast<std::uint64_t>(index);
    place(a, work, index, scene);
    const Clock::time_point start = Clock::now();
    const cv::Mat picture = sim::render(scene);
    const std::chrono::duration<double, std::milli> took = Clock::now() - start;
    std::array<char, 24> number{};
    std::snprintf(number.data(), number.size(), "_%05llu",
                  static_cast<unsigned long long>(scene.seed));
    const std::string name = (a.name.empty() ? a.kind : a.name) + number.data();
    sim::write_picture(a.out, name, a.kind, scene, picture);
    report(a, scene, (std::filesystem::path(a.out) / name).string(), took.count());
}

/** What the lists of options hold is not checked one by one. */
void require_finite(const char *name, const Numbers &numbers)
{
    for (const double number : numbers) {
        if (!std::isfinite(number)) {
            throw std::invalid_argument(std::string(name) + ": give finite numbers");
        }
    }
}

void check_lists(const Arguments &a)
{
    const sim::PoseRange &r = a.range;
    require_finite("--velocity", a.velocity);
    require_finite("--rotation", a.rotation);
    require_finite("--attitude-deg", a.attitude);
    for (const cv::Vec2d &range : {r.x_m, r.y_m, r.z_m, r.distance_m, r.incidence_deg,
                                   r.azimuth_deg, r.along_m, r.camera_roll_deg}) {
        require_finite("a range of poses", {range[0], range[1]});
    }
}

int simulate(const Arguments &a)
{
    try {
        check_lists(a);
        const Work work = prepare(a);
        const int count = work.poses.empty() ? a.count : static_cast<int>(work.poses.size());
        for (int i = 0; i < count; ++i) {
            simulate_one(a, work, i);
        }
        return EXIT_CODE_OK;
    } catch (const std::invalid_argument &e) {
        std::fprintf(stderr, "opms simulate: %s\n", e.what());
        return EXIT_CODE_USAGE;
    } catch (const std::exception &e) {
        std::fprintf(stderr, "opms simulate: %s\n", e.what());
        return EXIT_CODE_INPUT;
    }
}

/** As CLI::Range, but "nan" is in no range. */
CLI::Validator between(double low, double high)
{
    const CLI::Validator range = CLI::Range(low, high).description("");
    return {[range](std::string &text) {
                double value = 0;
                if (CLI::detail::lexical_cast(text, value) && std::isnan(value)) {
                    return std::string("Value nan is not a number");
                }
                return range(text);
            },
            ""};
}

void add_output(CLI::App &cmd, Arguments &a)
{
    cmd.add_option("--out", a.out, "Folder for NAME.png, NAME.json and camera.yaml")
        ->required()
        ->type_name("DIR");
    cmd.add_option("--count", a.count, "Pictures [1]")
        ->check(CLI::Range(1, 1000000).description(""));
    cmd.add_option("--seed", a.seed, "Of the first picture; each further one has the next [1]");
    cmd.add_option("--name", a.name, "NAME is this and the seed [" + a.kind + "]")
        ->check([](const std::string &s) {
            return s.find('/') == std::string::npos ? "" : "a name, not a path, is wanted";
        });
    cmd.add_option("--camera", a.camera, "Camera file [the HOPE camera]")->type_name("CAMERA.yaml");
    cmd.add_flag("--json", a.json, "One JSON object a picture (schema opms.simulate/1)");
}

void add_look(CLI::App &cmd, Arguments &a)
{
    sim::Look &look = a.look;
    const CLI::Validator level = between(0, 1000);
    const auto add = [&](const char *name, auto &value, const char *help) {
        return cmd.add_option(name, value, help)->group("Look (levels of an 8 bit picture)");
    };
    add("--black", look.black, "Level of ink [40]")->check(level);
    add("--white", look.white, "Level of paper [190]")->check(level);
    add("--gain", look.gain, "On all levels, so that paper can saturate [1]")
        ->check(between(0, 100));
    CLI::Option *total =
        add("--blur-total", a.blur_total, "Gaussian of optics and pixel together, px [0.75]");
    total->check(between(0.2887, 20));
    a.blur = add("--blur", look.blur_px, "Gaussian of the optics alone, px")
                 ->check(between(0, 20))
                 ->excludes(total);
    add("--noise", look.noise_read, "Standard deviation of the read noise [3]")->check(level);
    add("--shot", look.noise_shot, "Variance of the shot noise a level [0]")->check(level);
    add("--ground", look.ground, "Mean level of the soil [110]")->check(level);
    add("--ground-contrast", look.ground_contrast, "Standard deviation of the soil [15]")
        ->check(level);
    add("--light-gradient", look.light_gradient, "Relative change of the light a metre [0]")
        ->check(between(-10, 10));
    add("--shadow", look.shadow, "Light beyond a shadow's edge, 1 = no shadow [1]")
        ->check(between(0, 10));
    add("--penumbra-mm", look.penumbra_mm, "Width of that edge [10]")->check(level);
    add("--grass", look.grass, "Blades about the bar [0]")
        ->check(CLI::Range(0, 10000).description(""));
    add("--head-diameter-mm", look.head_diameter_mm, "Draw the detector's head [0: not]")
        ->check(level);
    add("--print-gain-mm", a.print_gain_mm, "Every black edge is this much outwards [0]")
        ->check(between(-5, 5));
    add("--bits", look.bits, "8 or 16 [8]")->check(CLI::IsMember({8, 16}).description(""));
}

void add_motion(CLI::App &cmd, Arguments &a)
{
    const char *group = "Motion (truth is at mid-exposure; frame: ground)";
    cmd.add_option("--velocity", a.velocity, "m/s")->expected(3)->type_name("X Y Z")->group(group);
    cmd.add_option("--rotation", a.rotation, "rad/s, about the detector's origin")
        ->expected(3)
        ->type_name("X Y Z")
        ->group(group);
    cmd.add_option("--shutter-ms", a.shutter_ms, "Exposure time [0]")
        ->check(between(0, 1000))
        ->group(group);
}

/** An option of two numbers, lowest and highest. */
void add_range(CLI::App &cmd, const char *name, cv::Vec2d &range, const char *help)
{
    cmd.add_option_function<std::vector<double>>(
           name,
           [&range, name](const std::vector<double> &v) {
               if (v[0] > v[1]) {
                   throw CLI::ValidationError(name, "the lowest comes first");
               }
               range = {v[0], v[1]};
           },
           help)
        ->expected(2)
        ->type_name("LOW HIGH")
        ->group("Where the camera is");
}

void add_poses(CLI::App &cmd, Arguments &a)
{
    const char *group = "Where the camera is";
    cmd.add_option("--poses,--pose-file", a.poses,
                   "One picture a pose of this JSON file, none at random")
        ->type_name("FILE.json")
        ->group(group);
    if (a.kind == "bar") {
        add_range(cmd, "--x-m", a.range.x_m, "Detector towards the operator [0.15 0.55]");
        add_range(cmd, "--y-m", a.range.y_m, "Detector along the bar [-0.5 0.5]");
        add_range(cmd, "--z-m", a.range.z_m, "Detector above the ground [0 0.115]");
        cmd.add_option("--attitude-deg", a.attitude,
                       "Detector's psi, phi, theta within plus or minus this; one or three [0]")
            ->expected(1, 3)
            ->group(group);
    }
    add_range(cmd, "--distance-m", a.range.distance_m,
              "Instead: camera looks at the pattern from this far");
    add_range(cmd, "--incidence-deg", a.range.incidence_deg,
              "... this far off the face's normal [0 0]");
    add_range(cmd, "--azimuth-deg", a.range.azimuth_deg,
              "... from this side, 0 = the operator's [0 360]");
    add_range(cmd, "--along-m", a.range.along_m, "... at this place along it [-0.45 0.45]");
    add_range(cmd, "--camera-roll-deg", a.range.camera_roll_deg,
              "Camera turned about its axis, with the detector [0 0]");
    cmd.add_option("--min-visible", a.min_visible,
                   "Whole squares (nodes) that a random pose must show [bar 4, grid 0]")
        ->group(group);
}

void add_kind(CLI::App &parent, const std::string &kind, const std::string &help, int &exit_code)
{
    const auto arguments = std::make_shared<Arguments>();
    Arguments &a = *arguments;
    a.kind = kind;
    CLI::App *cmd = parent.add_subcommand(kind, help);
    add_output(*cmd, a);
    if (kind == "bar") {
        a.min_visible = 4;
        cmd->add_option("--bar", a.bar, "hope33 or apriltag33 [hope33]")
            ->check(CLI::IsMember({"hope33", "apriltag33"}).description(""));
        cmd->add_option("--tilt-deg", a.tilt_deg,
                        "Tilt of the bar, positive: face turned away from the operator [0]")
            ->check(between(-89, 89));
    } else {
        cmd->add_option("--grid", a.grid, "Kind of grid: a0-25 [a0-25]")
            ->check(CLI::IsMember({"a0-25"}).description(""));
        cmd->add_flag("--evaluation", a.evaluation, "The sheet with a flat hope33 bar on it");
    }
    add_look(*cmd, a);
    add_motion(*cmd, a);
    add_poses(*cmd, a);
    cmd->callback([arguments, &exit_code] { exit_code = simulate(*arguments); });
}

} // namespace

void add_cmd_simulate(CLI::App &app, int &exit_code)
{
    CLI::App *cmd =
        app.add_subcommand("simulate", "Render pictures with their truth, for tests and figures.");
    cmd->require_subcommand(1);
    add_kind(*cmd, "bar", "The marker bar on soil, the detector in its working volume.", exit_code);
    add_kind(*cmd, "grid", "A calibration lift over the grid, first picture on the footprint.",
             exit_code);
}
