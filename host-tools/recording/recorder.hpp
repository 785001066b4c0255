/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Writes a scan to disk while it goes on: one folder, scan.sqlite and the pictures in it.
 *
 * All that is handed over is on the disk within a second, whatever happens then (SIGKILL, power
 * cut). Nothing here blocks who hands over: a thread of its own writes. Pictures wait in a bounded
 * queue; one that finds no place is not stored, and that is counted and told, never silent. A full
 * disk ends the recording with an event; handing over goes on and does nothing. */
#ifndef OPMS_RECORDING_RECORDER_HPP
#define OPMS_RECORDING_RECORDER_HPP

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "host_clock.hpp"
#include "scan_listener.hpp"
#include "scan_records.hpp"

namespace opms_host {

struct RecorderOptions {
    std::string folder;               /**< of all scans; made if missing */
    std::uint32_t picture_every = 1;  /**< store each Nth picture; 0: none */
    std::uint32_t picture_queue = 64; /**< pictures that may wait to be written, 1 to 4096 */
    std::uint32_t commit_ms = 250;    /**< 20 to 900 */
    bool edges = true;                /**< store the reference points of each picture */
    /** Told of what happens to the recording itself (codes "recording...."), by its thread. They
     * are in the recording already: not to be add()ed again. */
    std::function<void(const EventRecord &)> on_event;
};

struct RecorderFigures {
    RecordingState state = RecordingState::off;
    std::uint64_t rows = 0, pictures_stored = 0, pictures_not_stored = 0;
    std::uint64_t queued_pictures = 0, queued_rows = 0;
    std::int64_t synced_host_ns = 0; /**< all handed over before this is on the disk */
    std::uint64_t bytes = 0;
};

/** Calls from any thread at any time. */
class Recorder {
public:
    /** Make the folder `options.folder`/`header.name` (it must not exist; a free name is found by
     * scan_free_name()) and begin. @return NULL on failure, with @p error for people. */
    static std::unique_ptr<Recorder> begin(const RecorderOptions &options,
                                           const ScanHeader &header,
                                           std::shared_ptr<HostClock> clock, std::string &error);
    /** As end() with reason "abandoned", where end() was not called. */
    ~Recorder();

    /** @p picture may be NULL; it is stored where options.picture_every says so. */
    void add(const FrameRecord &record, const FramePtr &picture);
    void add(const TriggerRecord &record);
    void add(const PairRecord &record);
    void add(const std::shared_ptr<const PoseRecord> &record);
    void add(const EventRecord &record);
    void add(const ClockRecord &record);
    void add(const BoxReportRecord &record);
    void add(const SensorRecord &record);

    RecorderFigures figures() const;
    std::string folder() const; /**< of this scan */
    /** Write all that waits, close the books, sync. Takes as long as the disk needs.
     * @return Whether all of it is there. */
    bool end(const ScanEnd &end, std::string &error);

    class Impl;

private:
    explicit Recorder(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/** @p wanted (or "2026-11-22_14-03-07" of @p wall_ns, UTC, where empty), with "-2", "-3", ... where
 * such a scan is there already. A name may hold letters, digits, "-", "_", "." and spaces, does not
 * begin with a dot or end with a space or a dot, and is 1 to 100 long; else empty, with
 * @p error. */
std::string scan_free_name(const std::string &folder, const std::string &wanted,
                           std::int64_t wall_ns, std::string &error);

}  // namespace opms_host
#endif
