/* SPDX-License-Identifier: Apache-2.0 */
/* opms box flash: new firmware into the trigger box. */
#include <chrono>
#include <cstdio>
#include <memory>
#include <regex>
#include <string>
#include <thread>

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "box_flash_hid.hpp"
#include "cmd_box.hpp"
#include "commands.hpp"
#include "firmware_check.hpp"
#include "flash_session.hpp"
#include "picoboot_usb.hpp"
#include "result_stream.hpp"

namespace {

namespace flash = opms::flash;

#ifdef OPMS_CLI_HAVE_HID
constexpr bool HAVE_HID = true;
#else
constexpr bool HAVE_HID = false;
#endif

constexpr std::size_t BAR_WIDTH = 40;

struct FlashArguments {
    std::string file;
    std::string box = "hid";
    bool no_enter = false;
    bool json = false;
    bool progress = true;
};

/** A bar on stderr that is drawn over itself. */
class Bar {
public:
    explicit Bar(bool shown) : shown_(shown) {}

    void draw(std::size_t done, std::size_t total)
    {
        if (!shown_) {
            return;
        }
        const std::size_t full = done * BAR_WIDTH / total;
        std::fprintf(stderr, "\r[%s%s] %3zu %%", std::string(full, '#').c_str(),
                     std::string(BAR_WIDTH - full, ' ').c_str(), done * 100 / total);
        open_ = true;
        if (done == total) {
            end();
        }
    }

    void end()
    {
        if (open_) {
            std::fputc('\n', stderr);
            open_ = false;
        }
    }

private:
    bool shown_;
    bool open_ = false;
};

/** "hid" or "hid:ID" -> ID. */
bool parse_box(const std::string &text, std::string &id)
{
    static const std::regex form("hid(:([0-9A-Fa-f]{16}))?");
    std::smatch match;
    if (!std::regex_match(text, match, form)) {
        return false;
    }
    id = match[2];
    return true;
}

int exit_code_of(flash::Fault fault)
{
    return fault == flash::Fault::refused || fault == flash::Fault::verify ? EXIT_CODE_RESULT
                                                                           : EXIT_CODE_DEVICE;
}

/** Tell people on stderr and, with --json, programs on stdout. */
int fail(const FlashArguments &arguments, int exit_code, const std::string &why)
{
    std::fprintf(stderr, "opms: %s\n", why.c_str());
    if (arguments.json) {
        ResultStream().write_line(nlohmann::json{{"schema", "opms.box-flash/1"},
                                                 {"file", arguments.file},
                                                 {"state", "failed"},
                                                 {"reason", why}}
                                      .dump(-1, ' ', false,
                                            nlohmann::json::error_handler_t::replace));
    }
    return exit_code;
}

std::string report(const FlashArguments &arguments, const flash::Image &image,
                   const flash::BoxVersion &box)
{
    if (!arguments.json && !HAVE_HID) {
        return "written and verified";
    }
    if (!arguments.json) {
        return "box " + box.unique_id + " runs firmware " + box.firmware + " (" + box.git_hash +
               ")";
    }
    return nlohmann::json{{"schema", "opms.box-flash/1"},
                          {"file", arguments.file},
                          {"state", "flashed"},
                          {"bytes", image.payload_bytes},
                          {"unique_id", box.unique_id},
                          {"firmware_version", box.firmware},
                          {"git_hash", box.git_hash}}
        .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

flash::Image read_firmware(const std::string &file)
{
    flash::Image image = flash::uf2_read(file);
    try {
        flash::firmware_check(image);
    } catch (const flash::FileError &error) {
        throw flash::FileError(file + ": " + error.what());
    }
    return image;
}

int flash_box(const FlashArguments &arguments)
{
    flash::SessionOptions options;
    options.sees_boxes = HAVE_HID;
    options.may_enter = HAVE_HID && !arguments.no_enter;
    if (!parse_box(arguments.box, options.box_id)) {
        std::fprintf(stderr, "opms: --box %s: give hid, or hid: and the box's 16 hex digits\n",
                     arguments.box.c_str());
        return EXIT_CODE_USAGE;
    }
    if (!options.box_id.empty() && !options.may_enter) {
        std::fprintf(stderr, "opms: --box hid:ID asks a running box to restart: not with "
                             "--no-enter, nor without hidapi\n");
        return EXIT_CODE_USAGE;
    }
    Bar bar(arguments.progress && isatty(STDERR_FILENO) != 0);
    const flash::SessionHooks hooks = {
        [](const std::string &text) { std::fprintf(stderr, "opms: %s\n", text.c_str()); },
        [&bar](std::size_t done, std::size_t total) { bar.draw(done, total); },
        [](int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }};
    try {
        const flash::Image image = read_firmware(arguments.file);
        flash::UsbBootloaders bootloaders;
        HidBoxes boxes;
        const flash::BoxVersion box =
            flash::flash_session(image, options, bootloaders, boxes, hooks);
        return ResultStream().write_line(report(arguments, image, box)) ? EXIT_CODE_OK
                                                                        : EXIT_CODE_INPUT;
    } catch (const flash::FileError &error) {
        return fail(arguments, EXIT_CODE_INPUT, error.what());
    } catch (const flash::FlashError &error) {
        bar.end();
        return fail(arguments, exit_code_of(error.fault()), error.what());
    }
}

}  // namespace

void add_box_flash(CLI::App &box, int &exit_code)
{
    const auto arguments = std::make_shared<FlashArguments>();
    CLI::App *command = box.add_subcommand(
        "flash", "Write a firmware (UF2) into the box, verify it, and start it");
    command->add_option("file", arguments->file, "Firmware of the box, opms-box.uf2")
        ->required()
        ->type_name("FILE.uf2");
    command
        ->add_option("--box", arguments->box,
                     "Which one, if several are plugged in: hid:ID as `opms box list` shows it")
        ->capture_default_str();
    command->add_flag("--no-enter", arguments->no_enter,
                      "Leave running boxes alone; flash the Pico that waits in its bootloader");
    command->add_flag("--json", arguments->json, "Report as one JSON object");
    command->add_flag("--progress,!--no-progress", arguments->progress,
                      "Progress bar on stderr (on a terminal) [on]");
    command->callback([arguments, &exit_code] { exit_code = flash_box(*arguments); });
}
