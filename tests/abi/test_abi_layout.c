/* SPDX-License-Identifier: Apache-2.0 */
/* The value structs are frozen: a program built against an older header keeps working. This file
 * only has to compile. The figures are those of 64-bit machines. */
#include <stddef.h>

#include <opms/opms.h>

#define SIZE(type, size) _Static_assert(sizeof(type) == (size), #type " changed its size")
#define AT(type, member, at) \
    _Static_assert(offsetof(type, member) == (at), #type "." #member " has moved")

_Static_assert(sizeof(void *) == 8, "the figures below are for 64-bit machines");

SIZE(opms_error_t, 248);
AT(opms_error_t, index, 4);
AT(opms_error_t, stage, 8);
AT(opms_error_t, message, 24);

SIZE(opms_allocator_t, 24);
AT(opms_allocator_t, free, 8);
AT(opms_allocator_t, user, 16);

SIZE(opms_image_t, 32);
AT(opms_image_t, width_px, 8);
AT(opms_image_t, height_px, 12);
AT(opms_image_t, stride_bytes, 16);
AT(opms_image_t, format, 24);
AT(opms_image_t, white_level, 28);

SIZE(opms_expect_options_t, 48);
AT(opms_expect_options_t, bar_tilt_rad, 8);
AT(opms_expect_options_t, min_square_px, 40);

SIZE(opms_calib_view_t, 128);
AT(opms_calib_view_t, target_m, 96);
AT(opms_calib_view_t, sigma_px, 112);
AT(opms_calib_view_t, footprints, 120);

AT(opms_calib_foresight_t, gain, 8);
AT(opms_calib_foresight_t, camera, 16);

SIZE(opms_calib_lens_check_t, 136);
AT(opms_calib_lens_check_t, residual_rms_px, 16);
AT(opms_calib_lens_check_t, chi2, 40);
AT(opms_calib_lens_check_t, shows_centre_px, 120);

SIZE(opms_calib_mounting_check_t, 488);
AT(opms_calib_mounting_check_t, change, 96);
AT(opms_calib_mounting_check_t, chi2, 432);
AT(opms_calib_mounting_check_t, shows_shift_m, 464);

SIZE(opms_expectation_t, 584);
AT(opms_expectation_t, square_count, 4);
AT(opms_expectation_t, covariance_image, 8);
AT(opms_expectation_t, covariance_calibration, 296);

SIZE(opms_roi_t, 16);
AT(opms_roi_t, y_px, 4);
AT(opms_roi_t, width_px, 8);
AT(opms_roi_t, height_px, 12);

SIZE(opms_lens_t, 72);
AT(opms_lens_t, height_px, 4);
AT(opms_lens_t, fx_px, 8);
AT(opms_lens_t, fy_px, 16);
AT(opms_lens_t, cx_px, 24);
AT(opms_lens_t, cy_px, 32);
AT(opms_lens_t, k1, 40);
AT(opms_lens_t, k2, 48);
AT(opms_lens_t, p1, 56);
AT(opms_lens_t, p2, 64);

SIZE(opms_transform_t, 96);
AT(opms_transform_t, t_m, 72);

SIZE(opms_camera_t, 1368);
AT(opms_camera_t, has_covariance_intrinsics, 72);
AT(opms_camera_t, has_detector_camera, 76);
AT(opms_camera_t, has_covariance_detector_camera, 80);
AT(opms_camera_t, has_covariance_detector_camera_intrinsics, 84);
AT(opms_camera_t, covariance_intrinsics, 88);
AT(opms_camera_t, detector_camera, 600);
AT(opms_camera_t, covariance_detector_camera, 696);
AT(opms_camera_t, covariance_detector_camera_intrinsics, 984);

SIZE(opms_square_t, 72);
AT(opms_square_t, edges, 4);
AT(opms_square_t, corners_px, 8);

SIZE(opms_edge_t, 72);
AT(opms_edge_t, side, 4);
AT(opms_edge_t, bar_m, 8);
AT(opms_edge_t, px, 24);
AT(opms_edge_t, normal, 40);
AT(opms_edge_t, sigma_px, 56);
AT(opms_edge_t, shift_gain, 64);

SIZE(opms_bar_summary_t, 64);
AT(opms_bar_summary_t, square_count, 4);
AT(opms_bar_summary_t, edge_count, 8);
AT(opms_bar_summary_t, label_margin, 16);
AT(opms_bar_summary_t, blur_px, 24);
AT(opms_bar_summary_t, noise, 40);
AT(opms_bar_summary_t, contrast, 48);
AT(opms_bar_summary_t, white_fraction_saturated, 56);

SIZE(opms_pose_t, 384);
AT(opms_pose_t, covariance, 96);

SIZE(opms_pose_result_t, 808);
AT(opms_pose_result_t, edges_used, 4);
AT(opms_pose_result_t, bar_camera, 8);
AT(opms_pose_result_t, edge_shift_px, 392);
AT(opms_pose_result_t, residual_px, 400);
AT(opms_pose_result_t, chi2_dof, 408);
AT(opms_pose_result_t, chi2_other, 416);
AT(opms_pose_result_t, intrinsics_jacobian, 424);

SIZE(opms_location_t, 1272);
AT(opms_location_t, has_ground_detector, 4);
AT(opms_location_t, covariance_includes, 8);
AT(opms_location_t, followed, 12);
AT(opms_location_t, bar, 16);
AT(opms_location_t, pose, 80);
AT(opms_location_t, ground_detector, 888);

SIZE(opms_round_trip_t, 32);
AT(opms_round_trip_t, received_box_ns, 8);
AT(opms_round_trip_t, arrived_host_ns, 24);

SIZE(opms_clock_fit_t, 72);
AT(opms_clock_fit_t, drift_ppm, 8);
AT(opms_clock_fit_t, residual_ns, 24);
AT(opms_clock_fit_t, bound_ns, 40);
AT(opms_clock_fit_t, accepted, 56);

SIZE(opms_camera_profile_t, 56);
AT(opms_camera_profile_t, has_camera_time, 12);
AT(opms_camera_profile_t, camera_tick_hz, 24);
AT(opms_camera_profile_t, start_delay_ns, 40);

SIZE(opms_frame_t, 40);
AT(opms_frame_t, camera_time_ticks, 8);
AT(opms_frame_t, arrival_host_ns, 16);
AT(opms_frame_t, tag, 24);
AT(opms_frame_t, flags, 32);

SIZE(opms_pair_result_t, 160);
AT(opms_pair_result_t, trigger_state, 8);
AT(opms_pair_result_t, witnesses, 16);
AT(opms_pair_result_t, boot_id, 28);
AT(opms_pair_result_t, trigger_number, 40);
AT(opms_pair_result_t, trigger_box_ns, 56);
AT(opms_pair_result_t, mid_exposure_box_ns, 88);
AT(opms_pair_result_t, frame, 120);

SIZE(opms_pair_gap_t, 8);
SIZE(opms_pair_counters_t, 192);
SIZE(opms_pair_summary_t, 456);
AT(opms_pair_summary_t, counters, 32);

/* Options grow at their end; what stands before stays. */
AT(opms_clock_options_t, struct_size, 0);
AT(opms_clock_options_t, window, 4);
AT(opms_clock_options_t, allocator, 16);
AT(opms_pair_options_t, struct_size, 0);
AT(opms_pair_options_t, max_wait_ms, 4);
AT(opms_pair_options_t, camera, 16);
AT(opms_pair_options_t, allocator, 72);
AT(opms_bar_options_t, struct_size, 0);
AT(opms_bar_options_t, min_square_px, 4);
AT(opms_bar_options_t, allocator, 8);
AT(opms_locator_options_t, struct_size, 0);
AT(opms_locator_options_t, bar_tilt_rad, 8);
AT(opms_locator_options_t, bar, 16);

SIZE(opms_box_time_t, 16);
AT(opms_box_time_t, cycles, 8);

SIZE(opms_trigger_report_t, 88);
AT(opms_trigger_report_t, boot_id, 4);
AT(opms_trigger_report_t, session_id, 8);
AT(opms_trigger_report_t, report_number, 12);
AT(opms_trigger_report_t, trigger_number, 16);
AT(opms_trigger_report_t, time, 24);
AT(opms_trigger_report_t, start_edge, 40);
AT(opms_trigger_report_t, first_run_number, 56);
AT(opms_trigger_report_t, strobe_for_trigger, 60);
AT(opms_trigger_report_t, strobe_delay_cycles, 64);
AT(opms_trigger_report_t, strobe_length_cycles, 68);
AT(opms_trigger_report_t, gap_us, 72);
AT(opms_trigger_report_t, dropped, 80);

SIZE(opms_pong_report_t, 48);
AT(opms_pong_report_t, report_number, 4);
AT(opms_pong_report_t, ping_id, 8);
AT(opms_pong_report_t, received, 16);
AT(opms_pong_report_t, sent, 32);

SIZE(opms_status_report_t, 64);
AT(opms_status_report_t, reset_cause, 4);
AT(opms_status_report_t, boot_id, 8);
AT(opms_status_report_t, session_id, 12);
AT(opms_status_report_t, report_number, 16);
AT(opms_status_report_t, uptime_us, 24);
AT(opms_status_report_t, trigger_number, 32);
AT(opms_status_report_t, first_run_number, 36);
AT(opms_status_report_t, glitches, 40);
AT(opms_status_report_t, starts_refused, 44);
AT(opms_status_report_t, strobes_missing, 48);
AT(opms_status_report_t, dropped, 52);
AT(opms_status_report_t, commands_refused, 56);
AT(opms_status_report_t, reenumerations, 60);
AT(opms_status_report_t, settings_crc, 62);

SIZE(opms_event_report_t, 48);
AT(opms_event_report_t, state, 4);
AT(opms_event_report_t, boot_id, 8);
AT(opms_event_report_t, session_id, 12);
AT(opms_event_report_t, report_number, 16);
AT(opms_event_report_t, event_number, 20);
AT(opms_event_report_t, time, 24);
AT(opms_event_report_t, argument, 40);
AT(opms_event_report_t, detail, 44);

SIZE(opms_command_report_t, 8);
AT(opms_command_report_t, argument, 4);

SIZE(opms_identity_report_t, 56);
AT(opms_identity_report_t, firmware_version, 2);
AT(opms_identity_report_t, firmware_modified, 5);
AT(opms_identity_report_t, capabilities, 6);
AT(opms_identity_report_t, unique_id, 8);
AT(opms_identity_report_t, git_hash, 16);
AT(opms_identity_report_t, boot_id, 40);
AT(opms_identity_report_t, clock_hz, 44);
AT(opms_identity_report_t, start_cycles, 48);
AT(opms_identity_report_t, ring_entries, 50);
AT(opms_identity_report_t, history_entries, 52);

SIZE(opms_settings_t, 40);
AT(opms_settings_t, width_us, 4);
AT(opms_settings_t, debounce_cycles, 8);
AT(opms_settings_t, trig_active_low, 12);
AT(opms_settings_t, start_falling_edge, 13);
AT(opms_settings_t, strobe_enabled, 14);
AT(opms_settings_t, strobe_active_low, 15);
AT(opms_settings_t, sync, 16);
AT(opms_settings_t, preamble_gap_ms, 20);
AT(opms_settings_t, wait_timeout_s, 36);

SIZE(opms_settings_report_t, 48);
AT(opms_settings_report_t, last_set, 40);
AT(opms_settings_report_t, pending, 44);
AT(opms_settings_report_t, stored, 45);
AT(opms_settings_report_t, settings_crc, 46);

SIZE(opms_history_request_t, 16);
AT(opms_history_request_t, session_id, 4);
AT(opms_history_request_t, first_number, 8);
AT(opms_history_request_t, count, 12);
SIZE(opms_history_entry_t, 32);
AT(opms_history_entry_t, flags, 4);
AT(opms_history_entry_t, time, 8);
AT(opms_history_entry_t, strobe_delay_cycles, 24);
AT(opms_history_entry_t, strobe_length_cycles, 28);
SIZE(opms_history_report_t, 88);
AT(opms_history_report_t, boot_id, 4);
AT(opms_history_report_t, session_id, 8);
AT(opms_history_report_t, remaining, 12);
AT(opms_history_report_t, count, 16);
AT(opms_history_report_t, entries, 24);

SIZE(opms_blur_t, 80);
AT(opms_blur_t, blur_px, 8);
AT(opms_blur_t, motion_direction, 40);
AT(opms_blur_t, sharpest_px, 56);
AT(opms_blur_t, softest_square, 76);
SIZE(opms_blur_options_t, 16);
AT(opms_blur_options_t, sharp_most_px, 8);
