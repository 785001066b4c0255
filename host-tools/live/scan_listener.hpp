/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Who wants to hear of a scan while it goes on: the terminal, the console, a test. */
#ifndef OPMS_LIVE_SCAN_LISTENER_HPP
#define OPMS_LIVE_SCAN_LISTENER_HPP

#include <cstdint>
#include <memory>
#include <string>

#include "scan_records.hpp"

namespace opms_host {

enum class SessionState {
    idle,       /**< devices may come and go; nothing is armed */
    arming,     /**< the software start was given */
    preamble,   /**< the box sends the coded pulses */
    ready,      /**< it waits for the hardware start: the operator may begin */
    running,
    stopping,
    interrupted /**< a run was going on and its box started anew or vanished: see the events */
};

/** "idle", "ready", ...: as the interface and the recording have it. */
const char *session_state_name(SessionState state);

enum class RecordingState { off, on, full, failed };

/** Delays from a frame's arrival to its pose, of the last minute at most. */
struct LatencyFigures {
    std::uint64_t count = 0, missed = 0; /**< missed: later than one period */
    double p50_ms = 0, p99_ms = 0, p999_ms = 0, most_ms = 0;
};

/** Where a session stands. A snapshot. */
struct SessionStatus {
    SessionState state = SessionState::idle;
    bool box_connected = false, camera_connected = false;
    std::string scan;           /**< name of the one going on; empty: none */
    opms_pair_summary_t pairing{};
    std::uint64_t frames = 0, located = 0, ambiguous = 0, absent = 0;
    std::uint64_t poses = 0;    /**< with a certain time */
    std::uint64_t queue_frames = 0;  /**< that wait to be located */
    std::uint64_t display_dropped = 0, pictures_stored = 0, pictures_not_stored = 0;
    RecordingState recording = RecordingState::off;
    LatencyFigures located_after, published_after;
    SourceCounters source{};
    std::int64_t t_host_ns = 0;
};

/** Called by the session's threads, from several at a time; must return soon and never wait. */
class ScanListener {
public:
    virtual ~ScanListener() = default;
    virtual void on_state(const SessionStatus &) {}
    /** In the order of the pictures; each picture exactly once, with its final pair. */
    virtual void on_pose(const std::shared_ptr<const PoseRecord> &) {}
    virtual void on_event(const EventRecord &) {}
    /** For display only: pictures are left out when there is no time for them. The pose is the
     * picture's own; its pair may not be decided yet. */
    virtual void on_picture(const FramePtr &, const std::shared_ptr<const PoseRecord> &) {}
    /** Mode calibration, for display: right before the on_picture() of the same picture. */
    virtual void on_grid(const std::shared_ptr<const GridRecord> &) {}
};

}  // namespace opms_host
#endif
