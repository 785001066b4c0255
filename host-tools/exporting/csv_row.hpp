/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * One line of CSV as RFC 4180 has it: fields in quotes where they must be, CR LF at the end. */
#ifndef OPMS_EXPORTING_CSV_ROW_HPP
#define OPMS_EXPORTING_CSV_ROW_HPP

#include <cstdint>
#include <string>
#include <vector>

namespace opms_host {

class CsvRow {
public:
    CsvRow &text(const std::string &value);
    /** The shortest text that reads back as the same number; NaN and infinity: an empty field. */
    CsvRow &number(double value);
    CsvRow &integer(std::uint64_t value);
    /** Nanoseconds as seconds, to the last digit. */
    CsvRow &seconds(std::int64_t ns);
    CsvRow &empty(std::size_t count = 1);
    /** With the line's end. */
    std::string line() const { return line_ + "\r\n"; }

private:
    void add(const std::string &field);

    std::string line_;
    bool begun_ = false;
};

/** A heading. */
std::string csv_heading(const std::vector<std::string> &names);

}  // namespace opms_host
#endif
