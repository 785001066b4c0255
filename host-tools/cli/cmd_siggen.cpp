/* SPDX-License-Identifier: Apache-2.0 */
/* opms siggen: the bench's signal generator, on a single-board computer. */
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "edge_report.hpp"
#include "result_stream.hpp"
#include "siggen_run.hpp"

namespace {

namespace sg = opms::siggen;

struct SiggenArguments {
    std::string chip = "gpiochip0";
    int start = GPIO_NO_LINE, trig = GPIO_NO_LINE, strobe = GPIO_NO_LINE;
    std::vector<std::string> active_low;
    std::int64_t count = 1;
    double period_ms = 1000, width_us = 1000;
    std::vector<double> glitch_us;
    double strobe_delay_us = 500, strobe_width_us = 10000;
    sg::Limits limits;
    bool json = false;
};

volatile std::sig_atomic_t interrupted = 0;

void on_signal(int)
{
    interrupted = 1;
}

/** While it lives, Ctrl-C ends the run early but in order: lines inactive, report given. */
class SignalGuard {
public:
    SignalGuard()
    {
        interrupted = 0;
        old_int_ = std::signal(SIGINT, on_signal);
        old_term_ = std::signal(SIGTERM, on_signal);
    }
    ~SignalGuard()
    {
        std::signal(SIGINT, old_int_);
        std::signal(SIGTERM, old_term_);
    }
    SignalGuard(const SignalGuard &) = delete;
    SignalGuard &operator=(const SignalGuard &) = delete;

private:
    void (*old_int_)(int) = SIG_DFL;
    void (*old_term_)(int) = SIG_DFL;
};

std::int64_t ns(double us)
{
    return std::llround(std::clamp(us, -1e12, 1e12) * 1e3);
}

sg::RunOptions run_options(const SiggenArguments &arguments)
{
    sg::RunOptions options;
    options.plan.count = arguments.count;
    options.plan.period_ns = ns(arguments.period_ms * 1e3);
    options.plan.width_ns = ns(arguments.width_us);
    for (const double glitch_us : arguments.glitch_us) {
        options.plan.glitch_ns.push_back(ns(glitch_us));
    }
    options.listens = arguments.trig != GPIO_NO_LINE;
    options.strobe = {arguments.strobe != GPIO_NO_LINE, ns(arguments.strobe_delay_us),
                      ns(arguments.strobe_width_us)};
    return options;
}

std::string usage_problem(const SiggenArguments &arguments, const sg::RunOptions &options)
{
    const bool limited =
        arguments.limits.expect_period_us > 0 || arguments.limits.max_jitter_us > 0;
    if (arguments.trig == GPIO_NO_LINE && (limited || options.strobe.on)) {
        return "--expect-period-us, --max-jitter-us and --strobe need --trig";
    }
    if (arguments.start == arguments.trig || arguments.start == arguments.strobe ||
        (options.strobe.on && arguments.trig == arguments.strobe)) {
        return "--start, --trig and --strobe must be different lines";
    }
    return sg::plan_check(options.plan);
}

gpio_config_t gpio_config(const SiggenArguments &arguments, const std::string &path)
{
    const auto is_low = [&](const char *name) {
        return std::find(arguments.active_low.begin(), arguments.active_low.end(), name) !=
               arguments.active_low.end();
    };
    gpio_config_t config{};
    config.chip_path = path.c_str();
    config.lines[GPIO_START] = {arguments.start, is_low("start")};
    config.lines[GPIO_STROBE] = {arguments.strobe, is_low("strobe")};
    config.lines[GPIO_TRIG] = {arguments.trig, is_low("trig")};
    return config;
}

sg::Summary lateness(const std::vector<sg::Sent> &sent)
{
    std::vector<double> late_us;
    for (const sg::Sent &one : sent) {
        late_us.push_back(static_cast<double>(one.late_ns()) * 1e-3);
    }
    return sg::summarize(late_us);
}

nlohmann::json summary_json(const sg::Summary &summary)
{
    if (summary.count == 0) {
        return nullptr;
    }
    return {{"count", summary.count}, {"mean", summary.mean}, {"sd", summary.sd},
            {"min", summary.min},     {"max", summary.max}};
}

nlohmann::json trig_json(const SiggenArguments &arguments, const sg::EdgeReport &report)
{
    const bool delays = report.start_to_edge_us.count > 0;
    nlohmann::json json = {{"line", arguments.trig},
                           {"edges", report.edges},
                           {"before_start", report.before_start},
                           {"period_us", summary_json(report.period_us)},
                           {"jitter_us", report.jitter_us},
                           {"missed", report.missed},
                           {"extra", report.extra},
                           {"first_edge_delay_us", nullptr},
                           {"start_to_edge_us", summary_json(report.start_to_edge_us)},
                           {"dropped_by_kernel", nullptr},
                           {"clock", report.same_clock ? "monotonic" : "other"}};
    if (delays) {
        json["first_edge_delay_us"] = report.first_edge_delay_us;
    }
    if (gpio_lines_sees_dropped()) {
        json["dropped_by_kernel"] = report.dropped;
    }
    return json;
}

nlohmann::json row(const SiggenArguments &arguments, const sg::Run &run,
                   const sg::EdgeReport &report, const sg::Verdict &verdict)
{
    nlohmann::json json = {{"schema", "opms.siggen/1"},
                           {"chip", sg::chip_path(arguments.chip)},
                           {"library", gpio_lines_library()},
                           {"stopped", run.stopped},
                           {"start",
                            {{"line", arguments.start},
                             {"pulses", run.starts.size()},
                             {"period_us", arguments.period_ms * 1e3},
                             {"width_us", arguments.width_us},
                             {"late_us", summary_json(lateness(run.starts))},
                             {"glitches", run.glitches}}},
                           {"trig", nullptr},
                           {"strobe", nullptr},
                           {"lost", verdict.lost},
                           {"failures", verdict.failures}};
    if (arguments.trig != GPIO_NO_LINE) {
        json["trig"] = trig_json(arguments, report);
    }
    if (arguments.strobe != GPIO_NO_LINE) {
        json["strobe"] = {{"line", arguments.strobe},
                          {"pulses", run.strobes.size()},
                          {"delay_us", arguments.strobe_delay_us},
                          {"width_us", arguments.strobe_width_us},
                          {"late_us", summary_json(lateness(run.strobes))}};
    }
    return json;
}

std::string summary_text(const char *name, const sg::Summary &s)
{
    char text[200];
    std::snprintf(text, sizeof text, "%s %.3f us (sd %.3f, min %.3f, max %.3f, of %lld)", name,
                  s.mean, s.sd, s.min, s.max, static_cast<long long>(s.count));
    return text;
}

std::vector<std::string> lines_of_text(const SiggenArguments &arguments, const sg::Run &run,
                                       const sg::EdgeReport &report)
{
    std::vector<std::string> text = {
        "START  " + std::to_string(run.starts.size()) + " pulses, " +
            std::to_string(run.glitches) + " glitches",
        "       " + summary_text("late by", lateness(run.starts))};
    if (arguments.trig != GPIO_NO_LINE) {
        text.push_back("TRIG   " + std::to_string(report.edges) + " edges, " +
                       std::to_string(report.before_start) + " of them before START; " +
                       std::to_string(report.missed) + " missed, " + std::to_string(report.extra) +
                       " extra");
        text.push_back("       " + summary_text("period", report.period_us));
        text.push_back("       " + summary_text("after START", report.start_to_edge_us));
    }
    if (arguments.strobe != GPIO_NO_LINE) {
        text.push_back("STROBE " + std::to_string(run.strobes.size()) + " pulses");
        text.push_back("       " + summary_text("late by", lateness(run.strobes)));
    }
    return text;
}

int report_run(const SiggenArguments &arguments, const sg::Run &run)
{
    sg::EdgeReport report;
    sg::Verdict verdict;
    if (arguments.trig != GPIO_NO_LINE) {
        report = sg::report_edges(run, arguments.limits);
        verdict = sg::judge(report, arguments.limits);
    }
    ResultStream out;
    if (arguments.json) {
        out.write_line(row(arguments, run, report, verdict).dump());
    } else {
        for (const std::string &line : lines_of_text(arguments, run, report)) {
            out.write_line(line);
        }
    }
    for (const std::string &failure : verdict.failures) {
        std::fprintf(stderr, "opms: %s\n", failure.c_str());
    }
    if (verdict.lost) {
        std::fprintf(stderr, "opms: %s\n",
                     report.edges == report.before_start
                         ? "no edge of TRIG came after START: is the box WAITING, is TRIG wired?"
                         : "pulses are missing");
    }
    return out.failed()                 ? EXIT_CODE_INPUT
           : verdict.lost               ? EXIT_CODE_LOST
           : !verdict.failures.empty() ? EXIT_CODE_RESULT
                                        : EXIT_CODE_OK;
}

int siggen(const SiggenArguments &arguments)
{
    const sg::RunOptions options = run_options(arguments);
    const std::string problem = usage_problem(arguments, options);
    if (!problem.empty()) {
        std::fprintf(stderr, "opms: %s\n", problem.c_str());
        return EXIT_CODE_USAGE;
    }
    try {
        const std::string path = sg::chip_path(arguments.chip);
        sg::MonotonicClock clock;
        sg::ChipLines lines(gpio_config(arguments, path));
        const SignalGuard guard;
        return report_run(arguments,
                          sg::run(options, lines, clock, [] { return interrupted != 0; }));
    } catch (const sg::LineError &error) {
        std::fprintf(stderr, "opms: %s\n", error.what());
        return EXIT_CODE_DEVICE;
    }
}

void add_signal_options(CLI::App &command, SiggenArguments &arguments)
{
    command.add_option("--count", arguments.count, "START pulses to send")->capture_default_str();
    command
        .add_option("--period-ms", arguments.period_ms,
                    "From START to START, and how long TRIG is awaited after the last one")
        ->capture_default_str();
    command.add_option("--width-us", arguments.width_us, "Width of a START pulse")
        ->capture_default_str();
    command
        .add_option("--glitch-us", arguments.glitch_us,
                    "Half a period before each START send a pulse this wide, which the box must "
                    "reject; several widths take turns")
        ->type_name("US");
    command
        .add_option("--strobe-delay-us", arguments.strobe_delay_us,
                    "From TRIG's edge to the exposure")
        ->check(CLI::Range(0.0, 1e7))
        ->capture_default_str();
    command.add_option("--strobe-width-us", arguments.strobe_width_us, "Length of the exposure")
        ->check(CLI::Range(1.0, 1e7))
        ->capture_default_str();
}

void add_limits(CLI::App &command, SiggenArguments &arguments)
{
    command
        .add_option("--expect-period-us", arguments.limits.expect_period_us,
                    "Period of TRIG that the box was set to; another one fails")
        ->check(CLI::PositiveNumber);
    command
        .add_option("--max-jitter-us", arguments.limits.max_jitter_us,
                    "Largest distance of an interval from the period; more fails")
        ->check(CLI::PositiveNumber);
}

}  // namespace

