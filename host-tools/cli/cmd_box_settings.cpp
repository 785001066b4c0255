/* SPDX-License-Identifier: Apache-2.0 */
/* opms box settings: show them, or change those that are given, and read them back. */
#include <cmath>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "box_device.hpp"
#include "box_json.hpp"
#include "cmd_box.hpp"
#include "commands.hpp"
#include "result_stream.hpp"

namespace {

constexpr double CYCLES_MAX = 4e9; /* what fits; the library knows the range */

/** As given; what was not given has a count of 0. */
struct SettingsArguments {
    std::string box = "hid";
    bool json = false, defaults = false;
    double period_ms = 0, debounce_us = 0;
    uint32_t width_us = 0, wait_timeout_s = 0;
    std::string trig, start, strobe, sync, preamble;
    const CLI::App *command = nullptr;

    bool given(const char *option) const { return command->count(option) > 0; }
};

/** Milliseconds or microseconds with a fraction to whole steps.
 * @return Whether it is a number of them. */
bool to_steps(double value, double steps_per_unit, uint32_t &steps)
{
    const double exact = value * steps_per_unit, whole = std::round(exact);
    if (!(whole >= 0 && whole <= CYCLES_MAX) || std::fabs(exact - whole) > 1e-3) {
        return false;
    }
    steps = static_cast<uint32_t>(whole);
    return true;
}

bool parse_preamble(const std::string &text, opms_settings_t &settings)
{
    std::vector<unsigned long> gaps;
    std::istringstream stream(text == "off" ? "" : text);
    for (std::string word; std::getline(stream, word, ',');) {
        if (word.empty() || word.size() > 5 ||
            word.find_first_not_of("0123456789") != std::string::npos) {
            return false;
        }
        gaps.push_back(std::stoul(word));
    }
    const bool is_good = gaps.size() <= OPMS_BOX_PREAMBLE_MAX &&
                         (!gaps.empty() || text == "off") && text.back() != ',';
    for (size_t i = 0; i < OPMS_BOX_PREAMBLE_MAX && is_good; ++i) {
        const unsigned long gap = i < gaps.size() ? gaps[i] : 0;
        if (gap > 65535 || (gap == 0 && i < gaps.size())) {
            return false;
        }
        settings.preamble_gap_ms[i] = static_cast<uint16_t>(gap);
    }
    return is_good;
}

void apply_words(const SettingsArguments &given, opms_settings_t &settings)
{
    if (given.given("--trig")) {
        settings.trig_active_low = given.trig == "active-low";
    }
    if (given.given("--start")) {
        settings.start_falling_edge = given.start == "falling";
    }
    if (given.given("--strobe")) {
        settings.strobe_enabled = given.strobe != "off";
        settings.strobe_active_low = given.strobe == "active-low";
    }
    if (given.given("--sync")) {
        settings.sync = given.sync == "1hz"   ? OPMS_SYNC_1HZ
                        : given.sync == "run" ? OPMS_SYNC_RUN
                                              : OPMS_SYNC_OFF;
    }
}

/** What was given, on top of what is in force. @return "" or what is wrong. */
std::string apply(const SettingsArguments &given, opms_settings_t &settings)
{
    if (given.defaults) {
        opms_wire_default_settings(&settings);
    }
    if (given.given("--period-ms") && !to_steps(given.period_ms, 1000, settings.period_us)) {
        return "--period-ms must be a whole number of microseconds";
    }
    if (given.given("--debounce-us") &&
        !to_steps(given.debounce_us, OPMS_BOX_CYCLES_PER_US, settings.debounce_cycles)) {
        return "--debounce-us must be a multiple of 0.008";
    }
    if (given.given("--preamble") && !parse_preamble(given.preamble, settings)) {
        return "--preamble " + given.preamble +
               ": give up to 8 gaps in ms with commas between them, such as 100,200,100, or off";
    }
    settings.width_us = given.given("--width-us") ? given.width_us : settings.width_us;
    if (given.given("--wait-timeout-s")) {
        settings.wait_timeout_s = static_cast<uint16_t>(given.wait_timeout_s);
    }
    apply_words(given, settings);
    const char *const wrong = opms_wire_check_settings(&settings);
    return wrong ? wrong : "";
}

bool changes(const SettingsArguments &given)
{
    for (const char *option : {"--defaults", "--period-ms", "--width-us", "--debounce-us",
                               "--trig", "--start", "--strobe", "--sync", "--preamble",
                               "--wait-timeout-s"}) {
        if (given.given(option)) {
            return true;
        }
    }
    return false;
}

bool write_text(const opms_settings_report_t &report)
{
    ResultStream out;
    const BoxJson settings = box_settings_json(report.settings);
    for (const auto &entry : settings.items()) {
        const std::string value = entry.key() == "preamble_ms" ? box_preamble_text(report.settings)
                                  : entry.value().is_string()  ? entry.value().get<std::string>()
                                                               : entry.value().dump();
        out.write_line(box_text("%-16s", entry.key().c_str()) + value);
    }
    out.write_line(box_text("%-16s", "kept in flash") + (report.stored ? "yes" : "no: defaults"));
    return !out.failed();
}

bool write_json(const BoxDevice &device, const opms_settings_report_t &report)
{
    BoxJson row = {{"schema", "opms.box.settings/1"},
                   {"unique_id", box_id_text(device.identity())}};
    row.update(box_settings_json(report.settings));
    row["stored"] = report.stored;
    row["settings_crc"] = report.settings_crc;
    ResultStream out;
    return out.write_line(row.dump());
}

int settings(const SettingsArguments &arguments)
{
    int exit_code = EXIT_CODE_OK;
    const auto device = BoxDevice::open(arguments.box, 0, exit_code);
    if (!device) {
        return exit_code;
    }
    opms_error_t error = {};
    opms_settings_report_t report = {};
    opms_status_t status = opms_box_get_settings(device->get(), 0, &report, &error);
    if (status == OPMS_OK && changes(arguments)) {
        opms_settings_t wanted = report.settings;
        const std::string wrong = apply(arguments, wanted);
        if (!wrong.empty()) {
            box_talk(wrong);
            return EXIT_CODE_USAGE;
        }
        status = opms_box_set_settings(device->get(), &wanted, 0, &report, &error);
    }
    if (status != OPMS_OK) {
        box_talk(error.message);
        return box_exit_code(status);
    }
    const bool written = arguments.json ? write_json(*device, report) : write_text(report);
    return written ? EXIT_CODE_OK : EXIT_CODE_INPUT;
}

void add_word(CLI::App &cmd, const char *name, std::string &value, const char *text,
              const std::vector<std::string> &words)
{
    cmd.add_option(name, value, text)->type_name("WORD")->check(
        CLI::IsMember(words).description(""));
}

} // namespace

