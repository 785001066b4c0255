-- SPDX-License-Identifier: Apache-2.0
-- A scan of the tables' version 0, the draft, as it was written then. Never to be changed: it shows
-- that what is old is still read. One picture (number 7), located nowhere; one row of each kind.
PRAGMA application_id = 1330662739;
PRAGMA user_version = 0;
CREATE TABLE scan_header (key TEXT PRIMARY KEY, value ANY) STRICT, WITHOUT ROWID;
CREATE TABLE scan_end (key TEXT PRIMARY KEY, value ANY) STRICT, WITHOUT ROWID;
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
    arrival_host_ns INTEGER NOT NULL, flags INTEGER NOT NULL, exposure_us REAL,
    gain_db REAL) STRICT;
CREATE TABLE pictures (
    number INTEGER PRIMARY KEY REFERENCES frames (number), path TEXT NOT NULL,
    bytes INTEGER NOT NULL) STRICT;
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
    squares BLOB NOT NULL, edges BLOB, residuals_px BLOB) STRICT;
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
INSERT INTO scan_header VALUES ('name', 'old'), ('mode', 'position'), ('width_px', 1024),
    ('bar_tilt_rad', 0.25), ('has_box', 1), ('box.period_us', 100000);
INSERT INTO triggers (number, flags, boot_id, session_id, report_number, time_us, time_cycles,
    start_us, start_cycles, first_run_number, strobe_for_trigger, strobe_delay_cycles,
    strobe_length_cycles, gap_0_us, gap_1_us, dropped, from_history, arrival_host_ns)
    VALUES (7, 2, 4294967295, 5, 9, 700000, 124, 100, 0, 1, 6, 10, 20, 100000, 100000, 0, 1, 701);
INSERT INTO frames VALUES (7, -2, 123, 702, 4, 900.5, NULL);
INSERT INTO pictures VALUES (7, 'pictures/000/000007.png', 11);
INSERT INTO pairs VALUES (1, 0, 'PAIRED', 'PAIRED', 3, 0, 15, 4294967295, 5, 1, 7, 107, 700000992,
    100000, 11, 13, 700001009, -3, 4, 0, 107, 123, 702, 7, 4, 703);
INSERT INTO poses (number, state, frame_state, trigger_number, t_scan_ns, is_mid_exposure,
    t_host_ns, known, squares, edges, light_squares, light_white, light_white_high, light_black,
    light_saturated, light_picture_white, light_picture_black, next_exposure_us, next_gain_db,
    exposure_state, blur_limited, blur, blur_y_px, blur_x_px, arrival_host_ns, located_host_ns,
    published_host_ns) VALUES (7, 'absent', 'PAIRED', 7, 699901009, 1, 700, 15, 0, 0, 0, 0.0, 0.0,
    0.0, 0.0, 0.5, 0.25, 900.0, 3.0, 'searching', 0, 'unknown', 0.0, 0.0, 702, 704, 705);
INSERT INTO locations VALUES (7, zeroblob(1272), x'', x'', x'');
INSERT INTO events VALUES (1, 706, 'warning', 'box.lost', 'the box has gone', '');
INSERT INTO clock_samples VALUES (1, 1, 2, 3, 4, 5);
INSERT INTO box_reports VALUES (1, 707, zeroblob(64));
INSERT INTO sensor_samples VALUES (1, 'metal', 8, NULL, 9, 708, 1.5, x'000000000000F83F', '{}');
