/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Where another sensor's sample lies on the scan's time axis. */
#ifndef OPMS_ENGINE_SENSOR_TIME_HPP
#define OPMS_ENGINE_SENSOR_TIME_HPP

#include <string>

#include "scan_records.hpp"

namespace opms_host {

/** The scan's axis, as far as it is known. */
struct ScanAxis {
    bool has_start_edge = false;
    std::int64_t start_edge_box_ns = 0;
    const opms_clock_t *box_clock = nullptr;
};

/** Place a sample that came without a time on the axis by its arrival.
 *
 * Where the sender states how old it may be at its arrival (record.t_bound_ns on entry), it is
 * placed in the middle of that stretch, and the bound becomes half of it and what the box's clock
 * is not known by. Where he does not, it is placed at its arrival and the bound stays 0: not known.
 * A sample that has a time already stays as it is; so does one from before the start edge is known,
 * without a time. */
void place_sensor_sample(const ScanAxis &axis, SensorRecord &record);

/** What is wrong with a sample; empty: nothing. */
std::string sensor_sample_problem(const SensorRecord &record);

}  // namespace opms_host
#endif
