/* SPDX-License-Identifier: Apache-2.0 */
/* opms locate: from pictures of the marker bar to the detector's pose. */
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "camera_file.hpp"
#include "commands.hpp"
#include "locate_row.hpp"
#include "locate_run.hpp"
#include "overlay.hpp"
#include "picture_file.hpp"
#include "result_stream.hpp"
#include "text_table.hpp"

namespace {

constexpr double RAD = 3.14159265358979323846 / 180;

struct LocateArguments {
    std::string camera;
    std::string bar = "hope33";
    double tilt_deg = 0;
    unsigned white_level = 0;
    bool follow = false;
    std::string require;
    bool json = false;
    std::string overlay;
    std::vector<std::string> images;
};

/** What has gone wrong in the call so far. */
struct Tally {
    bool unread = false, unlocated = false, unwritten = false;
};

void talk(const std::string &line)
{
    std::fprintf(stderr, "opms: %s\n", line.c_str());
}

/** Read, locate and draw one picture. */
LocateResult do_picture(const LocateArguments &arguments, const std::string &image,
                        const opms_camera_t &camera, LocateRun &run, OverlayFolder *overlays,
                        Tally &tally)
{
    LocateResult result;
    result.image = image;
    const cv::Mat picture =
        picture_read(image, camera.lens.width_px, camera.lens.height_px, result.reason);
    if (!picture.empty()) {
        if (picture.channels() > 1) {
            talk(image + ": is in colour; its luma is used");
        }
        run.locate(picture, result);
    }
    if (!result.reason.empty()) {
        talk(image + ": " + result.reason);
        tally.unread = true;
    } else if (overlays) {
        std::string error;
        const OverlayScene scene{picture, camera, result,
                                 static_cast<uint16_t>(arguments.white_level)};
        if (!overlays->write(scene, error)) {
            talk(error);
            tally.unwritten = true;
        }
    }
    tally.unlocated |= !result.located();
    return result;
}

int exit_code_of(const LocateArguments &arguments, const Tally &tally)
{
    if (tally.unread || tally.unwritten) {
        return EXIT_CODE_INPUT;
    }
    return !arguments.require.empty() && tally.unlocated ? EXIT_CODE_RESULT : EXIT_CODE_OK;
}

int do_pictures(const LocateArguments &arguments, const opms_camera_t &camera, LocateRun &run,
                OverlayFolder *overlays)
{
    const std::size_t width = text_name_width(arguments.images);
    ResultStream out;
    Tally tally;
    if (!arguments.json) {
        out.write_line(locate_table_heading(camera.has_detector_camera != 0, width));
    }
    for (const std::string &image : arguments.images) {
        const LocateResult result = do_picture(arguments, image, camera, run, overlays, tally);
        if (!out.write_line(arguments.json ? locate_json_row(result)
                                           : locate_table_line(result, width))) {
            return EXIT_CODE_INPUT;
        }
    }
    return exit_code_of(arguments, tally);
}

int locate(const LocateArguments &arguments)
{
    std::string error;
    if (!locate_bar_supported(arguments.bar)) {
        talk("--bar " + arguments.bar + ": this program was built without libapriltag; install "
             "it and build again, or use --bar hope33");
        return EXIT_CODE_USAGE;
    }
    opms_host::CameraFile file;
    if (!opms_host::camera_file_read(arguments.camera, file, error)) {
        talk(error);
        return EXIT_CODE_INPUT;
    }
    for (const std::string &note : file.notes) {
        talk(arguments.camera + ": " + note);
    }
    std::unique_ptr<OverlayFolder> overlays;
    if (!arguments.overlay.empty()) {
        overlays = OverlayFolder::open(arguments.overlay, error);
        if (!overlays) {
            talk(error);
            return EXIT_CODE_INPUT;
        }
    }
    LocateSettings settings;
    settings.bar = arguments.bar;
    settings.bar_tilt_rad = arguments.tilt_deg * RAD;
    settings.follow = arguments.follow;
    settings.white_level = static_cast<uint16_t>(arguments.white_level);
    const std::unique_ptr<LocateRun> run = LocateRun::create(file.camera, settings, error);
    if (!run) {
        talk(arguments.camera + ": " + error);
        return EXIT_CODE_INPUT;
    }
    return do_pictures(arguments, file.camera, *run, overlays.get());
}

/** CLI11's range check lets NaN through. */
CLI::Validator tilt_check()
{
    return CLI::Validator(
        [](std::string &value) {
            double tilt = 0;
            const bool number = CLI::detail::lexical_cast(value, tilt);
            return number && tilt >= -90 && tilt <= 90 ? std::string()
                                                       : value + " is no angle from -90 to 90";
        },
        "");
}

}  // namespace

void add_cmd_locate(CLI::App &app, int &exit_code)
{
    const auto arguments = std::make_shared<LocateArguments>();
    CLI::App *cmd = app.add_subcommand(
        "locate", "Pictures of the marker bar in, position and orientation of the detector out.");
    cmd->add_option("--camera", arguments->camera, "Camera file (ROS camera_info YAML)")
        ->required()
        ->type_name("CAMERA.yaml");
    cmd->add_option("--bar", arguments->bar, "Kind of bar: hope33 or apriltag33 [hope33]")
        ->type_name("KIND")
        ->check(CLI::IsMember({"hope33", "apriltag33"}).description(""));
    cmd->add_option("--tilt-deg", arguments->tilt_deg,
                    "Tilt of the bar, positive: face turned away from the operator [0]")
        ->type_name("DEG")
        ->check(tilt_check());
    cmd->add_option("--white-level", arguments->white_level,
                    "Grey level at saturation, 4095 for 12 bit in 16 [255 or 65535]")
        ->type_name("N")
        ->check(CLI::Range(0, 65535).description(""));
    cmd->add_flag("--follow", arguments->follow,
                  "The pictures are a sequence: seek the bar near its last place first");
    cmd->add_option("--require", arguments->require,
                    "'located': exit with 1 when a picture is not located")
        ->type_name("STATE")
        ->check(CLI::IsMember({"located"}).description(""));
    cmd->add_flag("--json", arguments->json, "One JSON object a line (schema opms.locate/1)");
    cmd->add_option("--overlay", arguments->overlay,
                    "Write a picture of what was found for each IMAGE into this folder")
        ->type_name("DIR");
    cmd->add_option("IMAGE", arguments->images, "PNG, JPEG, TIFF, BMP or PGM, 8 or 16 bit")
        ->required()
        ->type_name("");
    cmd->callback([arguments, &exit_code] { exit_code = locate(*arguments); });
}
