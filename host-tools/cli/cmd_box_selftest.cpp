/* SPDX-License-Identifier: Apache-2.0 */
/* opms box selftest: is this box well, from end to end? */
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "box_device.hpp"
#include "box_json.hpp"
#include "box_selftest.hpp"
#include "cmd_box.hpp"
#include "commands.hpp"
#include "result_stream.hpp"

namespace {

constexpr double WAIT_START_MAX_S = 3600;

struct SelftestArguments {
    std::string box = "hid";
    bool json = false;
    SelftestOptions options;
};

const char *result_name(CheckResult result)
{
    switch (result) {
    case CheckResult::ok: return "ok";
    case CheckResult::failed: return "failed";
    case CheckResult::skipped: break;
    }
    return "skipped";
}

std::string json_line(const std::string &unique_id, const Check &check)
{
    const BoxJson row = {{"schema", "opms.box.selftest/1"},
                         {"unique_id", unique_id},
                         {"check", check.name},
                         {"result", result_name(check.result)},
                         {"text", check.text}};
    return row.dump(-1, ' ', false, BoxJson::error_handler_t::replace);
}

std::string text_line(const Check &check)
{
    return box_text("%-8s %-10s ", result_name(check.result), check.name.c_str()) + check.text;
}

int selftest(const SelftestArguments &arguments)
{
    int exit_code = EXIT_CODE_OK;
    const auto device = BoxDevice::open(arguments.box, 0, exit_code);
    if (!device) {
        return exit_code;
    }
    const std::string unique_id = box_id_text(device->identity());
    ResultStream out;
    Selftest test(*device, arguments.options, [&](const Check &check) {
        out.write_line(arguments.json ? json_line(unique_id, check) : text_line(check));
    });
    test.run();
    if (out.failed()) {
        return EXIT_CODE_INPUT;
    }
    if (!device->is_connected()) {
        box_talk("the box is not plugged in any more");
        return EXIT_CODE_DEVICE;
    }
    if (test.failed() == 0) {
        box_talk("the box is well");
        return EXIT_CODE_OK;
    }
    box_talk(box_text("%u checks failed", test.failed()));
    return test.lost() && test.failed() == 1 ? EXIT_CODE_LOST : EXIT_CODE_RESULT;
}

} // namespace

void add_box_selftest(CLI::App &box, int &exit_code)
{
    const auto arguments = std::make_shared<SelftestArguments>();
    CLI::App *cmd = box.add_subcommand(
        "selftest", "Check a box from end to end, and say in plain words what is wrong.");
    add_box_option(*cmd, arguments->box);
    cmd->add_option("--wait-start", arguments->options.wait_start_s,
                    "Wait so long for you to give START, and check a run")
        ->type_name("S")
        ->check(CLI::Range(0.0, WAIT_START_MAX_S).description(""));
    cmd->add_flag("--loopback", arguments->options.loopback,
                  "A jumper joins TRIG and START: check both pins");
    cmd->add_flag("--stop", arguments->options.stop, "Stop a run that is going on first");
    cmd->add_flag("--json", arguments->json,
                  "One JSON object for each check (schema opms.box.selftest/1)");
    cmd->callback([arguments, &exit_code] { exit_code = selftest(*arguments); });
}
