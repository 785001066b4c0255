/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Can a picture be read, and has it the size that was agreed? */
#ifndef OPMS_IMAGE_IMAGE_CHECK_H
#define OPMS_IMAGE_IMAGE_CHECK_H

#include <opms/status.h>
#include <opms/types.h>

/** Check a picture as a caller gave it.
 * @param whose  what the size belongs to, for the message: "lens", "detector"
 * @return OPMS_OK or OPMS_ERR_ARG. */
opms_status_t image_check(const opms_image_t *image, int32_t width_px, int32_t height_px,
                          const char *whose, const char *stage, opms_error_t *err);

#endif
