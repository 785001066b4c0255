/* SPDX-License-Identifier: Apache-2.0 */
#include "example_pgm.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/** PGM's 16-bit levels have the high byte first; libopms wants the machine's order. */
static void to_machine_order(unsigned char *bytes, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        const uint16_t level = (uint16_t)(bytes[2 * i] << 8 | bytes[2 * i + 1]);
        memcpy(bytes + 2 * i, &level, sizeof level);
    }
}

static int read_picture(FILE *file, opms_image_t *image)
{
    int width, height, white;
    if (fscanf(file, "P5 %d %d %d", &width, &height, &white) != 3 || fgetc(file) == EOF ||
        width < 1 || width > 16384 || height < 1 || height > 16384 || white < 1 || white > 65535) {
        return -1;
    }
    const size_t pixel_bytes = white > 255 ? 2 : 1;
    const size_t count = (size_t)width * (size_t)height;
    unsigned char *pixels = malloc(count * pixel_bytes);
    if (!pixels || fread(pixels, pixel_bytes, count, file) != count) {
        free(pixels);
        return -1;
    }
    if (pixel_bytes == 2) {
        to_machine_order(pixels, count);
    }
    *image = (opms_image_t){.pixels = pixels,
                            .width_px = width,
                            .height_px = height,
                            .stride_bytes = (ptrdiff_t)((size_t)width * pixel_bytes),
                            .format = pixel_bytes == 2 ? OPMS_PIXEL_GREY16 : OPMS_PIXEL_GREY8,
                            .white_level = (uint16_t)white};
    return 0;
}

int example_pgm_read(const char *path, opms_image_t *image)
{
    FILE *file = fopen(path, "rb");
    const int result = file ? read_picture(file, image) : -1;
    if (file) {
        fclose(file);
    }
    if (result != 0) {
        fprintf(stderr, "%s: cannot be read as a binary PGM picture\n", path);
    }
    return result;
}
