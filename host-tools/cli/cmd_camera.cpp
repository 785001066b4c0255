/* SPDX-License-Identifier: Apache-2.0 */
/* opms camera: what a camera file says, and the same in other programs' formats. */
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "camera_file.hpp"
#include "camera_file_write.hpp"
#include "camera_show.hpp"
#include "commands.hpp"
#include "result_stream.hpp"

namespace {

using opms_host::CameraFile;
using opms_host::CameraFormat;

constexpr CameraFormat FORMATS[] = {CameraFormat::ros, CameraFormat::opencv_yaml,
                                    CameraFormat::opencv_xml, CameraFormat::kalibr};

struct CameraArguments {
    std::string in, out, to, cam;
    bool json = false;
};

void talk(const std::string &line)
{
    std::fprintf(stderr, "opms: %s\n", line.c_str());
}

bool read_told(const CameraArguments &arguments, CameraFile &file)
{
    std::string error;
    if (!opms_host::camera_file_read(arguments.in, file, error, arguments.cam)) {
        talk(error);
        return false;
    }
    for (const std::string &note : file.notes) {
        talk(arguments.in + ": " + note);
    }
    return true;
}

int show(const CameraArguments &arguments)
{
    CameraFile file;
    if (!read_told(arguments, file)) {
        return EXIT_CODE_INPUT;
    }
    ResultStream out;
    const std::string text = arguments.json ? camera_show_json(arguments.in, file)
                                            : camera_show_text(arguments.in, file);
    return out.write_line(text) ? EXIT_CODE_OK : EXIT_CODE_INPUT;
}

/** By --to, else by the name: .xml can be but one; .yaml is the camera file. */
CameraFormat format_of(const CameraArguments &arguments)
{
    for (const CameraFormat format : FORMATS) {
        if (arguments.to == camera_format_name(format)) {
            return format;
        }
    }
    const std::string extension = std::filesystem::path(arguments.out).extension().string();
    return extension == ".xml" ? CameraFormat::opencv_xml : CameraFormat::ros;
}

bool plain_name(const std::string &path)
{
    const std::string extension = std::filesystem::path(path).extension().string();
    return extension == ".xml" || extension == ".yaml" || extension == ".yml";
}

int convert(const CameraArguments &arguments)
{
    if (arguments.to.empty() && !plain_name(arguments.out)) {
        talk(arguments.out + ": its name ends neither in .yaml nor in .xml; say which format by "
             "--to ros|opencv-yaml|opencv-xml|kalibr");
        return EXIT_CODE_USAGE;
    }
    CameraFile file;
    std::string error;
    if (!read_told(arguments, file)) {
        return EXIT_CODE_INPUT;
    }
    std::vector<std::string> notes;
    const CameraFormat format = format_of(arguments);
    if (!opms_host::camera_file_may_write(arguments.out, error) ||
        !opms_host::camera_file_write(arguments.out, file, error, format, &notes)) {
        talk(error);
        return EXIT_CODE_INPUT;
    }
    for (const std::string &note : notes) {
        talk(arguments.out + ": " + note);
    }
    talk(std::string("written as ") + camera_format_name(format) + ": " + arguments.out);
    return EXIT_CODE_OK;
}

void add_cam_option(CLI::App &cmd, CameraArguments &arguments)
{
    cmd.add_option("--cam", arguments.cam, "Which camera of a Kalibr chain: cam0, cam1, ...")
        ->type_name("NAME");
}

void add_show(CLI::App &group, int &exit_code)
{
    const auto arguments = std::make_shared<CameraArguments>();
    CLI::App *cmd = group.add_subcommand("show", "What a camera file says, and what it lacks.");
    cmd->add_option("FILE", arguments->in, "Camera file, or OpenCV's or Kalibr's")
        ->required()
        ->type_name("");
    add_cam_option(*cmd, *arguments);
    cmd->add_flag("--json", arguments->json, "One JSON object (schema opms.camera/1)");
    cmd->callback([arguments, &exit_code] { exit_code = show(*arguments); });
}

void add_convert(CLI::App &group, int &exit_code)
{
    const auto arguments = std::make_shared<CameraArguments>();
    CLI::App *cmd = group.add_subcommand("convert", "The same camera in another program's format.");
    cmd->add_option("IN", arguments->in, "Camera file, or OpenCV's or Kalibr's")
        ->required()
        ->type_name("");
    cmd->add_option("OUT", arguments->out, "File to write, or a camera file to replace")
        ->required()
        ->type_name("");
    cmd->add_option("--to", arguments->to,
                    "ros, opencv-yaml, opencv-xml or kalibr [by OUT's name: ros or opencv-xml]")
        ->type_name("FORMAT")
        ->check(CLI::IsMember({"ros", "opencv-yaml", "opencv-xml", "kalibr"}).description(""));
    add_cam_option(*cmd, *arguments);
    cmd->callback([arguments, &exit_code] { exit_code = convert(*arguments); });
}

}  // namespace

void add_cmd_camera(CLI::App &app, int &exit_code)
{
    CLI::App *group =
        app.add_subcommand("camera", "Camera files: show one, or convert it to another format.");
    group->require_subcommand(1);
    add_show(*group, exit_code);
    add_convert(*group, exit_code);
}
