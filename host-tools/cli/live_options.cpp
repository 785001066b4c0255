/* SPDX-License-Identifier: Apache-2.0 */
#include "live_options.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "camera_file.hpp"
#include "commands.hpp"
#include "open_devices.hpp"
#include "scans_folder.hpp"
#include "sensor_feed.hpp"
#ifdef OPMS_CLI_HAVE_SIMULATED
#include "simulated_factory.hpp"
#endif

namespace {

using namespace opms_host;

constexpr double RAD = 3.14159265358979323846 / 180;

void talk(const std::string &line)
{
    std::fprintf(stderr, "opms: %s\n", line.c_str());
}

/** "all", "none" or a whole number from 1. @return false where it is none of them. */
bool picture_step(const std::string &text, std::uint32_t &every)
{
    if (text == "all" || text == "none") {
        every = text == "all" ? 1 : 0;
        return true;
    }
    char *end = nullptr;
    const long number = std::strtol(text.c_str(), &end, 10);
    every = static_cast<std::uint32_t>(number);
    return end != text.c_str() && *end == '\0' && number >= 1 && number <= 1'000'000;
}

CLI::Validator pictures_check()
{
    return CLI::Validator(
        [](std::string &text) {
            std::uint32_t every = 0;
            return picture_step(text, every) ? std::string()
                                             : text + " is not all, none or a number from 1";
        },
        "");
}

/** A place as open_devices() knows it. */
CLI::Validator place_check(std::string (*problem)(const std::string &))
{
    return CLI::Validator([problem](std::string &text) { return problem(text); }, "");
}

SessionMode mode_of(const std::string &text)
{
    return text == "capture"       ? SessionMode::capture
           : text == "calibration" ? SessionMode::calibration
                                   : SessionMode::position;
}

bool read_camera(const LiveArguments &arguments, SessionOptions &options)
{
    CameraFile file;
    std::string error;
    if (!camera_file_read(arguments.camera, file, error)) {
        talk(error);
        return false;
    }
    std::ifstream stream(arguments.camera, std::ios::binary);
    options.camera_file_text.assign(std::istreambuf_iterator<char>(stream), {});
    options.camera_file_name = arguments.camera;
    options.camera = file.camera;
    return true;
}

/** The box keeps its settings, but for the period that was asked for. */
bool ask_period(const LiveArguments &arguments, const Devices &devices, SessionOptions &options)
{
    if (!(arguments.period_ms > 0)) {
        return true;
    }
    std::string error;
    opms_settings_report_t report = {};
    if (!devices.box) {
        error = "--period-ms is of a box, and there is none";
    } else if (devices.box->settings(report, error)) {
        report.settings.period_us = static_cast<std::uint32_t>(std::lround(arguments.period_ms *
                                                                           1e3));
        options.box_settings = report.settings;
        return true;
    }
    talk(error);
    return false;
}

bool fill_options(const LiveArguments &arguments, SessionOptions &options)
{
    options.mode = mode_of(arguments.mode);
    if (!arguments.camera.empty() && !read_camera(arguments, options)) {
        return false;
    }
    options.bar_tilt_rad = arguments.tilt_deg * RAD;
    options.bar = arguments.bar;
    options.follow = !arguments.no_follow;
    options.source.frame_rate_hz = arguments.rate_hz;
    options.source.exposure_us = arguments.exposure_us;
    options.source.gain_db = arguments.gain_db;
    options.automatic_exposure =
        std::isnan(arguments.exposure_us) && std::isnan(arguments.gain_db);
    return true;
}

int exit_code_of(OpenFailure failure)
{
    switch (failure) {
    case OpenFailure::usage: return EXIT_CODE_USAGE;
    case OpenFailure::input: return EXIT_CODE_INPUT;
    case OpenFailure::device: return EXIT_CODE_DEVICE;
    case OpenFailure::none: break;
    }
    return EXIT_CODE_OK;
}

}  // namespace

