/* SPDX-License-Identifier: Apache-2.0 */
/* opms scan: a scan from the software start to the stop, without a console. */
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <unistd.h>

#include <CLI/CLI.hpp>

#include "commands.hpp"
#include "interrupted.hpp"
#include "live_options.hpp"
#include "location_json.hpp"
#include "number_check.hpp"
#include "result_stream.hpp"
#include "scan_feed.hpp"
#include "scan_focus.hpp"
#include "scan_json.hpp"
#include "scan_view.hpp"
#include "text_screen.hpp"

namespace {

using namespace opms_host;
using SteadyClock = std::chrono::steady_clock;

constexpr std::uint32_t TAKE_MS = 50;
constexpr std::chrono::milliseconds REDRAW(200), LINE(1000);
constexpr std::chrono::seconds DEVICES_WAIT(10);
constexpr std::int64_t SECOND_NS = 1'000'000'000;

struct ScanArguments {
    LiveArguments live;
    std::string name;
    double seconds = 0;         /**< of the run; 0: until Ctrl-C */
    std::uint64_t count = 0;    /**< poses; 0: until Ctrl-C */
    bool start = false, focus = false, json = false;
};

void talk(const std::string &line)
{
    std::fprintf(stderr, "opms: %s\n", line.c_str());
}

/** One scan, watched until it ends. */
class Scan {
public:
    Scan(const ScanArguments &arguments, LiveSession &session, std::vector<SensorFile> sensors)
        : arguments_(arguments), session_(session), feeder_(std::move(sensors)),
          screen_(!arguments.json && isatty(STDOUT_FILENO))
    {
    }

    int run(ScanFeed &feed);

private:
    void take(const ScanFeed::Pose &pose);
    void take(const EventRecord &event);
    void take(const SessionStatus &status);
    void drain(ScanFeed &feed, std::uint32_t timeout_ms);
    void wait_for_devices(ScanFeed &feed);
    bool is_over(const SessionStatus &status) const;
    bool show(SteadyClock::time_point now, bool last);
    void watch(ScanFeed &feed);
    int end();
    int judge(const ScanEnd &end) const;

