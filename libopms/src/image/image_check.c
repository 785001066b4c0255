/* SPDX-License-Identifier: Apache-2.0 */
#include "image/image_check.h"

#include <stddef.h>
#include <stdint.h>

#include "base/fail.h"

opms_status_t image_check(const opms_image_t *image, int32_t width_px, int32_t height_px,
                          const char *whose, const char *stage, opms_error_t *err)
{
    if (!image || !image->pixels) {
        return opms_fail(err, OPMS_ERR_ARG, stage, -1, "%s is NULL",
                         image ? "image.pixels" : "image");
    }
    if (image->format != OPMS_PIXEL_GREY8 && image->format != OPMS_PIXEL_GREY16) {
        return opms_fail(err, OPMS_ERR_ARG, stage, -1, "image.format %d is unknown",
                         (int)image->format);
    }
    if (image->width_px != width_px || image->height_px != height_px) {
        return opms_fail(err, OPMS_ERR_ARG, stage, -1,
                         "image is %d x %d px, the %s is for %d x %d", (int)image->width_px,
                         (int)image->height_px, whose, (int)width_px, (int)height_px);
    }
    const ptrdiff_t size = image->format == OPMS_PIXEL_GREY16 ? 2 : 1;
    if (image->stride_bytes < image->width_px * size || image->stride_bytes % size != 0) {
        return opms_fail(err, OPMS_ERR_ARG, stage, -1,
                         "image.stride_bytes is %td, a row of %d px needs %td (a multiple of %td)",
                         image->stride_bytes, (int)image->width_px, image->width_px * size, size);
    }
    if (size == 2 && (uintptr_t)image->pixels % 2 != 0) {
        return opms_fail(err, OPMS_ERR_ARG, stage, -1, "image.pixels is not aligned to 2 bytes");
    }
    if (image->format == OPMS_PIXEL_GREY8 && image->white_level > 255) {
        return opms_fail(err, OPMS_ERR_ARG, stage, -1,
                         "image.white_level is %u, a grey8 picture has up to 255",
                         (unsigned)image->white_level);
    }
    return OPMS_OK;
}
