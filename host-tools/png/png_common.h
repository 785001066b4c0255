/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What packing and unpacking ask of libpng alike. Both set a jump that png_give_up() takes. */
#ifndef OPMS_PNG_COMMON_H
#define OPMS_PNG_COMMON_H

#include <setjmp.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include <png.h>

/** The caller says what is wrong; libpng would write to stderr. */
static inline void png_give_up(png_structp png, png_const_charp message)
{
    (void)message;
    png_longjmp(png, 1);
}

static inline void png_stay_silent(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

/** 16 bit samples in the machine's own order: a file has the high byte first. */
static inline void png_use_own_order(png_structp png)
{
    const uint16_t one = 1;
    unsigned char first;
    memcpy(&first, &one, 1);
    if (first == 1) {
        png_set_swap(png);
    }
}

#endif