void add_live_options(CLI::App &command, LiveArguments &a)
{
    command.add_option("--camera", a.camera, "Camera file; needed for positions")
        ->type_name("CAMERA.yaml");
    command.add_option("--box", a.box,
                       "Trigger box: hid[:ID], emulated[:PORT], simulated[:KEY=VALUE,...], "
                       "replay:SCAN or none [hid]")
        ->type_name("BOX")
        ->check(place_check(box_text_problem));
    command.add_option("--source", a.source,
                       "Camera: aravis:[NAME], v4l2:/dev/videoN, simulated[:KEY=VALUE,...], "
                       "replay:FOLDER or preview:N [aravis:]")
        ->type_name("SOURCE")
        ->check(place_check(source_text_problem));
    command.add_option("--mode", a.mode, "position, capture or calibration [position]")
        ->type_name("MODE")
        ->check(CLI::IsMember({"position", "capture", "calibration"}));
    command.add_option("--bar", a.bar, "Kind of bar [hope33]")->check(CLI::IsMember({"hope33"}));
    command.add_option("--tilt-deg", a.tilt_deg, "The bar's face is turned away by this angle [0]")
        ->type_name("D")
        ->check(CLI::Range(-90.0, 90.0));
    command.add_option("--folder", a.folder, "Where scans are kept [$OPMS_SCANS or ~/opms-scans]")
        ->type_name("DIR");
    command.add_option("--pictures", a.pictures, "Pictures to keep: all, none or each Nth [all]")
        ->type_name("N")
        ->check(pictures_check());
    command.add_flag("--no-recording", a.no_recording, "Keep nothing of the scan");
    command.add_flag("--no-follow", a.no_follow,
                     "Search each picture anew instead of from the last pose");
    command.add_option("--period-ms", a.period_ms, "Period of the trigger [as the box has it]")
        ->type_name("T")
        ->check(CLI::Range(10.0, 10'000.0));
    command.add_option("--rate-hz", a.rate_hz, "Pictures a second where there is no box [10]")
        ->type_name("F")
        ->check(CLI::Range(0.1, 1000.0));
    command.add_option("--exposure-us", a.exposure_us, "Fixed exposure [automatic]")
        ->type_name("T")
        ->check(CLI::Range(1.0, 1e7));
    command.add_option("--gain-db", a.gain_db, "Fixed gain [automatic]")
        ->type_name("G")
        ->check(CLI::Range(0.0, 60.0));
    command.add_option("--sensor", a.sensors,
                       "Samples of another sensor, from a table that may still grow")
        ->type_name("NAME=FILE.csv")
        ->take_all()
        ->allow_extra_args(false);
    command.add_flag("--wait", a.wait, "Wait for a box or camera that is not there yet");
}

std::unique_ptr<LiveSession> open_live_session(const LiveArguments &arguments, int &exit_code)
{
    SessionOptions options;
    if (arguments.camera.empty() && arguments.mode == "position") {
        talk("positions need the camera file: --camera CAMERA.yaml (opms calibrate makes it)");
        exit_code = EXIT_CODE_USAGE;
        return nullptr;
    }
    if (!fill_options(arguments, options)) {
        exit_code = EXIT_CODE_INPUT;
        return nullptr;
    }
    OpenRequest request;
    request.box = arguments.box;
    request.source = arguments.source;
    request.wait_for_missing = arguments.wait;
#ifdef OPMS_CLI_HAVE_SIMULATED
    request.simulated = simulated_devices;
#endif
    Devices devices;
    OpenError failure;
    if (!open_devices(request, devices, failure)) {
        talk(failure.text);
        exit_code = exit_code_of(failure.kind);
        return nullptr;
    }
    if (!ask_period(arguments, devices, options)) {
        exit_code = EXIT_CODE_DEVICE;
        return nullptr;
    }
    std::string error;
    auto session = LiveSession::create(std::move(devices), options, error);
    if (!session) {
        talk(error);
        exit_code = EXIT_CODE_INPUT;
    }
    return session;
}

std::string live_scans_folder(const LiveArguments &arguments)
{
    return arguments.folder.empty() ? scans_folder() : arguments.folder;
}

ScanRequest live_scan_request(const LiveArguments &arguments, const std::string &name)
{
    ScanRequest request;
    request.name = name;
    if (!arguments.no_recording) {
        RecorderOptions recording;
        recording.folder = live_scans_folder(arguments);
        picture_step(arguments.pictures, recording.picture_every);
        request.recording = recording;
    }
    request.settings_json = nlohmann::ordered_json{{"mode", arguments.mode},
                                                   {"follow", !arguments.no_follow},
                                                   {"box", arguments.box},
                                                   {"source", arguments.source},
                                                   {"pictures", arguments.pictures}}
                                .dump();
    return request;
}

bool live_sensor_files(const LiveArguments &arguments, std::vector<SensorFile> &files)
{
    for (const std::string &text : arguments.sensors) {
        SensorFile file;
        const std::string problem = sensor_option_problem(text, file.name, file.path);
        if (!problem.empty()) {
            talk(problem);
            return false;
        }
        files.push_back(file);
    }
    return true;
}

void live_feed_sensors(SensorFeeder &feeder, LiveSession &session)
{
    const auto take = [&session](const SensorRecord &record, std::string &error) {
        return session.add_sensor_sample(record, error);
    };
    for (const std::string &trouble :
         feeder.step(session.status().scan, *session.clock(), take)) {
        talk(trouble);
    }
}
