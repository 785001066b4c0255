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

SIZE(opms_camera_t, 984);
AT(opms_camera_t, has_covariance_intrinsics, 72);
AT(opms_camera_t, has_detector_camera, 76);
AT(opms_camera_t, has_covariance_detector_camera, 80);
AT(opms_camera_t, covariance_intrinsics, 88);
AT(opms_camera_t, detector_camera, 600);
AT(opms_camera_t, covariance_detector_camera, 696);

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

/* Options grow at their end; what stands before stays. */
AT(opms_bar_options_t, struct_size, 0);
AT(opms_bar_options_t, min_square_px, 4);
AT(opms_bar_options_t, allocator, 8);
AT(opms_locator_options_t, struct_size, 0);
AT(opms_locator_options_t, bar_tilt_rad, 8);
AT(opms_locator_options_t, bar, 16);
