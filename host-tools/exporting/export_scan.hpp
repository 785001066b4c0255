/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A recorded scan in forms that others read. What is written is there as a whole or not at all. */
#ifndef OPMS_EXPORTING_EXPORT_SCAN_HPP
#define OPMS_EXPORTING_EXPORT_SCAN_HPP

#include <cstdint>
#include <string>
#include <vector>

#include "scan_reader.hpp"

namespace opms_host {

struct ExportRequest {
    std::string out;                          /**< a file; to pictures: a folder */
    bool may_replace = false;                 /**< a file that is there already */
    bool with_pictures = true;                /**< in MCAP */
    std::int64_t most_gap_ns = 1000000000;    /**< no pose is interpolated across a longer one */
};

/** What was written. */
struct ExportReport {
    std::vector<std::string> files;
    std::uint64_t poses = 0, sensor_samples = 0, pictures = 0, events = 0;
    /** Pictures that could not be used, each with its reason; all the rest was written. */
    std::vector<std::string> problems;
};

/** Poses into one file, sensor samples with their interpolated poses into a second one beside it
 * ("scan.csv", "scan-sensors.csv"). False with @p error. */
bool export_csv(ScanReader &scan, const ExportRequest &request, ExportReport &report,
                std::string &error);
/** For Foxglove and all that reads MCAP. False with @p error. */
bool export_mcap(ScanReader &scan, const ExportRequest &request, ExportReport &report,
                 std::string &error);
/** A folder that `opms locate` and `./run bench --data` read. It must not be there, or be empty.
 * False with @p error. */
bool export_pictures(ScanReader &scan, const ExportRequest &request, ExportReport &report,
                     std::string &error);

/** Name of the second file of export_csv(). */
std::string export_csv_sensors_path(const std::string &out);

}  // namespace opms_host
#endif
