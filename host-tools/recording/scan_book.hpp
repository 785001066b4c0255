/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What there is once in a scan, by keys: its header, its end, and the numbers of its rows. */
#ifndef OPMS_RECORDING_SCAN_BOOK_HPP
#define OPMS_RECORDING_SCAN_BOOK_HPP

#include "scan_reader.hpp"
#include "scan_records.hpp"
#include "sqlite_database.hpp"

namespace opms_host {

void book_write(Database &database, const ScanHeader &header);
void book_read(Database &database, ScanHeader &header);

/** Counts rows, too, so that a reader need not. */
void book_write(Database &database, const ScanEnd &end);
/** @return Whether the scan has one. */
bool book_read(Database &database, ScanEnd &end);

/** Numbers of rows and the duration; of a scan that has ended, as book_write() found them. */
void book_count(Database &database, ScanSummary &summary);

}  // namespace opms_host
#endif
