/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Which key of scan_header and scan_end holds which field: once, for writing and for reading. */
#ifndef OPMS_RECORDING_BOOK_FIELDS_HPP
#define OPMS_RECORDING_BOOK_FIELDS_HPP

#include "column_names.hpp"
#include "scan_records.hpp"

namespace opms_host {

template <typename Visit, typename Identity> void identity_fields(Visit &visit, Identity &identity)
{
    visit("box.hardware_version", identity.hardware_version);
    visit("box.firmware_major", identity.firmware_version[0]);
    visit("box.firmware_minor", identity.firmware_version[1]);
    visit("box.firmware_patch", identity.firmware_version[2]);
    visit("box.firmware_modified", identity.firmware_modified);
    visit("box.capabilities", identity.capabilities);
    visit.hex("box.unique_id", identity.unique_id);
    visit.text("box.git_hash", identity.git_hash);
    visit("box.boot_id", identity.boot_id);
    visit("box.clock_hz", identity.clock_hz);
    visit("box.start_cycles", identity.start_cycles);
    visit("box.ring_entries", identity.ring_entries);
    visit("box.history_entries", identity.history_entries);
}

template <typename Visit, typename Settings> void settings_fields(Visit &visit, Settings &settings)
{
    visit("box.period_us", settings.period_us);
    visit("box.width_us", settings.width_us);
    visit("box.debounce_cycles", settings.debounce_cycles);
    visit("box.trig_active_low", settings.trig_active_low);
    visit("box.start_falling_edge", settings.start_falling_edge);
    visit("box.strobe_enabled", settings.strobe_enabled);
    visit("box.strobe_active_low", settings.strobe_active_low);
    visit.state("box.sync", settings.sync, SYNC_MODES);
    visit("box.preamble_gap_1_ms", settings.preamble_gap_ms[0]);
    visit("box.preamble_gap_2_ms", settings.preamble_gap_ms[1]);
    visit("box.preamble_gap_3_ms", settings.preamble_gap_ms[2]);
    visit("box.preamble_gap_4_ms", settings.preamble_gap_ms[3]);
    visit("box.preamble_gap_5_ms", settings.preamble_gap_ms[4]);
    visit("box.preamble_gap_6_ms", settings.preamble_gap_ms[5]);
    visit("box.preamble_gap_7_ms", settings.preamble_gap_ms[6]);
    visit("box.preamble_gap_8_ms", settings.preamble_gap_ms[7]);
    visit("box.wait_timeout_s", settings.wait_timeout_s);
}

template <typename Visit, typename Profile> void profile_fields(Visit &visit, Profile &profile)
{
    visit("camera.has_frame_id", profile.has_frame_id);
    visit("camera.frame_id_bits", profile.frame_id_bits);
    visit("camera.frame_id_skips_0", profile.frame_id_skips_0);
    visit("camera.has_camera_time", profile.has_camera_time);
    visit("camera.camera_time_bits", profile.camera_time_bits);
    visit("camera.has_strobe", profile.has_strobe);
    visit("camera.camera_tick_hz", profile.camera_tick_hz);
    visit("camera.has_start_delay", profile.has_start_delay);
    visit("camera.has_exposure", profile.has_exposure);
    visit("camera.start_delay_ns", profile.start_delay_ns);
    visit("camera.exposure_ns", profile.exposure_ns);
}

template <typename Visit, typename Header> void header_fields(Visit &visit, Header &header)
{
    visit("name", header.name);
    visit("begun_wall_ns", header.begun_wall_ns);
    visit("begun_host_ns", header.begun_host_ns);
    visit("mode", header.mode);
    visit("camera_file.text", header.camera_file_text);
    visit("camera_file.name", header.camera_file_name);
    visit("box.name", header.box_name);
    visit("source.name", header.source_name);
    visit("source.model", header.source_model);
    visit("has_box", header.has_box);
    identity_fields(visit, header.box_identity);
    settings_fields(visit, header.box_settings);
    profile_fields(visit, header.camera_profile);
    visit("boot_id", header.boot_id);
    visit("session_id", header.session_id);
    visit("width_px", header.width_px);
    visit("height_px", header.height_px);
    visit("bar_tilt_rad", header.bar_tilt_rad);
    visit("bar", header.bar);
    visit("versions_json", header.versions_json);
    visit("settings_json", header.settings_json);
}

template <typename Visit, typename Counters> void counter_fields(Visit &visit, Counters &n)
{
    visit("pairing.triggers", n.triggers);
    visit("pairing.triggers_paired", n.triggers_paired);
    visit("pairing.triggers_missing", n.triggers_missing);
    visit("pairing.triggers_uncertain", n.triggers_uncertain);
    visit("pairing.triggers_pending", n.triggers_pending);
    visit("pairing.frames", n.frames);
    visit("pairing.frames_paired", n.frames_paired);
    visit("pairing.frames_orphan", n.frames_orphan);
    visit("pairing.frames_duplicate", n.frames_duplicate);
    visit("pairing.frames_stale", n.frames_stale);
    visit("pairing.frames_uncertain", n.frames_uncertain);
    visit("pairing.frames_pending", n.frames_pending);
    visit("pairing.reports", n.reports);
    visit("pairing.reports_repeated", n.reports_repeated);
    visit("pairing.reports_late", n.reports_late);
    visit("pairing.reports_foreign", n.reports_foreign);
    visit("pairing.reports_contradicting", n.reports_contradicting);
    visit("pairing.history_used", n.history_used);
    visit("pairing.gaps_filled", n.gaps_filled);
    visit("pairing.locks", n.locks);
    visit("pairing.losses_of_lock", n.losses_of_lock);
    visit("pairing.camera_restarts", n.camera_restarts);
    visit("pairing.id_changes", n.id_changes);
    visit("pairing.boots_seen", n.boots_seen);
}

template <typename Visit, typename Fit> void clock_fields(Visit &visit, Fit &fit)
{
    visit.state("clock.state", fit.state, CLOCK_STATES);
    visit("clock.round_trips", fit.round_trips);
    visit("clock.drift_ppm", fit.drift_ppm);
    visit("clock.drift_sigma_ppm", fit.drift_sigma_ppm);
    visit("clock.residual_ns", fit.residual_ns);
    visit("clock.sigma_ns", fit.sigma_ns);
    visit("clock.bound_ns", fit.bound_ns);
    visit("clock.newest_host_ns", fit.newest_host_ns);
    visit("clock.accepted", fit.accepted);
    visit("clock.refused", fit.refused);
}

template <typename Visit, typename End> void end_fields(Visit &visit, End &end)
{
    visit("ended_wall_ns", end.ended_wall_ns);
    visit("ended_host_ns", end.ended_host_ns);
    visit("reason", end.reason);
    visit("has_summary", end.has_summary);
    visit.state("pairing.state", end.summary.state, PAIR_STATES);
    visit("pairing.sums_hold", end.summary.sums_hold);
    visit("pairing.lock_witnesses", end.summary.lock_witnesses);
    visit("pairing.ended", end.summary.ended);
    visit("pairing.arrival_floor_ns", end.summary.arrival_floor_ns);
    visit("pairing.camera_drift_ppb", end.summary.camera_drift_ppb);
    visit.text("pairing.line", end.summary.line);
    counter_fields(visit, end.summary.counters);
    clock_fields(visit, end.summary.clock);
    visit("source.delivered", end.source.delivered);
    visit("source.damaged", end.source.damaged);
    visit("source.no_buffer", end.source.no_buffer);
    visit("source.failed", end.source.failed);
    visit("source.lent", end.source.lent);
    visit("source.buffers", end.source.buffers);
}

}  // namespace opms_host
#endif
