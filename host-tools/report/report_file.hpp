/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The report's folder: report.html and report.json, each whole or not at all. */
#ifndef OPMS_REPORT_FILE_HPP
#define OPMS_REPORT_FILE_HPP

#include <string>

#include "report_html.hpp"

/** Make the folder where it is not there yet, and see that files can be made in it.
 * @return false with @p error, which names the folder. */
bool report_open_folder(const std::string &folder, std::string &error);

/** Write both files aside, then put them in place of those that are there.
 * @return false with @p error, which names the file; then nothing is left half. */
bool report_write(const std::string &folder, const ReportJson &report, std::string &error);

#endif
