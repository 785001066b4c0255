/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * All that a session knows: the pairing, the scan that goes on, and where both stand. No threads
 * and no waiting: what comes in is told by the caller, one at a time (LiveSession holds a lock),
 * what comes out goes to the publisher and the scan's sink, which do not wait either. */
#ifndef OPMS_ENGINE_SESSION_CORE_HPP
#define OPMS_ENGINE_SESSION_CORE_HPP

#include <memory>
#include <optional>
#include <string>

#include "event_gate.hpp"
#include "latency_histogram.hpp"
#include "pairing.hpp"
#include "pose_joiner.hpp"
#include "publisher.hpp"
#include "run_tracker.hpp"
#include "scan_sink.hpp"
#include "sensor_time.hpp"

namespace opms_host {

/** What a scan begins with. */
struct ScanStart {
    std::string name;
    std::shared_ptr<ScanSink> sink; /**< NULL: nothing is stored */
    bool with_box = false, is_preview = false;
    std::uint32_t boot_id = 0, session_id = 0;
    opms_settings_t settings{};     /**< of the box */
    opms_camera_profile_t profile{};
    std::int64_t period_ns = 0;     /**< between pictures; for missed deadlines */
};

class SessionCore {
public:
    SessionCore(Publisher &publisher, std::shared_ptr<HostClock> clock, std::uint32_t max_wait_ms);

    /* What the devices tell. */
    void take_box_item(const opms_box_item_t &item);
    void set_box_connected() { box_connected_ = true; }
    void set_camera_connected(bool connected);
    void set_source_counters(const SourceCounters &counters) { source_ = counters; }
    /** Let time pass. */
    void advance();

    /** Make ready to pair with this camera, between scans. */
    bool fit_pairing(const opms_camera_profile_t &profile, std::string &error)
    {
        return pairing_.fit(profile, error);
    }
    bool is_box_clock_known(std::uint32_t boot_id) const
    {
        return pairing_.is_clock_known(boot_id);
    }

    /* A scan. */
    bool begin_scan(const ScanStart &start, std::string &error);
    /** Whether pictures belong to a scan now. */
    bool is_accepting() const { return scan_ && scan_->is_accepting; }
    bool has_scan() const { return scan_.has_value(); }
    /** A picture of the scan: store and pair it. @return Its number. */
    std::uint64_t take_frame(const FramePtr &frame);
    void take_located(std::unique_ptr<PoseRecord> pose);
    void add_sensor_sample(SensorRecord &record);
    void set_stopping();
    /** Nothing more can be gained by waiting for pictures or reports. */
    bool is_decided() const;
    /** Pictures that come from now on are of no scan. */
    void stop_accepting() { scan_->is_accepting = false; }
    std::int64_t last_frame_ns() const { return scan_ ? scan_->last_frame_ns : 0; }
    /** Decide all that waits; pictures that come from now on are of no scan. */
    void close_pairing();
    /** Pictures of the scan that are not located or not paired yet. */
    std::size_t waiting() const { return scan_ ? scan_->joiner.waiting() : 0; }
    ScanEnd scan_end(const std::string &reason) const;
    /** The scan's books are closed: the devices are free for the next one. */
    void forget_scan(SessionState state);
    /** Why the scan ends by itself: a code; empty: it goes on. Also while it is being stopped. */
    std::string over() const;
    bool is_stopping() const { return scan_ && scan_->stopping; }
    bool scan_has_box() const { return scan_ && scan_->has_box; }
    std::shared_ptr<ScanSink> sink() const { return scan_ ? scan_->sink : nullptr; }
    std::uint64_t pictures() const { return counts_.frames; }

    /** Tell listeners and recording. */
    void tell(EventRecord event);
    void tell(Severity severity, const char *code, std::string text);
    /** Of what may come often: one a second. */
    void tell_often(Severity severity, const char *code, std::string text);

    SessionStatus status() const;
    bool is_box_connected() const { return box_connected_; }
    bool is_camera_connected() const { return camera_connected_; }
    SessionState state() const { return state_; }
    /** Tell the listeners where things stand. */
    void publish_status();

private:
    struct Scan {
        explicit Scan(bool with_box) : has_box(with_box), joiner(with_box) {}
        std::string name;
        std::shared_ptr<ScanSink> sink;
        bool has_box, is_accepting = true, is_preview = false;
        std::uint32_t boot_id = 0, session_id = 0;
        std::int64_t period_ns = 0;
        PoseJoiner joiner;
        RunTracker tracker;
        ScanAxis axis;
        bool stopping = false;
        std::int64_t last_frame_ns = 0;
        std::uint64_t next_number = 1;
    };
    void pair(const Frame &frame, std::uint64_t number);
    void record_box_item(const opms_box_item_t &item);
    void learn_start_edge(const opms_box_item_t &item);
    void note_link(const opms_link_item_t &link);
    void settle();
    void publish(std::unique_ptr<PoseRecord> pose);
    void update_state();
    void tell_recording();

    Publisher &publisher_;
    const std::shared_ptr<HostClock> clock_;
    Pairing pairing_;
    std::optional<Scan> scan_;
    EventGate gate_;
    SessionState state_ = SessionState::idle;
    bool box_connected_ = false, camera_connected_ = false;
    SessionStatus counts_;  /**< frames, located, ... of the scan */
    SourceCounters source_;
    RecordingState recording_ = RecordingState::off;
    LatencyHistogram located_after_, published_after_;
    std::int64_t published_status_ns_ = 0;
};

}  // namespace opms_host
#endif
