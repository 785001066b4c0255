/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Times of a scan as times of the day. */
#ifndef OPMS_EXPORTING_SCAN_TIMES_HPP
#define OPMS_EXPORTING_SCAN_TIMES_HPP

#include <cstdint>
#include <string>

#include "scan_records.hpp"

namespace opms_host {

/** The wall clock is read once, when a scan begins; what comes later is counted from there, so that
 * a step of the wall clock moves nothing. */
class ScanTimes {
public:
    explicit ScanTimes(const ScanHeader &header)
        : offset_ns_(header.begun_wall_ns - header.begun_host_ns)
    {
    }
    /** Since 1970 UTC, never below 0. */
    std::uint64_t wall_ns(std::int64_t host_ns) const;
    /** Of a pose: mid-exposure where the host's time of it is known, else the picture's arrival. */
    std::uint64_t wall_ns(const PoseRecord &pose) const;
    /** Of a host time by the scan's own axis: learnt from poses that have both times. */
    void learn(const PoseRecord &pose);
    /** A sample's: by the scan's axis where it is placed there, else by its arrival. */
    std::uint64_t wall_ns(const SensorRecord &sample) const;

private:
    std::int64_t offset_ns_;
    bool has_axis_ = false;
    std::int64_t axis_host_ns_ = 0; /**< host time of the axis' zero, by the newest pose learnt */
};

/** "2026-11-22T14:03:07Z". */
std::string wall_time_text(std::int64_t wall_ns);

}  // namespace opms_host
#endif
