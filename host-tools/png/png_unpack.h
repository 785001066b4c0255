/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Pixels of a PNG file in memory. C, because libpng gives up by longjmp(). */
#ifndef OPMS_PNG_PNG_UNPACK_H
#define OPMS_PNG_PNG_UNPACK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** What the unpacked pixels are like. */
struct png_layout {
    uint32_t width_px, height_px;
    int channels;   /**< 1 grey, 3 BGR, 4 BGRA */
    bool is_16_bit; /**< in the machine's byte order; else 8 */
};

/** Gives room for the pixels, rows without gaps; NULL to give up. */
typedef unsigned char *png_room_fn(void *context, const struct png_layout *layout);

/** Unpack a whole file.
 *
 * Palettes become colours and fewer than 8 bits become 8. Transparency is kept where the file
 * has alpha or names transparent colours, but not for a transparent grey level.
 *
 * @return false where the file is damaged or there is no room. */
bool png_unpack(const unsigned char *bytes, size_t size, png_room_fn *room, void *context);

#ifdef __cplusplus
}
#endif
#endif
