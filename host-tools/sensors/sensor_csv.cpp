/* SPDX-License-Identifier: Apache-2.0 */
#include "sensor_csv.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace opms_host {

namespace {

std::string_view trimmed(std::string_view text)
{
    const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!text.empty() && is_blank(text.front())) {
        text.remove_prefix(1);
    }
    while (!text.empty() && is_blank(text.back())) {
        text.remove_suffix(1);
    }
    return text;
}

std::vector<std::string_view> split_cells(std::string_view line)
{
    std::vector<std::string_view> cells;
    for (std::size_t begin = 0; begin <= line.size();) {
        const std::size_t end = std::min(line.find(',', begin), line.size());
        cells.push_back(trimmed(line.substr(begin, end - begin)));
        begin = end + 1;
    }
    return cells;
}

/** The same in every locale, unlike strtod(). */
template <typename Number> bool parse_number(std::string_view text, Number &value)
{
    const char *end = text.data() + text.size();
    const std::from_chars_result result = std::from_chars(text.data(), end, value);
    return result.ec == std::errc() && result.ptr == end;
}

std::string shown(std::string_view text)
{
    std::string word(text.substr(0, 40));
    std::replace_if(word.begin(), word.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    return "'" + word + "'";
}

}  // namespace

SensorCsv::SensorCsv(std::string sensor) : sensor_(std::move(sensor)) {}

CsvLine SensorCsv::take(std::string_view line, SensorSample &sample, std::string &error)
{
    ++line_;
    line = trimmed(line);
    bool good = line.size() <= SENSOR_LINE_BYTES_MAX;
    if (!good) {
        error = "is longer than 65536 bytes";
    } else if (line.empty() || line.front() == '#') {
        return CsvLine::nothing;
    } else if (columns_.empty()) {
        good = take_names(line, error);
        if (good) {
            return CsvLine::nothing;
        }
    } else {
        good = take_cells(line, sample, error);
    }
    if (!good) {
        error = "line " + std::to_string(line_) + ": " + error;
    }
    return good ? CsvLine::sample : CsvLine::error;
}

bool SensorCsv::take_names(std::string_view line, std::string &error)
{
    std::vector<Column> columns;
    std::vector<std::string> names, value_names;
    for (const std::string_view name : split_cells(line)) {
        const Column column = name == "t_scan_s"    ? Column::t_scan_s
                              : name == "t_unix_s"  ? Column::t_unix_s
                              : name == "t_bound_s" ? Column::t_bound_s
                              : name == "number"    ? Column::number
                                                    : Column::value;
        if (name.empty() || std::find(names.begin(), names.end(), name) != names.end()) {
            error = "a column's name is empty or there twice: " + shown(name);
            return false;
        }
        columns.push_back(column);
        names.emplace_back(name);
        if (column == Column::value) {
            value_names.emplace_back(name);
        }
    }
    const auto times = std::count(columns.begin(), columns.end(), Column::t_scan_s) +
                       std::count(columns.begin(), columns.end(), Column::t_unix_s);
    if (times != 1 || value_names.empty() || value_names.size() > SENSOR_VALUES_MAX) {
        error = "the first line must name one column t_scan_s or t_unix_s, and 1 to 4096 values";
        return false;
    }
    columns_ = std::move(columns);
    names_ = std::move(names);
    value_names_ = std::move(value_names);
    return true;
}

bool SensorCsv::take_cells(std::string_view line, SensorSample &sample, std::string &error) const
{
    const std::vector<std::string_view> cells = split_cells(line);
    if (cells.size() != columns_.size()) {
        error = std::to_string(cells.size()) + " cells instead of " +
                std::to_string(columns_.size());
        return false;
    }
    SensorSample taken;
    taken.record.sensor = sensor_;
    for (std::size_t i = 0; i < cells.size(); i++) {
        if (!take_cell(columns_[i], cells[i], taken)) {
            error = shown(cells[i]) + " is no " + names_[i].substr(0, 40);
            return false;
        }
    }
    sample = std::move(taken);
    return true;
}

bool SensorCsv::take_cell(Column column, std::string_view cell, SensorSample &sample)
{
    if (column == Column::number) {
        return parse_number(cell, sample.record.number);
    }
    double value = 0;
    if (!parse_number(cell, value) || !std::isfinite(value)) {
        return false;
    }
    switch (column) {
    case Column::t_scan_s:
        sample.time = SampleTime::scan;
        sample.record.has_time = true;
        return sample_time_ns(value, false, sample.record.t_scan_ns);
    case Column::t_unix_s:
        sample.time = SampleTime::unix_utc;
        return sample_time_ns(value, true, sample.t_unix_ns);
    case Column::t_bound_s:
        return value >= 0 && sample_time_ns(value, false, sample.record.t_bound_ns);
    case Column::number:
    case Column::value: break;
    }
    sample.record.values.push_back(value);
    return true;
}

}  // namespace opms_host
