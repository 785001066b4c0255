/* SPDX-License-Identifier: Apache-2.0 */
/* PNG (ISO/IEC 15948): signature, header, one IDAT chunk, end. Rows are stored as differences to
 * the left neighbour (filter 1), which a camera's noise leaves small; Z_RLE then does little more
 * than the Huffman code of them, and more would not find more. */
#include "grey_png.hpp"

#include <cstring>

#include <zlib.h>

namespace opms_host {

namespace {

using Bytes = std::vector<std::uint8_t>;

/** Numbers of 32 bits stand with the highest byte first. */
void put_32(std::uint8_t *at, std::uint32_t value)
{
    for (int i = 0; i < 4; i++) {
        at[i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
    }
}

/** @p bytes ends with the data of the chunk that open_chunk() has made room for at @p start. */
void close_chunk(Bytes &bytes, std::size_t start, const char *name)
{
    const std::size_t size = bytes.size() - start - 8;
    put_32(&bytes[start], static_cast<std::uint32_t>(size));
    for (std::size_t i = 0; i < 4; i++) {
        bytes[start + 4 + i] = static_cast<std::uint8_t>(name[i]);
    }
    const uLong sum = crc32(0, &bytes[start + 4], static_cast<uInt>(size + 4));
    bytes.resize(bytes.size() + 4);
    put_32(&bytes[bytes.size() - 4], static_cast<std::uint32_t>(sum));
}

std::size_t open_chunk(Bytes &bytes)
{
    bytes.resize(bytes.size() + 8);
    return bytes.size() - 8;
}

void add_header(Bytes &bytes, const GreyPicture &picture)
{
    static const std::uint8_t signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    bytes.insert(bytes.end(), signature, signature + sizeof signature);
    const std::size_t start = open_chunk(bytes);
    bytes.resize(bytes.size() + 13); /* the last 4: grey, deflate, filters by row, not interlaced */
    put_32(&bytes[start + 8], static_cast<std::uint32_t>(picture.width_px));
    put_32(&bytes[start + 12], static_cast<std::uint32_t>(picture.height_px));
    bytes[start + 16] = picture.is_16_bit ? 16 : 8;
    close_chunk(bytes, start, "IHDR");
}

/** @param step  Bytes of a pixel. @param[out] row  Differences to the left neighbour. */
void make_row(const std::uint8_t *pixels, std::size_t size, std::size_t step, bool differences,
              std::uint8_t *row)
{
    row[0] = differences ? 1 : 0;
    std::memcpy(row + 1, pixels, size);
    if (differences) {
        for (std::size_t i = step; i < size; i++) {
            row[1 + i] = static_cast<std::uint8_t>(pixels[i] - pixels[i - step]);
        }
    }
}

/** 16 bit levels with the high byte first. */
Bytes high_first(const GreyPicture &picture, std::size_t size)
{
    Bytes bytes(size);
    for (std::size_t i = 0; i + 1 < size; i += 2) {
        std::uint16_t level = 0;
        std::memcpy(&level, picture.pixels + i, 2);
        bytes[i] = static_cast<std::uint8_t>(level >> 8);
        bytes[i + 1] = static_cast<std::uint8_t>(level);
    }
    return bytes;
}

/** All rows, each with its filter's number first. */
Bytes filtered(const GreyPicture &picture, bool differences)
{
    const std::size_t step = picture.is_16_bit ? 2 : 1;
    const std::size_t size = static_cast<std::size_t>(picture.width_px) * step;
    const auto height = static_cast<std::size_t>(picture.height_px);
    const Bytes swapped = picture.is_16_bit ? high_first(picture, size * height) : Bytes();
    const std::uint8_t *const pixels = picture.is_16_bit ? swapped.data() : picture.pixels;
    Bytes rows((size + 1) * height);
    for (std::size_t y = 0; y < height; y++) {
        make_row(pixels + y * size, size, step, differences, rows.data() + y * (size + 1));
    }
    return rows;
}

/** Append the rows, packed. */
bool add_rows(Bytes &bytes, const GreyPicture &picture, PngEffort effort)
{
    const bool pack = effort == PngEffort::pack;
    z_stream stream = {};
    if (deflateInit2(&stream, pack ? 1 : 0, Z_DEFLATED, 15, 9, Z_RLE) != Z_OK) {
        return false;
    }
    Bytes rows = filtered(picture, pack);
    const std::size_t start = bytes.size();
    /* zlib's bound is a few bytes short for a pixel that is not packed. */
    const uLong bound = deflateBound(&stream, static_cast<uLong>(rows.size())) + 64;
    bytes.resize(start + bound);
    stream.next_in = rows.data();
    stream.avail_in = static_cast<uInt>(rows.size());
    stream.next_out = bytes.data() + start;
    stream.avail_out = static_cast<uInt>(bound);
    const int result = deflate(&stream, Z_FINISH);
    bytes.resize(start + stream.total_out);
    deflateEnd(&stream);
    return result == Z_STREAM_END;
}

}  // namespace

std::vector<std::uint8_t> grey_png(const GreyPicture &picture, PngEffort effort)
{
    Bytes bytes;
    add_header(bytes, picture);
    const std::size_t rows = open_chunk(bytes);
    if (!add_rows(bytes, picture, effort)) {
        return Bytes();
    }
    close_chunk(bytes, rows, "IDAT");
    const std::size_t end = open_chunk(bytes);
    close_chunk(bytes, end, "IEND");
    return bytes;
}

}  // namespace opms_host
