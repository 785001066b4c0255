/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Pixels as a PNG file. C, because libpng gives up by longjmp(). */
#ifndef OPMS_PNG_PNG_PACK_H
#define OPMS_PNG_PNG_PACK_H

#include <stdbool.h>
#include <stddef.h>

#include "png_unpack.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Pixels to be packed. */
struct png_pixels {
    struct png_layout layout;
    const unsigned char *first;
    size_t stride_bytes;
};

/** Takes the file piece by piece; false to give up. */
typedef bool png_sink_fn(void *context, const unsigned char *bytes, size_t size);

/** Pack a picture. @param level  zlib's, 0 (none) to 9 (small and slow).
 * @return false where there is no memory or the sink gave up. */
bool png_pack(const struct png_pixels *pixels, int level, png_sink_fn *sink, void *context);

#ifdef __cplusplus
}
#endif
#endif
