/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Value types that several stages share.
 *
 * Conventions (docs/conventions.md): SI units unless a name says otherwise; `R_a_b`, `t_a_b` take
 * coordinates in b to coordinates in a: p_a = R_a_b p_b + t_a_b; matrices are row-major; pixel
 * (0, 0) is the centre of the top left pixel, u to the right, v down; the camera looks along +z. */
#ifndef OPMS_TYPES_H
#define OPMS_TYPES_H

#include <stddef.h>
#include <stdint.h>

#include <opms/export.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Allocator a caller may give to a `_create`; all-zero or NULL means malloc and free. */
typedef struct opms_allocator {
    void *(*alloc)(void *user, size_t size); /**< Aligned as malloc's; NULL when out of memory. */
    void (*free)(void *user, void *memory);  /**< Never called with NULL. */
    void *user;
} opms_allocator_t;

typedef enum opms_pixel_format {
    OPMS_PIXEL_GREY8 = 1, /**< uint8_t, 0 black to 255 saturated */
    OPMS_PIXEL_GREY16 = 2 /**< uint16_t in the machine's byte order, see white_level */
} opms_pixel_format_t;

/** A picture as the camera delivers it; a view, never owned or copied. */
typedef struct opms_image {
    const void *pixels;         /**< Top left pixel. GREY16 is 2-byte aligned. */
    int32_t width_px, height_px; /**< 1 to 16384 */
    ptrdiff_t stride_bytes;     /**< From one row to the next; at least one row's bytes. */
    opms_pixel_format_t format;
    uint16_t white_level; /**< Grey level at saturation; 0 means 255 or 65535 (4095 for 12 bit). */
} opms_image_t;

/** Region of interest in whole pixels; width or height 0 means the whole picture. */
typedef struct opms_roi {
    int32_t x_px, y_px, width_px, height_px;
} opms_roi_t;

/** Pinhole with the four-parameter Seidel model (docs/conventions.md; OpenCV's first four). */
typedef struct opms_lens {
    int32_t width_px, height_px;
    double fx_px, fy_px, cx_px, cy_px;
    double k1, k2, p1, p2;
} opms_lens_t;

/** A rigid transform that takes coordinates in b to coordinates in a. */
typedef struct opms_transform {
    double R[9]; /**< row-major rotation R_a_b */
    double t_m[3]; /**< t_a_b in metres */
} opms_transform_t;

/** A camera as calibrated: lens, and where it sits on the detector. */
typedef struct opms_camera {
    opms_lens_t lens;
    uint32_t has_covariance_intrinsics;
    uint32_t has_detector_camera;
    uint32_t has_covariance_detector_camera;
    uint32_t has_covariance_detector_camera_intrinsics; /**< needs both of the others */
    double covariance_intrinsics[64]; /**< order fx fy cx cy k1 k2 p1 p2, px and 1 */
    opms_transform_t detector_camera; /**< camera to detector */
    double covariance_detector_camera[36]; /**< of (w, d) as opms_pose_t's, rad and m */
    /** 6 x 8 row-major covariance of detector_camera's (w, d) with the intrinsics, in the orders of
     * the two above. A mounting found through this very lens shares its errors; a pose seen through
     * it does, too, and much of both cancels. */
    double covariance_detector_camera_intrinsics[48];
} opms_camera_t;

#ifdef __cplusplus
}
#endif
#endif
