/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Opens the database of a scan for reading, in whatever state it was left. */
#ifndef OPMS_RECORDING_SCAN_OPEN_HPP
#define OPMS_RECORDING_SCAN_OPEN_HPP

#include <memory>
#include <string>

#include "scan_reader.hpp"
#include "sqlite_database.hpp"

namespace opms_host {

/** The folder of a scan, from its path or that of its database; absolute. */
std::string scan_folder_of(const std::string &path);

/** @param[out] version  That the file has; the tables of what is returned are today's.
 * @throws DatabaseError. */
std::unique_ptr<Database> scan_open_for_reading(const std::string &folder, std::int64_t &version);

/** All of it. @throws DatabaseError. */
void scan_summarize(Database &database, ScanSummary &summary);

}  // namespace opms_host
#endif
