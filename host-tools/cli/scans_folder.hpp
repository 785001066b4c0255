/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Where scans are kept, and which one an argument SCAN means. */
#ifndef OPMS_CLI_SCANS_FOLDER_HPP
#define OPMS_CLI_SCANS_FOLDER_HPP

#include <string>

/** $OPMS_SCANS, else "opms-scans" in the user's home, else in the current folder. Not made. */
std::string scans_folder();

/** The folder of a scan: @p scan itself where it is a path of something, else the scan of that name
 * in @p folder (empty: scans_folder()). What is not there comes back as it was given. */
std::string scan_path(const std::string &scan, const std::string &folder = std::string());

#endif
