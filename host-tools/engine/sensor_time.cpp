/* SPDX-License-Identifier: Apache-2.0 */
#include "sensor_time.hpp"

#include <cmath>

namespace opms_host {
namespace {

constexpr std::size_t VALUES_MOST = 65536; /* of a row of a radar */

}  // namespace

void place_sensor_sample(const ScanAxis &axis, SensorRecord &record)
{
    if (record.has_time || !axis.has_start_edge || !axis.box_clock) {
        return;
    }
    const std::int64_t half_ns = record.t_bound_ns / 2;
    std::int64_t box_ns = 0;
    if (opms_clock_box_from_host(axis.box_clock, record.arrival_host_ns - half_ns, &box_ns,
                                 nullptr) != OPMS_OK) {
        return;
    }
    record.has_time = true;
    record.t_scan_ns = box_ns - axis.start_edge_box_ns;
    if (record.t_bound_ns > 0) {
        opms_clock_fit_t fit;
        opms_clock_get(axis.box_clock, &fit);
        record.t_bound_ns = record.t_bound_ns - half_ns + fit.bound_ns;
    }
}

std::string sensor_sample_problem(const SensorRecord &record)
{
    if (record.sensor.empty() || record.sensor.size() > 64) {
        return "a sensor's name has 1 to 64 characters";
    }
    if (record.values.empty() && record.data_json.empty()) {
        return "the sample holds neither values nor data";
    }
    if (record.values.size() > VALUES_MOST) {
        return "the sample holds more than 65536 values";
    }
    if (record.t_bound_ns < 0) {
        return "the bound of a sample's time is negative";
    }
    for (const double value : record.values) {
        if (!std::isfinite(value)) {
            return "a value of the sample is not a finite number";
        }
    }
    return "";
}

}  // namespace opms_host
