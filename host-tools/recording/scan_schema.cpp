/* SPDX-License-Identifier: Apache-2.0 */
#include "scan_schema.hpp"

#include <array>
#include <string>

namespace opms_host {

namespace {

/* Pages of 4 KiB are what most disks write at a time. */
const char SETUP[] = R"(
PRAGMA page_size = 4096;
PRAGMA application_id = 1330662739;
)";

const char TABLES[] = R"(
CREATE TABLE scan_header (key TEXT PRIMARY KEY, value ANY) STRICT, WITHOUT ROWID;
CREATE TABLE scan_end (key TEXT PRIMARY KEY, value ANY) STRICT, WITHOUT ROWID;
CREATE TABLE recoveries (id INTEGER PRIMARY KEY, wall_ns INTEGER, text TEXT NOT NULL) STRICT;
CREATE TABLE triggers (
    id INTEGER PRIMARY KEY, number INTEGER NOT NULL,
    time_box_ns INTEGER GENERATED ALWAYS AS (time_us * 1000 + time_cycles * 8) VIRTUAL,
    flags INTEGER NOT NULL, boot_id INTEGER NOT NULL, session_id INTEGER NOT NULL,
    report_number INTEGER NOT NULL, time_us INTEGER NOT NULL, time_cycles INTEGER NOT NULL,
    start_us INTEGER NOT NULL, start_cycles INTEGER NOT NULL, first_run_number INTEGER NOT NULL,
    strobe_for_trigger INTEGER NOT NULL, strobe_delay_cycles INTEGER NOT NULL,
    strobe_length_cycles INTEGER NOT NULL, gap_0_us INTEGER NOT NULL, gap_1_us INTEGER NOT NULL,
    dropped INTEGER NOT NULL, from_history INTEGER NOT NULL,
    arrival_host_ns INTEGER NOT NULL) STRICT;
CREATE TABLE frames (
    number INTEGER PRIMARY KEY, frame_id INTEGER NOT NULL, camera_time_ticks INTEGER NOT NULL,
    arrival_host_ns INTEGER NOT NULL, flags INTEGER NOT NULL, exposure_us REAL, gain_db REAL,
    white_level INTEGER NOT NULL) STRICT;
CREATE TABLE pictures (
    number INTEGER PRIMARY KEY REFERENCES frames (number), path TEXT NOT NULL,
    bytes INTEGER NOT NULL, crc32 INTEGER NOT NULL) STRICT;
CREATE TABLE pairs (
    id INTEGER PRIMARY KEY, sequence INTEGER NOT NULL, trigger_state TEXT NOT NULL,
    frame_state TEXT NOT NULL, witnesses INTEGER NOT NULL, against INTEGER NOT NULL,
    known INTEGER NOT NULL, boot_id INTEGER NOT NULL, session_id INTEGER NOT NULL,
    trigger_count INTEGER NOT NULL, trigger_number INTEGER NOT NULL,
    frame_number INTEGER NOT NULL, trigger_box_ns INTEGER NOT NULL,
    start_edge_box_ns INTEGER NOT NULL, start_delay_ns INTEGER NOT NULL,
    exposure_ns INTEGER NOT NULL, mid_exposure_box_ns INTEGER NOT NULL,
    camera_residual_ns INTEGER NOT NULL, arrival_delay_ns INTEGER NOT NULL,
    id_residual INTEGER NOT NULL, frame_id INTEGER NOT NULL, camera_time_ticks INTEGER NOT NULL,
    arrival_host_ns INTEGER NOT NULL, frame INTEGER NOT NULL, frame_flags INTEGER NOT NULL,
    t_host_ns INTEGER NOT NULL) STRICT;
CREATE TABLE poses (
    number INTEGER PRIMARY KEY, state TEXT NOT NULL, frame_state TEXT NOT NULL,
    trigger_number INTEGER NOT NULL, t_scan_ns INTEGER, is_mid_exposure INTEGER NOT NULL,
    t_host_ns INTEGER NOT NULL, known INTEGER NOT NULL,
    x_m REAL, y_m REAL, z_m REAL, psi_rad REAL, phi_rad REAL, theta_rad REAL,
    sigma_x_m REAL, sigma_y_m REAL, sigma_z_m REAL,
    camera_x_m REAL, camera_y_m REAL, camera_z_m REAL,
    squares INTEGER NOT NULL, edges INTEGER NOT NULL, edge_shift_px REAL, residual_px REAL,
    light_squares INTEGER NOT NULL, light_white REAL, light_white_high REAL, light_black REAL,
    light_saturated REAL, light_picture_white REAL, light_picture_black REAL,
    next_exposure_us REAL, next_gain_db REAL, exposure_state TEXT NOT NULL,
    blur_limited INTEGER NOT NULL, blur TEXT NOT NULL, blur_y_px REAL, blur_x_px REAL,
    arrival_host_ns INTEGER NOT NULL, located_host_ns INTEGER NOT NULL,
    published_host_ns INTEGER NOT NULL) STRICT;
CREATE TABLE locations (
    number INTEGER PRIMARY KEY REFERENCES poses (number), location BLOB NOT NULL,
    squares BLOB NOT NULL, edges BLOB, residuals_px BLOB, hint BLOB) STRICT;
CREATE TABLE events (
    id INTEGER PRIMARY KEY, t_host_ns INTEGER NOT NULL, severity TEXT NOT NULL,
    code TEXT NOT NULL, text TEXT NOT NULL, data_json TEXT NOT NULL) STRICT;
CREATE TABLE clock_samples (
    id INTEGER PRIMARY KEY, sent_host_ns INTEGER NOT NULL, received_box_ns INTEGER NOT NULL,
    sent_box_ns INTEGER NOT NULL, arrived_host_ns INTEGER NOT NULL,
    wall_ns INTEGER NOT NULL) STRICT;
CREATE TABLE box_reports (
    id INTEGER PRIMARY KEY, arrival_host_ns INTEGER NOT NULL, bytes BLOB NOT NULL) STRICT;
CREATE TABLE sensor_samples (
    id INTEGER PRIMARY KEY, sensor TEXT NOT NULL, number INTEGER NOT NULL, t_scan_ns INTEGER,
    t_bound_ns INTEGER NOT NULL, arrival_host_ns INTEGER NOT NULL, value REAL,
    sample BLOB NOT NULL, data_json TEXT NOT NULL) STRICT;
)";

