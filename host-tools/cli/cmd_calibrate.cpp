/* SPDX-License-Identifier: Apache-2.0 */
/* opms calibrate: from pictures of the calibration grid to a camera file. */
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "calibrate_check.hpp"
#include "calibrate_report.hpp"
#include "calibrate_run.hpp"
#include "calibrate_text.hpp"
#include "camera_file.hpp"
#include "camera_file_write.hpp"
#include "commands.hpp"
#include "report_file.hpp"
#include "result_stream.hpp"

namespace {

constexpr double RAD = 3.14159265358979323846 / 180, MM_PER_M = 1e3;
/* The head laid on printed ticks by hand. */
constexpr const char *SIGMA_DEFAULT = "0.5,0.2";
constexpr const char *FOOTPRINT_DEFAULT = "350,0,0";
constexpr double PLACE_MOST_MM = 10000, TURN_MOST_DEG = 360;
constexpr double COCKLE_MOST_MM = 100;
constexpr double SIGMA_MOST_MM = 500, SIGMA_MOST_DEG = 45;

struct CalibrateArguments {
    std::string grid;
    std::string footprint;
    std::string footprint_sigma = SIGMA_DEFAULT;
    std::vector<std::string> footprint_images;
    std::string out;
    std::string check; /**< a camera file to check instead */
    std::string name;
    std::string report;
    double cockle_mm = 0;
    unsigned white_level = 0;
    bool json = false;
    std::vector<std::string> images;
};

void talk(const std::string &line)
{
    std::fprintf(stderr, "opms: %s\n", line.c_str());
}

/** "350,0,0" -> numbers; false unless it is exactly @p count finite numbers. */
bool parse_numbers(const std::string &text, std::size_t count, std::vector<double> &numbers)
{
    numbers.clear();
    const char *at = text.data(), *const end = text.data() + text.size();
    while (numbers.size() < count) {
        double value = 0;
        const std::from_chars_result got = std::from_chars(at, end, value);
        if (got.ec != std::errc() || !std::isfinite(value)) {
            return false;
        }
        numbers.push_back(value);
        at = got.ptr;
        if (numbers.size() < count && (at == end || *at++ != ',')) {
            return false;
        }
    }
    return at == end;
}

bool parse_place(const std::string &text, FootprintPlace &place)
{
    std::vector<double> n;
    if (!parse_numbers(text, 3, n) || std::fabs(n[0]) > PLACE_MOST_MM ||
        std::fabs(n[1]) > PLACE_MOST_MM || std::fabs(n[2]) > TURN_MOST_DEG) {
        return false;
    }
    place.x_m = n[0] / MM_PER_M;
    place.y_m = n[1] / MM_PER_M;
    place.yaw_rad = n[2] * RAD;
    return true;
}

bool parse_sigma(const std::string &text, double &sigma_m, double &sigma_rad)
{
    std::vector<double> n;
    if (!parse_numbers(text, 2, n) || n[0] < 0 || n[0] > SIGMA_MOST_MM || n[1] < 0 ||
        n[1] > SIGMA_MOST_DEG) {
        return false;
    }
    sigma_m = n[0] / MM_PER_M;
    sigma_rad = n[1] * RAD;
    return true;
}

/** "FILE=X,Y,YAW"; a file's name may hold '=' itself. */
bool parse_place_of_image(const std::string &text, FootprintPlace &place)
{
    const std::size_t equals = text.rfind('=');
    if (equals == std::string::npos || equals == 0) {
        return false;
    }
    place.image = text.substr(0, equals);
    return parse_place(text.substr(equals + 1), place);
}

bool has_place(const CalibrateJob &job, const std::string &image)
{
    return std::any_of(job.footprints.begin(), job.footprints.end(),
                       [&](const FootprintPlace &place) { return place.image == image; });
}

/** @return false with @p error where two footprints are given for one picture. */
bool add_places_of_images(const CalibrateArguments &arguments, CalibrateJob &job,
                          std::string &error)
{
    for (const std::string &text : arguments.footprint_images) {
        FootprintPlace place;
        parse_place_of_image(text, place);
        if (has_place(job, place.image)) {
            error = "two footprints are given for " + place.image;
            return false;
        }
        if (std::find(job.images.begin(), job.images.end(), place.image) == job.images.end()) {
            job.images.push_back(place.image);
        }
        job.footprints.push_back(place);
    }
    return true;
}

bool make_job(const CalibrateArguments &arguments, CalibrateJob &job, std::string &error)
{
    job.images = arguments.images;
    job.white_level = static_cast<uint16_t>(arguments.white_level);
    job.cockle_sigma_m = arguments.cockle_mm / MM_PER_M;
    parse_sigma(arguments.footprint_sigma, job.footprint_sigma_m, job.footprint_sigma_rad);
    FootprintPlace first;
    first.image = arguments.images.front();
    const bool default_place = arguments.check.empty(); /* a check needs none, so it asks for it */
    parse_place(arguments.footprint.empty() ? FOOTPRINT_DEFAULT : arguments.footprint, first);
    const std::string prefix = first.image + "=";
    const bool given_by_image =
        std::any_of(arguments.footprint_images.begin(), arguments.footprint_images.end(),
                    [&](const std::string &text) {
                        return text.compare(0, prefix.size(), prefix) == 0 &&
                               text.rfind('=') + 1 == prefix.size();
                    });
    if ((!given_by_image && default_place) || !arguments.footprint.empty()) {
        job.footprints.push_back(first);
    }
    if (!add_places_of_images(arguments, job, error)) {
        return false;
    }
    if (job.images.size() > OPMS_CALIB_PICTURES_MAX) {
        error = std::to_string(job.images.size()) + " pictures are given; at most " +
                std::to_string(OPMS_CALIB_PICTURES_MAX) + " are calibrated together";
        return false;
    }
    return true;
}

std::string date_now()
{
    char text[32];
    const std::time_t now = std::time(nullptr);
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
    return text;
}

opms_host::CameraFile camera_file_of(const CalibrateArguments &arguments,
                                     const CalibrateResult &result)
{
    opms_host::CameraFile file;
    file.camera = result.camera;
    file.name = arguments.name;
    file.grid = arguments.grid;
    const FootprintPlace &place = result.footprints.front();
    file.footprint = opms_host::Footprint{place.x_m, place.y_m, place.yaw_rad};
    file.residual_rms_px = result.calib.residual_rms_px;
    file.date = date_now();
    return file;
}

void talk_about_footprints(const CalibrateJob &job, const CalibrateResult &result)
{
    for (const FootprintPlace &place : job.footprints) {
        const bool used =
            std::any_of(result.footprints.begin(), result.footprints.end(),
                        [&](const FootprintPlace &p) { return p.image == place.image; });
        if (!used) {
            talk(place.image + ": is not used, so its footprint does not count");
        }
    }
}

int exit_code_of(CheckVerdict verdict)
{
    switch (verdict) {
    case CheckVerdict::valid:
        return EXIT_CODE_OK;
    case CheckVerdict::lens_touched:
    case CheckVerdict::camera_moved:
    case CheckVerdict::cannot_tell:
        return EXIT_CODE_RESULT;
    case CheckVerdict::bad_pictures:
        break;
    }
    return EXIT_CODE_INPUT;
}

int check(const CalibrateArguments &arguments, const CalibrateJob &job)
{
    opms_host::CameraFile file;
    std::string error;
    if (!opms_host::camera_file_read(arguments.check, file, error)) {
        talk(error);
        return EXIT_CODE_INPUT;
    }
    if (!job.footprints.empty() && !file.camera.has_detector_camera) {
        talk(arguments.check + ": does not say where the camera sits on the detector, so a "
             "footprint tells nothing");
        return EXIT_CODE_INPUT;
    }
    const CheckResult result = calibrate_check(file, job, talk);
    if (result.verdict != CheckVerdict::valid) {
        talk(result.reason);
    }
    ResultStream out;
    const std::string text = arguments.json ? check_json(arguments.check, file, result)
                                            : check_text(arguments.check, file, result);
    return out.write_line(text) ? exit_code_of(result.verdict) : EXIT_CODE_INPUT;
}

int exit_code_of(CalibrateState state)
{
    switch (state) {
    case CalibrateState::calibrated:
        return EXIT_CODE_OK;
    case CalibrateState::undetermined:
    case CalibrateState::unsolved:
        return EXIT_CODE_RESULT;
    case CalibrateState::bad_pictures:
        break;
    }
    return EXIT_CODE_INPUT;
}

bool may_report(const CalibrateArguments &arguments, std::string &error)
{
    return arguments.report.empty() || report_open_folder(arguments.report, error);
}

/** @return false where a report was asked for and could not be written. */
bool report(const CalibrateArguments &arguments, const CalibrateJob &job,
            const CalibrateResult &result, const std::string &written)
{
    std::string error;
    if (arguments.report.empty()) {
        return true;
    }
    const CalibrateAsked asked = {arguments.grid, arguments.name, arguments.out};
    if (!report_write(arguments.report, calibrate_report(job, asked, result, written), error)) {
        talk(error);
        return false;
    }
    talk("report: " + arguments.report + "/report.html");
    return true;
}

int calibrate(const CalibrateArguments &arguments)
{
    CalibrateJob job;
    std::string error;
    if (!make_job(arguments, job, error)) {
        talk(error);
        return EXIT_CODE_USAGE;
    }
    if (!arguments.check.empty()) {
        return check(arguments, job);
    }
    if (!opms_host::camera_file_may_write(arguments.out, error) || !may_report(arguments, error)) {
        talk(error);
        return EXIT_CODE_INPUT;
    }
    CalibrateResult result = calibrate_run(job, talk);
    int exit_code = exit_code_of(result.state);
    std::string written;
    if (result.state == CalibrateState::calibrated) {
        talk_about_footprints(job, result);
        if (opms_host::camera_file_write(arguments.out, camera_file_of(arguments, result), error)) {
            written = arguments.out;
        } else {
            talk(error);
            result.reason = error;
            exit_code = EXIT_CODE_INPUT;
        }
    } else {
        talk(result.reason);
    }
    if (!report(arguments, job, result, written)) {
        exit_code = EXIT_CODE_INPUT;
    }
    ResultStream out;
    const std::string text =
        arguments.json ? calibrate_json(result, written) : calibrate_text(result, written);
    return out.write_line(text) ? exit_code : EXIT_CODE_INPUT;
}

CLI::Validator check_that(bool (*good)(const std::string &), const char *what)
{
    return CLI::Validator(
        [good, what](std::string &value) {
            return good(value) ? std::string() : value + " is not " + what;
        },
        "");
}

bool good_place(const std::string &text)
{
    FootprintPlace place;
    return parse_place(text, place);
}

bool good_place_of_image(const std::string &text)
{
    FootprintPlace place;
    return parse_place_of_image(text, place);
}

bool good_sigma(const std::string &text)
{
    double sigma_m = 0, sigma_rad = 0;
    return parse_sigma(text, sigma_m, sigma_rad);
}

void add_footprint_options(CLI::App &cmd, CalibrateArguments &arguments)
{
    cmd.add_option("--footprint", arguments.footprint,
                   "Where the head stood on the grid in the first picture [350,0,0]")
        ->type_name("X_MM,Y_MM,YAW_DEG")
        ->check(check_that(good_place, "X_MM,Y_MM,YAW_DEG"));
    cmd.add_option("--footprint-sigma", arguments.footprint_sigma,
                   "How well it was placed, standard deviations [0.5,0.2]")
        ->type_name("MM,DEG")
        ->check(check_that(good_sigma, "MM,DEG, neither negative"));
    cmd.add_option("--footprint-image", arguments.footprint_images,
                   "Another picture on a footprint; may be given again")
        ->type_name("FILE=X_MM,Y_MM,YAW_DEG")
        ->allow_extra_args(false)
        ->check(check_that(good_place_of_image, "FILE=X_MM,Y_MM,YAW_DEG"));
}

}  // namespace

