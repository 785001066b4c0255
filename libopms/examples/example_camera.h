/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The camera of the examples' pictures. Put the numbers of your own camera here, or read them from
 * a camera file as host-tools does. */
#ifndef EXAMPLE_CAMERA_H
#define EXAMPLE_CAMERA_H

#include <opms/types.h>

static inline opms_camera_t example_camera(void)
{
    /* 0.40 m above and 0.10 m ahead of the search head, 25 degrees off the vertical. */
    const double sin25 = 0.42261826174069944, cos25 = 0.90630778703664994;
    const opms_camera_t camera = {
        .lens = {.width_px = 1024,
                 .height_px = 768,
                 .fx_px = 585.0,
                 .fy_px = 585.0,
                 .cx_px = 517.3,
                 .cy_px = 379.6,
                 .k1 = -0.118,
                 .k2 = 0.031,
                 .p1 = 0.0011,
                 .p2 = -0.0007},
        .has_detector_camera = 1,
        .detector_camera = {.R = {-cos25, 0.0, -sin25, 0.0, 1.0, 0.0, sin25, 0.0, -cos25},
                            .t_m = {-0.10, 0.0, 0.40}}};
    return camera;
}

#endif
