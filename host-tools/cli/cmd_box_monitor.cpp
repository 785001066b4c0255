/* SPDX-License-Identifier: Apache-2.0 */
/* opms box monitor: a live view of a box, or a row a second. */
#include <chrono>
#include <cmath>
#include <memory>
#include <string>

#include <unistd.h>

#include <CLI/CLI.hpp>

#include "box_device.hpp"
#include "box_monitor_view.hpp"
#include "box_watch.hpp"
#include "cmd_box.hpp"
#include "commands.hpp"
#include "interrupted.hpp"
#include "number_check.hpp"
#include "result_stream.hpp"
#include "text_screen.hpp"

namespace {

using Clock = std::chrono::steady_clock;

constexpr uint32_t PING_INTERVAL_MS = 100;
constexpr uint32_t POLL_MS = 50;
constexpr std::chrono::milliseconds REDRAW(250), ROW(1000);

struct MonitorArguments {
    std::string box = "hid";
    double seconds = 0; /* 0: until Ctrl-C */
    bool json = false, arm = false, start = false;
};

class Monitor {
public:
    Monitor(const MonitorArguments &arguments, const BoxDevice &device, uint32_t period_us)
        : arguments_(arguments), device_(device), watch_(period_us),
          screen_(!arguments.json && isatty(STDOUT_FILENO)),
          unique_id_(box_id_text(device.identity()))
    {
    }

    int run();

private:
    opms_status_t arm();
    void disarm();
    void take(const opms_box_item_t &item);
    bool show(Clock::time_point now);
    int exit_code();

    const MonitorArguments &arguments_;
    const BoxDevice &device_;
    BoxWatch watch_;
    bool screen_;
    std::string unique_id_;
    TextScreen drawing_;
    ResultStream out_;
    Clock::time_point begin_ = Clock::now();
};

opms_status_t Monitor::arm()
{
    opms_error_t error = {};
    const opms_status_t status = opms_box_arm(device_.get(), box_new_session(), 0, &error);
    if (status != OPMS_OK) {
        box_talk(error.message);
    }
    return status;
}

void Monitor::disarm()
{
    opms_error_t error = {};
    if (opms_box_disarm(device_.get(), 0, &error) != OPMS_OK) {
        box_talk(error.message);
    }
    for (opms_box_item_t item = {};
         opms_box_poll(device_.get(), POLL_MS, &item, nullptr) == OPMS_OK && item.kind;) {
        watch_.take(item);
    }
}

void Monitor::take(const opms_box_item_t &item)
{
    watch_.take(item);
    if (item.kind != OPMS_ITEM_EVENT) {
        return;
    }
    if (item.as.event.kind == OPMS_EVENT_WAITING && arguments_.start) {
        opms_box_emulate_line(device_.get(), OPMS_EMULATED_START, true, 0, nullptr);
        opms_box_emulate_line(device_.get(), OPMS_EMULATED_START, false, 20'000'000, nullptr);
    } else if (item.as.event.kind == OPMS_EVENT_SETTINGS_STORED) {
        opms_settings_report_t report = {};
        if (opms_box_get_settings(device_.get(), 0, &report, nullptr) == OPMS_OK) {
            watch_.set_period(report.settings.period_us);
        }
    }
}

bool Monitor::show(Clock::time_point now)
{
    const MonitorRow row = {std::chrono::duration<double>(now - begin_).count(), unique_id_,
                            watch_.take_latency_ms(), device_.counters(), watch_.take_news()};
    if (screen_) {
        return drawing_.draw(monitor_screen(watch_, row));
    }
    return out_.write_line(arguments_.json ? monitor_json(watch_, row)
                                           : monitor_line(watch_, row));
}

int Monitor::exit_code()
{
    const opms_box_counters_t counters = device_.counters();
    if (counters.triggers_unfilled > 0 || watch_.dropped() > 0 || counters.items_lost > 0) {
        box_talk("pulses were lost");
        return EXIT_CODE_LOST;
    }
    if (!device_.is_connected()) {
        box_talk("the box is not plugged in any more");
        return EXIT_CODE_DEVICE;
    }
    return EXIT_CODE_OK;
}

int Monitor::run()
{
    if (arguments_.arm) {
        const opms_status_t status = arm();
        if (status != OPMS_OK) {
            return box_exit_code(status);
        }
    }
    const auto step = screen_ ? REDRAW : ROW;
    const bool ends = arguments_.seconds > 0;
    const Clock::time_point end =
        begin_ + std::chrono::milliseconds(std::llround(arguments_.seconds * 1e3));
    Clock::time_point next = begin_ + step;
    bool written = true;
    while (!interrupted() && written && !(ends && Clock::now() >= end)) {
        opms_box_item_t item = {};
        opms_box_poll(device_.get(), POLL_MS, &item, nullptr);
        take(item);
        const Clock::time_point now = Clock::now();
        if (now >= next) {
            next = now - next > step ? now + step : next + step;
            written = show(now);
        }
    }
    if (arguments_.arm) {
        disarm();
    }
    written = written && show(Clock::now());
    return written ? exit_code() : EXIT_CODE_INPUT;
}

int monitor(const MonitorArguments &arguments)
{
    int exit_code = EXIT_CODE_OK;
    const auto device = BoxDevice::open(arguments.box, PING_INTERVAL_MS, exit_code);
    if (!device) {
        return exit_code;
    }
    if (arguments.start && !device->is_emulated()) {
        box_talk("--start is for the emulated box; a real one gets its START by wire");
        return EXIT_CODE_USAGE;
    }
    opms_error_t error = {};
    opms_settings_report_t settings = {};
    const opms_status_t status = opms_box_get_settings(device->get(), 0, &settings, &error);
    if (status != OPMS_OK) {
        box_talk(error.message);
        return box_exit_code(status);
    }
    catch_interrupts();
    return Monitor(arguments, *device, settings.settings.period_us).run();
}

} // namespace

void add_box_monitor(CLI::App &box, int &exit_code)
{
    const auto arguments = std::make_shared<MonitorArguments>();
    CLI::App *cmd = box.add_subcommand(
        "monitor", "Watch a box live: rate, jitter, losses, clock. Ctrl-C ends it.");
    add_box_option(*cmd, arguments->box);
    cmd->add_option("--seconds", arguments->seconds, "End after this time [until Ctrl-C]")
        ->type_name("S")
        ->check(seconds_check());
    cmd->add_flag("--arm", arguments->arm, "Arm the box first, and stop it at the end");
    cmd->add_flag("--start", arguments->start,
                  "Emulated box: give START when it is ready for it");
    cmd->add_flag("--json", arguments->json,
                  "One JSON object a second (schema opms.box.monitor/1)");
    cmd->callback([arguments, &exit_code] { exit_code = monitor(*arguments); });
}