void add_cmd_calibrate(CLI::App &app, int &exit_code)
{
    const auto arguments = std::make_shared<CalibrateArguments>();
    CLI::App *cmd = app.add_subcommand(
        "calibrate", "Pictures of the calibration grid in, a camera file out, or checked.");
    cmd->add_option("--grid", arguments->grid, "Kind of grid: a0-25")
        ->required()
        ->type_name("KIND")
        ->check(CLI::IsMember({"a0-25"}).description(""));
    add_footprint_options(*cmd, *arguments);
    CLI::Option_group *const task = cmd->add_option_group("one of both");
    task->require_option(1);
    task->add_option("--out", arguments->out, "Camera file to write or to replace")
        ->type_name("CAMERA.yaml");
    CLI::Option *const check_option =
        task->add_option("--check", arguments->check,
                         "Camera file to check: is it still valid? With --footprint the mounting, "
                         "too")
            ->type_name("CAMERA.yaml");
    cmd->add_option("--name", arguments->name, "The camera's name in the file")
        ->type_name("NAME")
        ->excludes(check_option);
    cmd->add_option("--cockle", arguments->cockle_mm,
                    "The sheet may be this much off a plane: estimate by how much [0]")
        ->type_name("MM")
        ->check(CLI::Range(0.0, COCKLE_MOST_MM).description(""))
        ->excludes(check_option);
    cmd->add_option("--report", arguments->report,
                    "Also write DIR/report.html: how good it is, and what to do again")
        ->type_name("DIR")
        ->excludes(check_option);
    cmd->add_option("--white-level", arguments->white_level,
                    "Grey level at saturation, 4095 for 12 bit in 16 [255 or 65535]")
        ->type_name("N")
        ->check(CLI::Range(0, 65535).description(""));
    cmd->add_flag("--json", arguments->json, "One JSON object (schema opms.calibrate/1)");
    cmd->add_option("IMAGE", arguments->images,
                    "In the order they were taken, the first on the footprint")
        ->required()
        ->type_name("");
    cmd->callback([arguments, &exit_code] { exit_code = calibrate(*arguments); });
}
