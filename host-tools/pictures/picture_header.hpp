/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Size of a picture from its first bytes, so that nothing is unpacked that does not fit. */
#ifndef OPMS_PICTURES_PICTURE_HEADER_HPP
#define OPMS_PICTURES_PICTURE_HEADER_HPP

#include <cstddef>
#include <cstdint>
#include <vector>

enum class PictureKind { unknown, png, jpeg, bmp, pnm, tiff };

struct PictureHeader {
    PictureKind kind = PictureKind::unknown;
    /** 0 x 0 where the kind is known but the header is broken. */
    uint64_t width_px = 0, height_px = 0;
    /** False where the file ends early in a way that its decoder would paint over. */
    bool complete = true;
};

/** Look at the start of a file. Safe on any bytes; decodes nothing. */
PictureHeader picture_header(const std::vector<unsigned char> &bytes);

#endif
