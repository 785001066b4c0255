/* SPDX-License-Identifier: Apache-2.0 */
#include "sensor_sample.hpp"

#include <cmath>

namespace opms_host {

namespace {

/* A scan of four months, and a clock before the year 2200: beyond them a unit was mistaken. */
constexpr double T_SCAN_MAX_S = 1e7, T_UNIX_MAX_S = 7.3e9;

bool is_name_character(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           c == '-' || c == '_' || c == '.';
}

}  // namespace

SensorRecord place_sample(const SensorSample &sample, const HostClock &clock)
{
    SensorRecord record = sample.record;
    const std::int64_t now_ns = clock.now_ns();
    record.arrival_host_ns = now_ns;
    if (sample.time == SampleTime::unix_utc) {
        record.arrival_host_ns = now_ns - (clock.wall_ns() - sample.t_unix_ns);
    }
    record.has_time = sample.time == SampleTime::scan;
    return record;
}

bool sample_time_ns(double seconds, bool is_unix, std::int64_t &ns)
{
    const double least_s = is_unix ? 0 : -T_SCAN_MAX_S;
    const double most_s = is_unix ? T_UNIX_MAX_S : T_SCAN_MAX_S;
    if (!(seconds >= least_s && seconds <= most_s)) { /* NaN, too */
        return false;
    }
    ns = std::llround(seconds * 1e9);
    return true;
}

bool is_sensor_name(const std::string &name)
{
    if (name.empty() || name.size() > SENSOR_NAME_MAX) {
        return false;
    }
    for (const char c : name) {
        if (!is_name_character(c)) {
            return false;
        }
    }
    return true;
}

}  // namespace opms_host
