/* SPDX-License-Identifier: Apache-2.0 */
#include "png_pack.h"

#include <zlib.h>

#include "png_common.h"

struct outlet {
    png_sink_fn *sink;
    void *context;
};

static void write_bytes(png_structp png, png_bytep bytes, size_t size)
{
    const struct outlet *const outlet = png_get_io_ptr(png);
    if (!outlet->sink(outlet->context, bytes, size)) {
        png_error(png, "no room for the file");
    }
}

static void flush_nothing(png_structp png)
{
    (void)png;
}

static void write_header(png_structp png, png_infop info, const struct png_layout *layout)
{
    const int colour = layout->channels == 1   ? PNG_COLOR_TYPE_GRAY
                       : layout->channels == 3 ? PNG_COLOR_TYPE_RGB
                                               : PNG_COLOR_TYPE_RGBA;
    png_set_IHDR(png, info, layout->width_px, layout->height_px, layout->is_16_bit ? 16 : 8,
                 colour, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    png_set_bgr(png); /* does nothing to grey */
    if (layout->is_16_bit) {
        png_use_own_order(png);
    }
}

/** All that may end in png_give_up(): it holds nothing that would have to be released. */
static bool pack(png_structp png, png_infop info, const struct png_pixels *pixels, int level)
{
    if (setjmp(png_jmpbuf(png)) != 0) {
        return false;
    }
    png_set_compression_level(png, level);
    png_set_compression_strategy(png, Z_DEFAULT_STRATEGY);
    write_header(png, info, &pixels->layout);
    for (uint32_t y = 0; y < pixels->layout.height_px; y++) {
        png_write_row(png, pixels->first + y * pixels->stride_bytes);
    }
    png_write_end(png, info);
    return true;
}

bool png_pack(const struct png_pixels *pixels, int level, png_sink_fn *sink, void *context)
{
    struct outlet outlet = {sink, context};
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, png_give_up,
                                              png_stay_silent);
    if (!png) {
        return false;
    }
    png_infop info = png_create_info_struct(png);
    bool good = false;
    if (info) {
        png_set_write_fn(png, &outlet, write_bytes, flush_nothing);
        good = pack(png, info, pixels, level);
    }
    png_destroy_write_struct(&png, &info);
    return good;
}
