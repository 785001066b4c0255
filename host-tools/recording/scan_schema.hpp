/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Tables of scan.sqlite, and how those of older versions become today's. docs/recording.md. */
#ifndef OPMS_RECORDING_SCAN_SCHEMA_HPP
#define OPMS_RECORDING_SCAN_SCHEMA_HPP

#include <cstdint>

#include "sqlite_database.hpp"

namespace opms_host {

constexpr std::int64_t SCAN_SCHEMA_VERSION = 1;
constexpr std::int64_t SCAN_APPLICATION_ID = 0x4F504D53; /**< "OPMS" */

/** In an empty database: page size, journal, tables, version. */
void scan_schema_create(Database &database);

/** The version of a scan. @throws DatabaseError where it is no scan, or a newer opms made it. */
std::int64_t scan_schema_version(Database &database);

/** Bring the tables up to today's version, all or nothing. Does nothing where they are. */
void scan_schema_migrate(Database &database);

}  // namespace opms_host
#endif