void add_box_settings(CLI::App &box, int &exit_code)
{
    const auto arguments = std::make_shared<SettingsArguments>();
    CLI::App *cmd = box.add_subcommand(
        "settings", "Show the settings, or change those that are given. The box keeps them.");
    arguments->command = cmd;
    add_box_option(*cmd, arguments->box);
    cmd->add_option("--period-ms", arguments->period_ms, "Between two pulses, 10 to 10000")
        ->type_name("MS");
    cmd->add_option("--width-us", arguments->width_us, "Of a pulse, 10 to period - 1000")
        ->type_name("US");
    cmd->add_option("--debounce-us", arguments->debounce_us,
                    "For how long START must stay active, 0 to 10000")
        ->type_name("US");
    add_word(*cmd, "--trig", arguments->trig, "active-high or active-low",
             {"active-high", "active-low"});
    add_word(*cmd, "--start", arguments->start, "Edge that starts: rising or falling",
             {"rising", "falling"});
    add_word(*cmd, "--strobe", arguments->strobe,
             "The camera's exposure output: off, active-high or active-low",
             {"off", "active-high", "active-low"});
    add_word(*cmd, "--sync", arguments->sync, "What SYNC sends: off, 1hz or run",
             {"off", "1hz", "run"});
    cmd->add_option("--preamble", arguments->preamble, "Its gaps, such as 100,200,100, or off")
        ->type_name("MS,MS,...");
    cmd->add_option("--wait-timeout-s", arguments->wait_timeout_s,
                    "Longest wait for START, 0: for ever")
        ->type_name("S")
        ->check(CLI::Range(0, 65535).description(""));
    cmd->add_flag("--defaults", arguments->defaults, "Begin with the defaults");
    cmd->add_flag("--json", arguments->json, "One JSON object (schema opms.box.settings/1)");
    cmd->callback([arguments, &exit_code] { exit_code = settings(*arguments); });
}