/* Version 0 was the draft: no recoveries, no hints, no white level, no sums of the pictures. What
 * it did not know becomes what that means in the records: none, 0, and -1 for a sum. */
const char TO_VERSION_1[] = R"(
CREATE TABLE recoveries (id INTEGER PRIMARY KEY, wall_ns INTEGER, text TEXT NOT NULL) STRICT;
ALTER TABLE frames ADD COLUMN white_level INTEGER NOT NULL DEFAULT 0;
ALTER TABLE locations ADD COLUMN hint BLOB;
ALTER TABLE pictures ADD COLUMN crc32 INTEGER NOT NULL DEFAULT -1;
)";

/** From version n to n + 1 by its n-th element. */
const std::array<const char *, SCAN_SCHEMA_VERSION> STEPS = {TO_VERSION_1};

std::string set_version(std::int64_t version)
{
    return "PRAGMA user_version = " + std::to_string(version) + ";";
}

}  // namespace

void scan_schema_create(Database &database)
{
    database.run(SETUP);
    database.run("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL;");
    database.run("BEGIN;" + std::string(TABLES) + set_version(SCAN_SCHEMA_VERSION) + "COMMIT;");
}

std::int64_t scan_schema_version(Database &database)
{
    if (database.integer("PRAGMA application_id") != SCAN_APPLICATION_ID) {
        throw DatabaseError(DatabaseError::Kind::other, "is a database, but not of a scan");
    }
    const std::int64_t version = database.integer("PRAGMA user_version");
    if (version < 0 || version > SCAN_SCHEMA_VERSION) {
        throw DatabaseError(DatabaseError::Kind::other,
                            "was made by a newer opms: its tables have version " +
                                std::to_string(version) + ", this program knows those up to " +
                                std::to_string(SCAN_SCHEMA_VERSION));
    }
    return version;
}

void scan_schema_migrate(Database &database)
{
    std::int64_t version = scan_schema_version(database);
    if (version == SCAN_SCHEMA_VERSION) {
        return;
    }
    database.run("BEGIN IMMEDIATE");
    try {
        for (; version < SCAN_SCHEMA_VERSION; version++) {
            database.run(STEPS[static_cast<std::size_t>(version)]);
            database.run(set_version(version + 1));
        }
        database.run("COMMIT");
    } catch (...) {
        database.run("ROLLBACK");
        throw;
    }
}

}  // namespace opms_host
