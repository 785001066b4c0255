/* SPDX-License-Identifier: Apache-2.0 */
#include "csv_row.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>

namespace opms_host {

void CsvRow::add(const std::string &field)
{
    if (begun_) {
        line_ += ',';
    }
    begun_ = true;
    line_ += field;
}

CsvRow &CsvRow::text(const std::string &value)
{
    if (value.find_first_of("\",\r\n") == std::string::npos) {
        add(value);
        return *this;
    }
    std::string quoted = "\"";
    for (const char c : value) {
        quoted += c;
        if (c == '"') {
            quoted += c;
        }
    }
    add(quoted + '"');
    return *this;
}

CsvRow &CsvRow::number(double value)
{
    if (!std::isfinite(value)) {
        return empty();
    }
    char text[40];
    const std::to_chars_result end = std::to_chars(text, text + sizeof text, value);
    add(std::string(text, end.ptr));
    return *this;
}

CsvRow &CsvRow::integer(std::uint64_t value)
{
    add(std::to_string(value));
    return *this;
}

CsvRow &CsvRow::seconds(std::int64_t ns)
{
    /* The magnitude as unsigned: that of the least int64_t has no positive twin. */
    const std::uint64_t size = ns < 0 ? 0 - static_cast<std::uint64_t>(ns)
                                      : static_cast<std::uint64_t>(ns);
    char text[40];
    std::snprintf(text, sizeof text, "%s%llu.%09llu", ns < 0 ? "-" : "",
                  static_cast<unsigned long long>(size / 1000000000U),
                  static_cast<unsigned long long>(size % 1000000000U));
    add(text);
    return *this;
}

CsvRow &CsvRow::empty(std::size_t count)
{
    for (std::size_t i = 0; i < count; i++) {
        add("");
    }
    return *this;
}

std::string csv_heading(const std::vector<std::string> &names)
{
    CsvRow row;
    for (const std::string &name : names) {
        row.text(name);
    }
    return row.line();
}

}  // namespace opms_host
