/* SPDX-License-Identifier: Apache-2.0 */
/* The beginning of a scan, and what is asked of it while it goes on. */
#include "session_impl.hpp"

#include <chrono>
#include <ctime>
#include <random>

#include "code_versions.hpp"
#include "standstill_guard.hpp"

namespace opms_host {
namespace {

using namespace std::chrono_literals;

const char *mode_name(SessionMode mode)
{
    switch (mode) {
    case SessionMode::position: return "position";
    case SessionMode::capture: return "capture";
    case SessionMode::calibration: return "calibration";
    }
    return "?";
}

/** "2026-11-22_14-03-07", UTC. */
std::string date_and_time(std::int64_t wall_ns)
{
    const std::time_t seconds = wall_ns / 1'000'000'000;
    std::tm utc{};
    gmtime_r(&seconds, &utc);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%d_%H-%M-%S", &utc);
    return text;
}

}  // namespace

bool LiveSession::Impl::may_start(const ScanRequest &request, std::string &error)
{
    const Lock lock(mutex_);
    if (quit_ || !closing_thread_.joinable()) {
        error = "the session is not connected";
    } else if (core_.has_scan()) {
        error = "a scan is going on already";
    } else if (!devices_.source || !core_.is_camera_connected()) {
        error = "no camera is connected";
    } else if (request.single_pictures && options_.mode != SessionMode::capture) {
        error = "single pictures are of mode capture";
    } else if (request.single_pictures && hardware_trigger_) {
        error = "the camera follows the trigger box: single pictures need a session without one";
    } else {
        return true;
    }
    return false;
}

std::uint32_t LiveSession::Impl::new_session_id()
{
    std::random_device random;
    std::uint32_t id = 0;
    while (id == 0 || id == last_session_id_) {
        id = random();
    }
    return last_session_id_ = id;
}

/** Settings into the box, and all that must be known of it before it is armed. */
bool LiveSession::Impl::prepare_box(ScanStart &start, std::string &error)
{
    opms_identity_report_t identity{};
    if (!devices_.box->identity(identity)) {
        error = "no trigger box is connected";
        return false;
    }
    /* One that still runs for somebody else, or for a scan before this one, would refuse both. */
    opms_settings_report_t report{};
    if (!devices_.box->disarm(error) ||
        (options_.box_settings && !devices_.box->set_settings(*options_.box_settings, error)) ||
        !devices_.box->settings(report, error)) {
        return false;
    }
    Lock lock(mutex_);
    if (!core_.fit_pairing(start.profile, error)) {
        return false;
    }
    wait_for_box_clock(lock, identity.boot_id);
    disarm_wanted_ = false;
    start.with_box = true;
    start.settings = report.settings;
    start.boot_id = identity.boot_id;
    start.session_id = new_session_id();
    start.period_ns = report.settings.period_us * std::int64_t{1000};
    return true;
}

/** Right after the box was plugged in its clock is not known, and nothing could be learnt from the
 * preamble. */
void LiveSession::Impl::wait_for_box_clock(Lock &lock, std::uint32_t boot_id)
{
    constexpr std::int64_t LONGEST_NS = 4'000'000'000;
    const std::int64_t deadline_ns = devices_.clock->now_ns() + LONGEST_NS;
    StandstillGuard guard;
    while (!quit_ && !core_.is_box_clock_known(boot_id)) {
        const std::int64_t now_ns = devices_.clock->now_ns();
        if (now_ns > deadline_ns || guard.stands_still(now_ns)) {
            core_.tell(Severity::warning, "box.clock_unknown",
                       "the box does not answer pings: pulses may not be paired");
            return;
        }
        changed_.wait_for(lock, 5ms);
    }
}

ScanHeader LiveSession::Impl::scan_header(const ScanRequest &request,
                                          const ScanStart &start) const
{
    const SourceTraits traits = devices_.source->traits();
    ScanHeader header;
    header.begun_wall_ns = devices_.clock->wall_ns();
    header.begun_host_ns = devices_.clock->now_ns();
    header.name = request.name.empty() ? date_and_time(header.begun_wall_ns) : request.name;
    header.mode = mode_name(options_.mode);
    header.camera_file_text = options_.camera_file_text;
    header.camera_file_name = options_.camera_file_name;
    header.source_name = traits.name;
    header.source_model = traits.model;
    header.camera_profile = traits.profile;
    header.width_px = traits.width_px;
    header.height_px = traits.height_px;
    header.bar_tilt_rad = options_.bar_tilt_rad;
    header.bar = options_.bar;
    header.versions_json = code_versions_json();
    header.settings_json = request.settings_json;
    header.has_box = start.with_box;
    if (start.with_box) {
        header.box_name = devices_.box->name();
        devices_.box->identity(header.box_identity);
        header.box_settings = start.settings;
        header.boot_id = start.boot_id;
        header.session_id = start.session_id;
    }
    return header;
}

bool LiveSession::Impl::begin_recording(const ScanRequest &request, ScanStart &start,
                                        std::string &error)
{
    const ScanHeader header = scan_header(request, start);
    start.name = header.name;
    if (!request.recording) {
        return true;
    }
    RecorderOptions options = *request.recording;
    options.on_event = [this, user = request.recording->on_event](const EventRecord &event) {
        publisher_.event(event); /* not into the recording that it is about */
        if (user) {
            user(event);
        }
    };
    start.sink = make_sink_(options, header, devices_.clock, error);
    if (!start.sink) {
        error = "recording: " + error;
        return false;
    }
    start.name = start.sink->name();
    return true;
}

bool LiveSession::Impl::arm(std::uint32_t session_id, std::string &error)
{
    if (devices_.box->arm(session_id, error)) {
        return true;
    }
    Lock lock(mutex_);
    core_.tell(Severity::error, "session.not_armed", error);
    request_finish("session.not_armed", false);
    wait_for_finish(lock);
    return false;
}

bool LiveSession::Impl::software_start(const ScanRequest &request, std::string &error)
{
    const std::lock_guard<std::mutex> control(control_);
    if (!may_start(request, error)) {
        return false;
    }
    const SourceTraits traits = devices_.source->traits();
    ScanStart start;
    start.profile = traits.profile;
    start.is_preview = traits.preview_only;
    start.period_ns = static_cast<std::int64_t>(1e9 / options_.source.frame_rate_hz);
    const bool with_box =
        devices_.box && (hardware_trigger_ || options_.mode == SessionMode::position);
    if ((with_box && !prepare_box(start, error)) || !begin_recording(request, start, error)) {
        return false;
    }
    bool has_begun = false;
    {
        const Lock lock(mutex_);
        singles_only_ = request.single_pictures;
        singles_wanted_ = 0;
        has_begun = core_.begin_scan(start, error);
        changed_.notify_all();
    }
    if (!has_begun) {
        std::string ignored;
        ScanEnd end;
        end.reason = "session.not_armed";
        if (start.sink) {
            start.sink->end(end, ignored);
        }
        return false;
    }
    return !with_box || arm(start.session_id, error);
}

bool LiveSession::Impl::software_stop(ScanEnd *end, std::string &error)
{
    const std::lock_guard<std::mutex> control(control_);
    Lock lock(mutex_);
    if (!core_.has_scan()) {
        error = "no scan is going on";
        return false;
    }
    request_finish("stop", true);
    wait_for_finish(lock);
    if (end) {
        *end = *last_end_;
    }
    error = last_end_error_;
    lock.unlock();
    publisher_.wait_until_told(); /* so that a listener knows all of it when this returns */
    return error.empty();
}

bool LiveSession::Impl::press_start(std::string &error)
{
    if (!devices_.box) {
        error = "this session has no trigger box";
        return false;
    }
    return devices_.box->press_start(error);
}

bool LiveSession::Impl::single_picture(std::string &error)
{
    if (options_.mode != SessionMode::capture || hardware_trigger_) {
        error = "single pictures are of mode capture, without a trigger box";
        return false;
    }
    const std::lock_guard<std::mutex> control(control_);
    Lock lock(mutex_);
    if (core_.has_scan() && !singles_only_) {
        error = "the scan that goes on takes all pictures";
        return false;
    }
    const bool in_scan = core_.has_scan();
    const std::uint64_t pictures = core_.pictures(), shown = newest_.count();
    single_since_ns_ = devices_.clock->now_ns();
    singles_wanted_ += in_scan;
    const bool came = changed_.wait_for(lock, 5s, [&] {
        return quit_ || (in_scan ? core_.pictures() > pictures : newest_.count() > shown);
    });
    if (!came || quit_) {
        singles_wanted_ = 0;
        error = "no picture came within 5 s";
        return false;
    }
    return true;
}

bool LiveSession::Impl::add_sensor_sample(SensorRecord record, std::string &error)
{
    error = sensor_sample_problem(record);
    if (!error.empty()) {
        return false;
    }
    if (record.arrival_host_ns == 0) {
        record.arrival_host_ns = devices_.clock->now_ns();
    }
    const Lock lock(mutex_);
    if (!core_.has_scan()) {
        error = "no scan is going on";
        return false;
    }
    core_.add_sensor_sample(record);
    return true;
}

SessionStatus LiveSession::Impl::status() const
{
    SessionStatus status;
    {
        const Lock lock(mutex_);
        status = core_.status();
    }
    status.queue_frames = queue_.size();
    if (devices_.source) {
        status.source = devices_.source->counters();
    }
    return status;
}

SourceTraits LiveSession::Impl::source_traits() const
{
    return devices_.source ? devices_.source->traits() : SourceTraits();
}

}  // namespace opms_host
