/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A fuzzer's bytes as a picture. */
#ifndef OPMS_FUZZ_PICTURE_H
#define OPMS_FUZZ_PICTURE_H

#include <stdint.h>
#include <stdlib.h>

#include <opms/types.h>

struct fuzz_picture {
    uint8_t width, height; /* less one */
    uint8_t padding;       /* bytes after each row */
    int wide;              /* 16 bit */
    int white_level;       /* not the format's own */
};

static inline void require(int holds)
{
    if (!holds) {
        abort();
    }
}

/* A block that ends with the last pixel, so that a sanitizer sees the first byte read beyond. */
static inline void *make_pixels(const struct fuzz_picture *picture, const uint8_t *data,
                                size_t size, opms_image_t *image)
{
    const int wide = picture->wide != 0;
    const size_t row = (size_t)(picture->width + 1) << wide;
    const size_t stride = row + ((size_t)picture->padding & ~(size_t)wide);
    const size_t bytes = stride * picture->height + row;
    uint8_t *pixels = malloc(bytes);
    require(pixels != NULL);
    for (size_t i = 0; i < bytes; ++i) {
        pixels[i] = size ? data[i % size] : 0;
    }
    image->pixels = pixels;
    image->width_px = picture->width + 1;
    image->height_px = picture->height + 1;
    image->stride_bytes = (ptrdiff_t)stride;
    image->format = wide ? OPMS_PIXEL_GREY16 : OPMS_PIXEL_GREY8;
    image->white_level = picture->white_level ? (wide ? 4095 : 200) : 0;
    return pixels;
}

#endif
