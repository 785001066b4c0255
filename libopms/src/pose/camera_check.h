/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Checks of a camera's parts that several calls share. */
#ifndef OPMS_POSE_CAMERA_CHECK_H
#define OPMS_POSE_CAMERA_CHECK_H

#include <opms/status.h>
#include <opms/types.h>

namespace opms::pose
{

/** Finite, orthonormal to 1e-6, right-handed. `name` goes into the message. */
opms_status_t check_transform(const opms_transform_t &transform, const char *name,
                              opms_error_t *err);

/** The rotation and the covariances that the camera says it holds; not the lens. */
opms_status_t check_camera_mounting(const opms_camera_t &camera, opms_error_t *err);

} // namespace opms::pose
#endif