void add_cmd_siggen(CLI::App &app, int &exit_code)
{
    const auto arguments = std::make_shared<SiggenArguments>();
    CLI::App *command = app.add_subcommand(
        "siggen", "Signal generator of the bench: START pulses out of a single-board computer's "
                  "GPIO lines, TRIG counted and timed");
    command->add_option("--chip", arguments->chip, "GPIO chip: name, number or path")
        ->capture_default_str();
    command->add_option("--start", arguments->start, "Line that drives the box's START")
        ->required()
        ->check(CLI::NonNegativeNumber);
    command->add_option("--trig", arguments->trig, "Line that the box's TRIG drives")
        ->check(CLI::NonNegativeNumber);
    command
        ->add_option("--strobe", arguments->strobe,
                     "Line that drives the box's STROBE: an exposure after each TRIG")
        ->check(CLI::NonNegativeNumber);
    command
        ->add_option("--active-low", arguments->active_low, "Signals that are low when active")
        ->check(CLI::IsMember({"start", "trig", "strobe"}))
        ->delimiter(',');
    add_signal_options(*command, *arguments);
    add_limits(*command, *arguments);
    command->add_flag("--json", arguments->json, "Report as one JSON object");
    command->callback([arguments, &exit_code] { exit_code = siggen(*arguments); });
}
