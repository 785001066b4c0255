/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Sensor samples from a table in a text file, a line at a time.
 *
 *     t_scan_s,number,left,right
 *     0.125,1,-3.5,2.25
 *
 * The first line names the columns: exactly one of t_scan_s (seconds since the hardware start) and
 * t_unix_s (since 1970 UTC), at will number and t_bound_s, and one or more values of any name.
 * Columns are parted by commas, never quoted; each cell holds a finite number.
 * Empty lines, and such that begin with '#', are passed over. */
#ifndef OPMS_SENSORS_SENSOR_CSV_HPP
#define OPMS_SENSORS_SENSOR_CSV_HPP

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "sensor_sample.hpp"

namespace opms_host {

constexpr std::size_t SENSOR_LINE_BYTES_MAX = 65536;

/** What a line was. */
enum class CsvLine { sample, nothing, error };

class SensorCsv {
public:
    /** @param sensor  The name that its samples bear. */
    explicit SensorCsv(std::string sensor);

    /** The next line, without its end. @p error names the line's number. A line that is wrong
     * changes nothing: the next one may be taken. */
    CsvLine take(std::string_view line, SensorSample &sample, std::string &error);

    /** Names of the values; empty before the first line. */
    const std::vector<std::string> &value_names() const { return value_names_; }

private:
    enum class Column { t_scan_s, t_unix_s, t_bound_s, number, value };

    bool take_names(std::string_view line, std::string &error);
    bool take_cells(std::string_view line, SensorSample &sample, std::string &error) const;
    static bool take_cell(Column column, std::string_view cell, SensorSample &sample);

    std::string sensor_;
    std::vector<Column> columns_;
    std::vector<std::string> names_, value_names_;
    std::size_t line_ = 0;
};

}  // namespace opms_host
#endif
