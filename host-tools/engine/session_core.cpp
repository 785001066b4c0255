/* SPDX-License-Identifier: Apache-2.0 */
#include "session_core.hpp"

#include <utility>

#include "box_words.hpp"

namespace opms_host {
namespace {

constexpr std::int64_t STATUS_EVERY_NS = 1'000'000'000;

BoxReportRecord box_report(const opms_box_item_t &item)
{
    BoxReportRecord record;
    record.arrival_host_ns = item.t_host_ns;
    if (item.kind == OPMS_ITEM_STATUS) {
        opms_wire_write_status(&item.as.status, record.bytes.data());
    } else {
        opms_wire_write_event(&item.as.event, record.bytes.data());
    }
    return record;
}

TriggerRecord history_record(const opms_box_item_t &item)
{
    const opms_history_entry_t &entry = item.as.history.entry;
    TriggerRecord record;
    record.from_history = true;
    record.arrival_host_ns = item.t_host_ns;
    record.report.flags = entry.flags;
    record.report.boot_id = item.as.history.boot_id;
    record.report.session_id = item.as.history.session_id;
    record.report.trigger_number = entry.number;
    record.report.time = entry.time;
    if (entry.flags & OPMS_TRIGGER_STROBE) {
        record.report.strobe_for_trigger = entry.number;
        record.report.strobe_delay_cycles = entry.strobe_delay_cycles;
        record.report.strobe_length_cycles = entry.strobe_length_cycles;
    }
    return record;
}

}  // namespace

SessionCore::SessionCore(Publisher &publisher, std::shared_ptr<HostClock> clock,
                         std::uint32_t max_wait_ms)
    : publisher_(publisher), clock_(std::move(clock)), pairing_(max_wait_ms)
{
}

void SessionCore::take_box_item(const opms_box_item_t &item)
{
    BoxWords words;
    if (box_item_words(item, words) && (!words.may_come_often || gate_.pass(words.event))) {
        tell(words.event);
    }
    if (item.kind == OPMS_ITEM_LINK) {
        note_link(item.as.link);
    }
    const std::int64_t age_ns = clock_->now_ns() - item.t_host_ns;
    const bool is_round_trip = pairing_.note_round_trip(item, clock_->wall_ns() - age_ns);
    if (scan_ && scan_->has_box) {
        if (is_round_trip && scan_->sink) {
            scan_->sink->add(pairing_.round_trips().back());
        }
        scan_->tracker.take(item);
        learn_start_edge(item);
        record_box_item(item);
    }
    pairing_.take(item);
    settle();
    update_state();
}

void SessionCore::note_link(const opms_link_item_t &link)
{
    const bool was_connected = box_connected_;
    box_connected_ = link.change == OPMS_LINK_CONNECTED || link.change == OPMS_LINK_REBOOTED ||
                     (link.change == OPMS_LINK_SILENT && was_connected);
    if (box_connected_ != was_connected) {
        publish_status();
    }
}

/** The zero of the scan's axis, for the samples of other sensors. */
void SessionCore::learn_start_edge(const opms_box_item_t &item)
{
    const auto set = [this](std::uint32_t boot_id, std::uint32_t session_id, opms_box_time_t edge) {
        if (boot_id == scan_->boot_id && session_id == scan_->session_id) {
            scan_->axis.has_start_edge = true;
            scan_->axis.start_edge_box_ns = opms_box_time_ns(edge);
        }
    };
    if (item.kind == OPMS_ITEM_EVENT && item.as.event.kind == OPMS_EVENT_START) {
        set(item.as.event.boot_id, item.as.event.session_id, item.as.event.time);
    } else if (item.kind == OPMS_ITEM_TRIGGER && item.as.trigger.first_run_number != 0) {
        set(item.as.trigger.boot_id, item.as.trigger.session_id, item.as.trigger.start_edge);
    }
}

void SessionCore::record_box_item(const opms_box_item_t &item)
{
    if (!scan_->sink) {
        return;
    }
    if (item.kind == OPMS_ITEM_TRIGGER) {
        TriggerRecord record;
        record.report = item.as.trigger;
        record.arrival_host_ns = item.t_host_ns;
        scan_->sink->add(record);
    } else if (item.kind == OPMS_ITEM_HISTORY) {
        scan_->sink->add(history_record(item));
    } else if (item.kind == OPMS_ITEM_STATUS || item.kind == OPMS_ITEM_EVENT) {
        scan_->sink->add(box_report(item));
    }
}

void SessionCore::set_camera_connected(bool connected)
{
    if (connected != camera_connected_) {
        camera_connected_ = connected;
        update_state();
        publish_status();
    }
}

void SessionCore::advance()
{
    const std::int64_t now_ns = clock_->now_ns();
    pairing_.advance(now_ns);
    settle();
    if (pairing_.is_open()) {
        pairing_.news(now_ns, false, [this](EventRecord &event) { tell(event); });
    }
    tell_recording();
    if (now_ns - published_status_ns_ >= STATUS_EVERY_NS) {
        publish_status();
    }
}

/** The recording stops by itself where the disk is full; its own event tells why. */
void SessionCore::tell_recording()
{
    const RecordingState now =
        scan_ && scan_->sink ? scan_->sink->figures().state : RecordingState::off;
    if (now != recording_) {
        recording_ = now;
        publish_status();
    }
}

bool SessionCore::begin_scan(const ScanStart &start, std::string &error)
{
    if (start.with_box &&
        !pairing_.open(start.boot_id, start.session_id, start.settings, error)) {
        return false;
    }
    counts_ = SessionStatus();
    scan_.emplace(start.with_box);
    scan_->name = start.name;
    scan_->sink = start.sink;
    scan_->boot_id = start.boot_id;
    scan_->session_id = start.session_id;
    scan_->period_ns = start.period_ns;
    scan_->is_preview = start.is_preview;
    scan_->last_frame_ns = clock_->now_ns();
    scan_->tracker.begin(start.boot_id, start.session_id, scan_->last_frame_ns);
    scan_->axis.box_clock = start.with_box ? pairing_.clock() : nullptr;
    if (scan_->sink) {
        for (const ClockRecord &record : pairing_.round_trips()) {
            scan_->sink->add(record);
        }
    }
    update_state();
    tell(Severity::info, "session.begun", "scan " + start.name + " begins");
    return true;
}

std::uint64_t SessionCore::take_frame(const FramePtr &frame)
{
    FrameRecord record;
    record.number = scan_->next_number++;
    record.frame_id = frame->frame_id;
    record.camera_time_ticks = frame->camera_time_ticks;
    record.arrival_host_ns = frame->arrival_host_ns;
    record.flags = frame->flags;
    record.exposure_us = frame->exposure_us;
    record.gain_db = frame->gain_db;
    record.white_level = frame->image.white_level;
    ++counts_.frames;
    scan_->last_frame_ns = clock_->now_ns();
    scan_->joiner.expect(record.number, frame->exposure_us);
    if (scan_->sink) {
        scan_->sink->add(record, frame);
    }
    if (scan_->has_box) {
        pair(*frame, record.number);
    }
    return record.number;
}

void SessionCore::pair(const Frame &frame, std::uint64_t number)
{
    opms_frame_t header{};
    header.frame_id = frame.frame_id;
    header.camera_time_ticks = frame.camera_time_ticks;
    header.arrival_host_ns = frame.arrival_host_ns;
    header.tag = number;
    /* A preview gives one witness at most, whatever it says of its frames. */
    header.flags =
        frame.flags | (scan_->is_preview ? OPMS_FRAME_NO_ID | OPMS_FRAME_NO_TIME : 0U);
    pairing_.take(header);
    settle();
}

void SessionCore::take_located(std::unique_ptr<PoseRecord> pose)
{
    if (!scan_) {
        return;
    }
    switch (pose->location.state) {
    case OPMS_BAR_LOCATED: ++counts_.located; break;
    case OPMS_BAR_AMBIGUOUS: ++counts_.ambiguous; break;
    case OPMS_BAR_ABSENT: ++counts_.absent; break;
    }
    located_after_.add(pose->located_host_ns, pose->located_host_ns - pose->arrival_host_ns,
                       scan_->period_ns);
    scan_->joiner.located(std::move(pose));
    settle();
}

/** Take up what the pairer has decided, and let out what is complete. */
void SessionCore::settle()
{
    pairing_.poll([this](const opms_pair_result_t &result) {
        if (!scan_) {
            return;
        }
        if (scan_->sink) {
            PairRecord record;
            record.result = result;
            record.t_host_ns = clock_->now_ns();
            scan_->sink->add(record);
        }
        if (result.frame_state != OPMS_FRAME_NONE) {
            scan_->joiner.decided(result);
        }
    });
    while (scan_) {
        std::unique_ptr<PoseRecord> pose =
            scan_->joiner.take(scan_->has_box ? pairing_.clock() : nullptr);
        if (!pose) {
            return;
        }
        publish(std::move(pose));
    }
}

void SessionCore::publish(std::unique_ptr<PoseRecord> pose)
{
    pose->published_host_ns = clock_->now_ns();
    published_after_.add(pose->published_host_ns,
                         pose->published_host_ns - pose->arrival_host_ns, scan_->period_ns);
    counts_.poses += pose->has_time && pose->location.state == OPMS_BAR_LOCATED;
    const std::shared_ptr<const PoseRecord> record = std::move(pose);
    if (scan_->sink) {
        scan_->sink->add(record);
    }
    publisher_.pose(record);
}

void SessionCore::add_sensor_sample(SensorRecord &record)
{
    place_sensor_sample(scan_->axis, record);
    if (scan_->sink) {
        scan_->sink->add(record);
    }
}

void SessionCore::set_stopping()
{
    scan_->stopping = true;
    update_state();
}

bool SessionCore::is_decided() const
{
    if (!scan_ || !scan_->has_box || !pairing_.is_open()) {
        return true;
    }
    const opms_pair_summary_t summary = pairing_.summary();
    const opms_pair_counters_t &c = summary.counters;
    if (!summary.ended && box_connected_) {
        return false; /* the number of the last pulse is not known yet */
    }
    if (c.triggers_pending == 0 && c.frames_pending == 0) {
        return true;
    }
    /* Each pulse has its picture: what is missing is a confirmation that no later one will give. */
    constexpr std::int64_t QUIET_NS = 200'000'000;
    const std::int64_t quiet_ns = clock_->now_ns() - scan_->last_frame_ns;
    return c.triggers_pending <= c.frames_pending && quiet_ns > QUIET_NS + 2 * scan_->period_ns;
}

void SessionCore::close_pairing()
{
    scan_->is_accepting = false;
    if (!pairing_.is_open()) {
        return;
    }
    std::string error;
    if (!pairing_.close(error)) {
        tell(Severity::error, "pair.sums", error);
    }
    settle();
    pairing_.news(clock_->now_ns(), true, [this](EventRecord &event) { tell(event); });
}

ScanEnd SessionCore::scan_end(const std::string &reason) const
{
    ScanEnd end;
    end.ended_wall_ns = clock_->wall_ns();
    end.ended_host_ns = clock_->now_ns();
    end.reason = reason;
    end.has_summary = scan_ && scan_->has_box;
    if (end.has_summary) {
        end.summary = pairing_.summary();
    }
    end.source = source_;
    return end;
}

void SessionCore::forget_scan(SessionState state)
{
    counts_ = status(); /* figures of the scan stay readable until the next one */
    counts_.scan.clear();
    scan_.reset();
    state_ = state;
    recording_ = RecordingState::off;
    publish_status();
}

std::string SessionCore::over() const
{
    const char *over = scan_ && scan_->has_box ? scan_->tracker.over() : nullptr;
    return over ? over : "";
}

void SessionCore::tell(EventRecord event)
{
    if (scan_ && scan_->sink) {
        scan_->sink->add(event);
    }
    publisher_.event(event);
}

void SessionCore::tell(Severity severity, const char *code, std::string text)
{
    EventRecord event;
    event.t_host_ns = clock_->now_ns();
    event.severity = severity;
    event.code = code;
    event.text = std::move(text);
    tell(event);
}

void SessionCore::tell_often(Severity severity, const char *code, std::string text)
{
    EventRecord event;
    event.t_host_ns = clock_->now_ns();
    event.severity = severity;
    event.code = code;
    event.text = std::move(text);
    if (gate_.pass(event)) {
        tell(event);
    }
}

void SessionCore::update_state()
{
    SessionState now = state_;
    if (scan_ && scan_->stopping) {
        now = SessionState::stopping;
    } else if (scan_ && scan_->has_box) {
        now = scan_->tracker.state();
        if (now == SessionState::ready && !camera_connected_) {
            now = SessionState::preamble; /* nobody shall begin while the camera is away */
        }
    } else if (scan_) {
        now = SessionState::running;
    }
    if (now != state_) {
        state_ = now;
        publish_status();
    }
}

SessionStatus SessionCore::status() const
{
    SessionStatus status = counts_;
    const std::int64_t now_ns = clock_->now_ns();
    status.state = state_;
    status.box_connected = box_connected_;
    status.camera_connected = camera_connected_;
    status.t_host_ns = now_ns;
    status.source = source_;
    status.located_after = located_after_.figures(now_ns);
    status.published_after = published_after_.figures(now_ns);
    status.display_dropped = publisher_.display_dropped();
    if (scan_) {
        status.scan = scan_->name;
        status.pairing = scan_->has_box ? pairing_.summary() : opms_pair_summary_t{};
        const RecorderFigures figures = scan_->sink ? scan_->sink->figures() : RecorderFigures();
        status.recording = figures.state;
        status.pictures_stored = figures.pictures_stored;
        status.pictures_not_stored = figures.pictures_not_stored;
    } else {
        status.recording = RecordingState::off;
    }
    return status;
}

void SessionCore::publish_status()
{
    published_status_ns_ = clock_->now_ns();
    publisher_.state(status());
}

}  // namespace opms_host
