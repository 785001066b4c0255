/* SPDX-License-Identifier: Apache-2.0 */
/* Each reader takes the few fields it needs with bounds checked by Bytes; a field beyond the end
 * reads as 0, and a size of 0 means broken. */
#include "picture_header.hpp"

#include <cstring>
#include <string>

namespace {

class Bytes {
public:
    explicit Bytes(const std::vector<unsigned char> &data) : data_(data) {}
    std::size_t size() const { return data_.size(); }
    uint64_t at(std::size_t i) const { return i < data_.size() ? data_[i] : 0; }
    uint64_t big(std::size_t i, int n) const
    {
        uint64_t value = 0;
        for (int k = 0; k < n; k++) {
            value = value << 8 | at(i + static_cast<std::size_t>(k));
        }
        return value;
    }
    uint64_t little(std::size_t i, int n) const
    {
        uint64_t value = 0;
        for (int k = n - 1; k >= 0; k--) {
            value = value << 8 | at(i + static_cast<std::size_t>(k));
        }
        return value;
    }
    bool starts_with(const char *text, std::size_t n) const
    {
        return data_.size() >= n && std::memcmp(data_.data(), text, n) == 0;
    }

private:
    const std::vector<unsigned char> &data_;
};

void read_png(const Bytes &b, PictureHeader &header)
{
    if (b.big(12, 4) == 0x49484452) { /* IHDR */
        header.width_px = b.big(16, 4);
        header.height_px = b.big(20, 4);
    }
}

/** From the start of the scan on, FF D9 can only be the end of the picture. */
bool jpeg_ends(const Bytes &b, std::size_t scan)
{
    for (std::size_t i = scan; i + 1 < b.size(); i++) {
        if (b.at(i) == 0xff && b.at(i + 1) == 0xd9) {
            return true;
        }
    }
    return false;
}

void read_jpeg(const Bytes &b, PictureHeader &header)
{
    std::size_t i = 2;
    while (i + 4 <= b.size() && b.at(i) == 0xff) {
        const uint64_t marker = b.at(i + 1);
        if (marker == 0xff) { /* padding */
            i++;
            continue;
        }
        const bool frame = marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 &&
                           marker != 0xcc;
        if (frame) {
            header.height_px = b.big(i + 5, 2);
            header.width_px = b.big(i + 7, 2);
        }
        if (marker == 0xda) {
            header.complete = jpeg_ends(b, i);
            return;
        }
        i += 2 + static_cast<std::size_t>(b.big(i + 2, 2));
    }
    header.complete = false;
}

void read_bmp(const Bytes &b, PictureHeader &header)
{
    if (b.little(14, 4) == 12) {
        header.width_px = b.little(18, 2);
        header.height_px = b.little(20, 2);
        return;
    }
    const auto height = static_cast<int32_t>(b.little(22, 4)); /* negative: top row first */
    header.width_px = b.little(18, 4);
    header.height_px = static_cast<uint64_t>(height < 0 ? -static_cast<int64_t>(height) : height);
}

/** Width and height are the first two numbers after the magic; '#' starts a comment. */
void read_pnm(const Bytes &b, PictureHeader &header)
{
    uint64_t number[2] = {0, 0};
    std::size_t i = 2;
    for (uint64_t &value : number) {
        while (i < b.size() && (b.at(i) <= ' ' || b.at(i) == '#')) {
            if (b.at(i) == '#') {
                while (i < b.size() && b.at(i) != '\n') {
                    i++;
                }
            }
            i++;
        }
        for (; i < b.size() && b.at(i) >= '0' && b.at(i) <= '9'; i++) {
            if (value < (1u << 30)) {
                value = value * 10 + (b.at(i) - '0');
            }
        }
    }
    header.width_px = number[0];
    header.height_px = number[1];
}

/** Sizes are tags 256 and 257 of the first directory, as 16 or 32 bit numbers. */
void read_tiff(const Bytes &b, bool big_endian, PictureHeader &header)
{
    const auto number = [&](std::size_t i, int n) {
        return big_endian ? b.big(i, n) : b.little(i, n);
    };
    const auto directory = static_cast<std::size_t>(number(4, 4));
    const uint64_t count = number(directory, 2);
    for (uint64_t k = 0; k < count; k++) {
        const std::size_t entry = directory + 2 + static_cast<std::size_t>(k) * 12;
        const uint64_t tag = number(entry, 2);
        if (tag == 256 || tag == 257) {
            const uint64_t value = number(entry + 8, number(entry + 2, 2) == 3 ? 2 : 4);
            (tag == 256 ? header.width_px : header.height_px) = value;
        }
    }
}

}  // namespace

PictureHeader picture_header(const std::vector<unsigned char> &bytes)
{
    const Bytes b(bytes);
    PictureHeader header;
    if (b.starts_with("\x89PNG\r\n\x1a\n", 8)) {
        header.kind = PictureKind::png;
        read_png(b, header);
    } else if (b.starts_with("\xff\xd8\xff", 3)) {
        header.kind = PictureKind::jpeg;
        read_jpeg(b, header);
    } else if (b.starts_with("BM", 2)) {
        header.kind = PictureKind::bmp;
        read_bmp(b, header);
    } else if (b.at(0) == 'P' && b.at(1) >= '1' && b.at(1) <= '6') {
        header.kind = PictureKind::pnm;
        read_pnm(b, header);
    } else if (b.starts_with("II*\0", 4) || b.starts_with("MM\0*", 4)) {
        header.kind = PictureKind::tiff;
        read_tiff(b, b.at(0) == 'M', header);
    }
    return header;
}
