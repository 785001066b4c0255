/* SPDX-License-Identifier: Apache-2.0 */
#include "png_unpack.h"

#include <string.h>

#include "png_common.h"

/** The part of the file that has not been read. */
struct unread {
    const unsigned char *bytes;
    size_t size;
};

static void read_bytes(png_structp png, png_bytep to, size_t size)
{
    struct unread *const unread = png_get_io_ptr(png);
    if (size > unread->size) {
        png_error(png, "the file ends early");
    }
    memcpy(to, unread->bytes, size);
    unread->bytes += size;
    unread->size -= size;
}

static struct png_layout layout_of(png_structp png, png_infop info)
{
    const int colour = png_get_color_type(png, info);
    const bool named = png_get_valid(png, info, PNG_INFO_tRNS) != 0;
    struct png_layout layout;
    layout.width_px = png_get_image_width(png, info);
    layout.height_px = png_get_image_height(png, info);
    layout.is_16_bit = png_get_bit_depth(png, info) == 16;
    layout.channels = colour == PNG_COLOR_TYPE_GRAY                  ? 1
                      : (colour & PNG_COLOR_MASK_ALPHA) != 0 || named ? 4
                                                                      : 3;
    return layout;
}

/** Ask for pixels as @p layout says. */
static void transform(png_structp png, png_infop info, const struct png_layout *layout)
{
    if (layout->is_16_bit) {
        png_use_own_order(png);
    }
    if (layout->channels == 1) {
        png_set_expand_gray_1_2_4_to_8(png);
        return;
    }
    if (png_get_color_type(png, info) == PNG_COLOR_TYPE_PALETTE) {
        png_set_palette_to_rgb(png);
    }
    if (layout->channels == 4) {
        png_set_tRNS_to_alpha(png);
    }
    png_set_gray_to_rgb(png);
    png_set_bgr(png);
}

static void read_rows(png_structp png, png_infop info, const struct png_layout *layout,
                      unsigned char *pixels)
{
    const size_t row_bytes = (size_t)layout->width_px * (size_t)layout->channels *
                             (layout->is_16_bit ? 2 : 1);
    const int passes = png_set_interlace_handling(png);
    png_read_update_info(png, info);
    if (png_get_rowbytes(png, info) != row_bytes) {
        png_error(png, "rows of another size");
    }
    for (int pass = 0; pass < passes; pass++) {
        for (uint32_t y = 0; y < layout->height_px; y++) {
            png_read_row(png, pixels + y * row_bytes, NULL);
        }
    }
}

/** All that may end in png_give_up(): it holds nothing that would have to be released. */
static bool unpack(png_structp png, png_infop info, png_infop end, png_room_fn *room,
                   void *context)
{
    if (setjmp(png_jmpbuf(png)) != 0) {
        return false;
    }
    png_read_info(png, info);
    const struct png_layout layout = layout_of(png, info);
    transform(png, info, &layout);
    unsigned char *const pixels = room(context, &layout);
    if (!pixels) {
        return false;
    }
    read_rows(png, info, &layout, pixels);
    png_read_end(png, end);
    return true;
}

bool png_unpack(const unsigned char *bytes, size_t size, png_room_fn *room, void *context)
{
    struct unread unread = {bytes, size};
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, png_give_up,
                                            png_stay_silent);
    if (!png) {
        return false;
    }
    png_infop info = png_create_info_struct(png);
    png_infop end = png_create_info_struct(png);
    bool good = false;
    if (info && end) {
        png_set_read_fn(png, &unread, read_bytes);
        good = unpack(png, info, end, room, context);
    }
    png_destroy_read_struct(&png, &info, &end);
    return good;
}