    const ScanArguments &arguments_;
    LiveSession &session_;
    SensorFeeder feeder_;
    const bool screen_;
    ScanView view_;
    FocusView focus_;
    TextScreen drawing_;
    ResultStream out_;
    SessionState state_ = SessionState::idle;
    std::int64_t running_since_ns_ = 0;
    std::uint64_t poses_ = 0, left_out_ = 0;
    bool was_interrupted_ = false;
    SteadyClock::time_point next_ = SteadyClock::now();
};

void Scan::take(const ScanFeed::Pose &pose)
{
    poses_++;
    view_.take(pose);
    focus_.take(*pose);
    if (arguments_.json) {
        out_.write_line(json_line(pose_json(*pose)));
    }
}

void Scan::take(const EventRecord &event)
{
    view_.take(event);
    if (arguments_.json) {
        out_.write_line(json_line(event_json(event)));
    } else if (!screen_ || event.severity == Severity::error) {
        talk(scan_event_text(event));
    }
}

void Scan::take(const SessionStatus &status)
{
    if (status.state == state_) {
        return;
    }
    state_ = status.state;
    if (arguments_.json) {
        out_.write_line(json_line(status_json(status)));
    } else if (!screen_) {
        talk(scan_state_text(state_));
    }
    std::string error;
    if (state_ == SessionState::ready && arguments_.start && !session_.press_start(error)) {
        talk(error);
    }
    if (state_ == SessionState::running && running_since_ns_ == 0) {
        running_since_ns_ = status.t_host_ns;
    }
    was_interrupted_ = was_interrupted_ || state_ == SessionState::interrupted;
}

void Scan::drain(ScanFeed &feed, std::uint32_t timeout_ms)
{
    std::deque<ScanFeed::Item> items;
    left_out_ += feed.take(timeout_ms, items);
    for (const ScanFeed::Item &item : items) {
        std::visit([this](const auto &what) { take(what); }, item);
    }
}

bool Scan::is_over(const SessionStatus &status) const
{
    const double run_ns = static_cast<double>(status.t_host_ns - running_since_ns_);
    return interrupted() || out_.failed() || was_interrupted_ ||
           (arguments_.count > 0 && poses_ >= arguments_.count) ||
           (arguments_.seconds > 0 && running_since_ns_ != 0 &&
            run_ns >= arguments_.seconds * static_cast<double>(SECOND_NS));
}

/** @return false where stdout cannot be written. */
bool Scan::show(SteadyClock::time_point now, bool last)
{
    if (arguments_.json || (now < next_ && !last)) {
        return true;
    }
    next_ = now + (screen_ ? REDRAW : LINE);
    if (screen_) {
        return drawing_.draw(arguments_.focus ? focus_.screen() : view_.screen(session_.status()));
    }
    return out_.write_line(arguments_.focus ? focus_.line() : view_.line(session_.status()));
}

void Scan::watch(ScanFeed &feed)
{
    while (!is_over(session_.status())) {
        drain(feed, TAKE_MS);
        live_feed_sensors(feeder_, session_);
        if (!show(SteadyClock::now(), false)) {
            break;
        }
    }
    live_feed_sensors(feeder_, session_);
}

int Scan::judge(const ScanEnd &end) const
{
    if (was_interrupted_) {
        return EXIT_CODE_LOST;
    }
    const opms_pair_counters_t &n = end.summary.counters;
    if (end.has_summary && (n.triggers_missing > 0 || n.triggers_uncertain > 0)) {
        talk(std::to_string(n.triggers_missing) + " pulses without a picture, " +
             std::to_string(n.triggers_uncertain) + " not certain");
        return EXIT_CODE_LOST;
    }
    return out_.failed() ? EXIT_CODE_INPUT : EXIT_CODE_OK;
}

int Scan::end()
{
    ScanEnd end;
    std::string error;
    const std::string name = session_.status().scan;
    const bool ended = session_.software_stop(&end, error);
    if (!ended) {
        talk(error);
    }
    if (!name.empty() && !arguments_.live.no_recording) {
        talk("recorded: " + live_scans_folder(arguments_.live) + "/" + name);
    }
    return ended ? judge(end) : EXIT_CODE_INPUT;
}

/** Devices are opened; that they answer takes a moment, or with --wait as long as it takes. What is
 * missing after it, the software start tells. */
void Scan::wait_for_devices(ScanFeed &feed)
{
    const auto end = SteadyClock::now() + DEVICES_WAIT;
    const bool needs_box = arguments_.live.box != "none";
    while (!interrupted() && (arguments_.live.wait || SteadyClock::now() < end)) {
        const SessionStatus status = session_.status();
        if (status.camera_connected && (status.box_connected || !needs_box)) {
            return;
        }
        drain(feed, TAKE_MS);
    }
}

int Scan::run(ScanFeed &feed)
{
    std::string error;
    if (!session_.connect(error)) {
        talk(error);
        return EXIT_CODE_DEVICE;
    }
    wait_for_devices(feed);
    if (interrupted()) {
        return EXIT_CODE_OK;
    }
    if (!session_.software_start(live_scan_request(arguments_.live, arguments_.name), error)) {
        talk(error);
        return EXIT_CODE_DEVICE;
    }
    watch(feed);
    const int exit_code = end();
    drain(feed, 0);
    if (left_out_ > 0) {
        talk(std::to_string(left_out_) + " results were not shown: the output was too slow; the "
                                         "recording has them");
    }
    return show(SteadyClock::now(), true) ? exit_code : EXIT_CODE_INPUT;
}

/** The lens is turned with the camera running by itself, and nothing is kept. */
void prepare_focus(ScanArguments &arguments)
{
    if (arguments.focus) {
        arguments.live.box = "none";
        arguments.live.no_recording = true;
    }
}

int scan(ScanArguments arguments)
{
    prepare_focus(arguments);
    std::vector<SensorFile> sensors;
    if (!live_sensor_files(arguments.live, sensors)) {
        return EXIT_CODE_USAGE;
    }
    int exit_code = EXIT_CODE_OK;
    ScanFeed feed; /* must outlive the session, which calls it */
    const std::unique_ptr<LiveSession> session = open_live_session(arguments.live, exit_code);
    if (!session) {
        return exit_code;
    }
    session->add_listener(&feed);
    catch_interrupts();
    return Scan(arguments, *session, std::move(sensors)).run(feed);
}

}  // namespace

void add_cmd_scan(CLI::App &app, int &exit_code)
{
    const auto arguments = std::make_shared<ScanArguments>();
    CLI::App *cmd = app.add_subcommand(
        "scan", "Scan with box and camera: positions with their times, recorded. Ctrl-C ends it.");
    add_live_options(*cmd, arguments->live);
    cmd->add_option("--name", arguments->name, "Name of the scan [date and time]")
        ->type_name("NAME");
    cmd->add_option("--seconds", arguments->seconds, "End the run after this time [Ctrl-C]")
        ->type_name("S")
        ->check(seconds_check());
    cmd->add_option("--count", arguments->count, "End after so many pictures [Ctrl-C]")
        ->type_name("N")
        ->check(CLI::PositiveNumber);
    cmd->add_flag("--start", arguments->start,
                  "Simulated or emulated box: give the hardware start when it is READY");
    cmd->add_flag("--focus", arguments->focus,
                  "Show how sharp the picture is, to turn the lens by; records nothing");
    cmd->add_flag("--json", arguments->json,
                  "One JSON object a line (opms.pose/1, opms.event/1, opms.state/1)");
    cmd->callback([arguments, &exit_code] { exit_code = scan(*arguments); });
}
