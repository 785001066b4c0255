/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Reads a recorded scan: whole, cut off by a power failure, still being written, or of an older
 * version of the schema (docs/recording.md). Never writes, recover_scan() excepted. */
#ifndef OPMS_RECORDING_SCAN_READER_HPP
#define OPMS_RECORDING_SCAN_READER_HPP

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "scan_records.hpp"

namespace opms_host {

/** A scan at a glance. */
struct ScanSummary {
    std::string folder, name;
    ScanHeader header;
    bool ended = false;      /**< closed in order; else cut off or still going on */
    bool being_recorded = false; /**< somebody writes it now: its lock is held */
    bool recovered = false;  /**< was cut off, and recover_scan() has mended it */
    ScanEnd end;
    std::uint64_t triggers = 0, frames = 0, pairs = 0, poses = 0, poses_with_time = 0;
    std::uint64_t pictures = 0, events = 0, sensor_samples = 0, bytes = 0;
    double duration_s = 0;   /**< first to last pose or frame */
    std::uint32_t schema_version = 0;
};

/** A stored picture's place. */
struct PictureRow {
    std::uint64_t number = 0; /**< of its frame */
    std::string path;         /**< absolute */
    std::uint64_t bytes = 0;  /**< of the file, as it was stored */
    std::int64_t crc32 = -1;  /**< of the whole file; -1: not known */
};

/** Whether a stored picture is as it was stored. @p error says what is wrong with it. */
bool picture_is_whole(const PictureRow &picture, std::string &error);


/** One thread at a time. The each_...() calls go through rows in the order of their making until
 * the function returns false; they return false where the file cannot be read, with @p error. */
class ScanReader {
public:
    /** @p folder  Of one scan (holds scan.sqlite), or that file itself. */
    static std::unique_ptr<ScanReader> open(const std::string &folder, std::string &error);
    ~ScanReader();

    const ScanSummary &summary() const;
    template <typename Record> using Each = std::function<bool(const Record &)>;
    bool each_frame(const Each<FrameRecord> &take, std::string &error);
    bool each_trigger(const Each<TriggerRecord> &take, std::string &error);
    bool each_pair(const Each<PairRecord> &take, std::string &error);
    bool each_pose(const Each<PoseRecord> &take, std::string &error);
    bool each_event(const Each<EventRecord> &take, std::string &error);
    bool each_clock(const Each<ClockRecord> &take, std::string &error);
    bool each_box_report(const Each<BoxReportRecord> &take, std::string &error);
    bool each_sensor(const Each<SensorRecord> &take, std::string &error);
    bool each_picture(const Each<PictureRow> &take, std::string &error);
    /** One pose by its frame's number. @return Whether it is there. */
    bool pose(std::uint64_t number, PoseRecord &record, std::string &error);

    class Impl;

private:
    explicit ScanReader(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/** What a look at a cut-off recording found and mended. */
struct ScanRecovery {
    bool needed = false;       /**< it had not been closed in order */
    std::uint64_t rows = 0;    /**< that are there */
    std::uint64_t pictures_lost = 0;  /**< named in the books, but missing or torn */
    std::uint64_t pictures_loose = 0; /**< whole files that the books do not name: removed */
    std::int64_t last_host_ns = 0;    /**< of the newest record */
    std::vector<std::string> words;   /**< what was found, for people */
};

/** Bring a cut-off recording in order and write down in it that and how that was done. Not while it
 * is being written: that is found out by a lock and refused. False with @p error. */
bool recover_scan(const std::string &folder, ScanRecovery &recovery, std::string &error);

/** All scans below @p folder, by their beginning. Those that cannot be read are in @p failed with
 * the reason. */
std::vector<ScanSummary> list_scans(const std::string &folder, std::vector<std::string> &failed);

}  // namespace opms_host
#endif
