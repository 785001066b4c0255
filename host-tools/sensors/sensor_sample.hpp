/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A sample of another sensor as it comes in, before it has its place in a scan. */
#ifndef OPMS_SENSORS_SENSOR_SAMPLE_HPP
#define OPMS_SENSORS_SENSOR_SAMPLE_HPP

#include <cstddef>
#include <cstdint>
#include <string>

#include "host_clock.hpp"
#include "scan_records.hpp"

namespace opms_host {

constexpr std::size_t SENSOR_NAME_MAX = 64, SENSOR_VALUES_MAX = 4096;

/** How its time was given. */
enum class SampleTime {
    arrival, /**< not at all: it is as old as its arrival */
    scan,    /**< seconds since the hardware start: record.t_scan_ns */
    unix_utc /**< t_unix_ns */
};

struct SensorSample {
    SensorRecord record;
    SampleTime time = SampleTime::arrival;
    std::int64_t t_unix_ns = 0; /**< since 1970 UTC */
};

/** The record to hand to a session: a time of the world becomes one of the host's monotonic clock
 * (arrival_host_ns), from which the session finds the place on the scan's axis. */
SensorRecord place_sample(const SensorSample &sample, const HostClock &clock);

/** @return Whether a time in seconds can be one, and its nanoseconds. */
bool sample_time_ns(double seconds, bool is_unix, std::int64_t &ns);

/** Letters, digits, "-", "_", ".", 1 to SENSOR_NAME_MAX of them. */
bool is_sensor_name(const std::string &name);

}  // namespace opms_host
#endif
