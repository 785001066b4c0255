/* SPDX-License-Identifier: Apache-2.0 */
/* PNG files of every kind, written by libpng itself with seeded noise; OpenCV's imgcodecs is the
 * judge of what is read and of what is written. */
#include <cstdio>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include <png.h>

#include "png_matrix.hpp"

namespace {

using File = std::vector<unsigned char>;

int failures = 0;

void expect(bool good, const std::string &what)
{
    if (!good) {
        std::fprintf(stderr, "FAILED: %s\n", what.c_str());
        failures++;
    }
}

bool same(const cv::Mat &a, const cv::Mat &b)
{
    if (a.empty() || b.empty()) {
        return a.empty() && b.empty();
    }
    return a.size() == b.size() && a.type() == b.type() &&
           std::memcmp(a.data, b.data, a.total() * a.elemSize()) == 0;
}

cv::Mat judged(const File &file)
{
    try {
        return cv::imdecode(file, cv::IMREAD_UNCHANGED);
    } catch (const cv::Exception &) {
        return cv::Mat();
    }
}

struct Kind {
    int colour, bits;
    bool interlaced, transparent;
    unsigned int width, height;

    std::string text() const
    {
        return "colour " + std::to_string(colour) + ", " + std::to_string(bits) + " bit" +
               (interlaced ? ", interlaced" : "") + (transparent ? ", transparent" : "") + ", " +
               std::to_string(width) + " x " + std::to_string(height);
    }
};

int channels_of(int colour)
{
    return colour == PNG_COLOR_TYPE_RGB          ? 3
           : colour == PNG_COLOR_TYPE_RGBA       ? 4
           : colour == PNG_COLOR_TYPE_GRAY_ALPHA ? 2
                                                 : 1;
}

void append(png_structp png, png_bytep bytes, std::size_t size)
{
    auto *const file = static_cast<File *>(png_get_io_ptr(png));
    file->insert(file->end(), bytes, bytes + size);
}

void set_palette(png_structp png, png_infop info, std::mt19937 &random, const Kind &kind)
{
    png_color palette[256];
    unsigned char alpha[256];
    const int count = 1 << kind.bits;
    for (int i = 0; i < count; i++) {
        palette[i].red = static_cast<unsigned char>(random());
        palette[i].green = static_cast<unsigned char>(random());
        palette[i].blue = static_cast<unsigned char>(random());
        alpha[i] = static_cast<unsigned char>(random());
    }
    png_set_PLTE(png, info, palette, count);
    if (kind.transparent) {
        png_set_tRNS(png, info, alpha, count, nullptr);
    }
}

void set_transparent(png_structp png, png_infop info, const Kind &kind)
{
    png_color_16 colour = {};
    colour.gray = colour.red = colour.green = colour.blue =
        static_cast<png_uint_16>((1 << kind.bits) / 2);
    if (kind.transparent && kind.colour != PNG_COLOR_TYPE_PALETTE) {
        png_set_tRNS(png, info, nullptr, 0, &colour);
    }
}

/** A file of noise. Any error of libpng ends the test: it is the test's own. */
File made(const Kind &kind, unsigned int seed)
{
    std::mt19937 random(seed);
    File file;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(png, &file, append, nullptr);
    png_set_IHDR(png, info, kind.width, kind.height, kind.bits, kind.colour,
                 kind.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (kind.colour == PNG_COLOR_TYPE_PALETTE) {
        set_palette(png, info, random, kind);
    }
    set_transparent(png, info, kind);
    png_write_info(png, info);
    std::vector<File> rows(kind.height, File(png_get_rowbytes(png, info)));
    std::vector<png_bytep> pointers;
    for (File &row : rows) {
        for (unsigned char &byte : row) {
            byte = static_cast<unsigned char>(random());
        }
        pointers.push_back(row.data());
    }
    png_write_image(png, pointers.data());
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return file;
}

std::vector<Kind> all_kinds()
{
    std::vector<Kind> kinds;
    for (const int colour : {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_PALETTE, PNG_COLOR_TYPE_RGB,
                             PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGBA}) {
        for (const int bits : {1, 2, 4, 8, 16}) {
            const bool narrow = channels_of(colour) > 1 && bits < 8;
            if (narrow || (colour == PNG_COLOR_TYPE_PALETTE && bits > 8)) {
                continue;
            }
            for (const bool interlaced : {false, true}) {
                kinds.push_back({colour, bits, interlaced, false, 37, 29});
                kinds.push_back({colour, bits, interlaced, false, 1, 1});
                if ((colour & PNG_COLOR_MASK_ALPHA) == 0) {
                    kinds.push_back({colour, bits, interlaced, true, 37, 29});
                }
            }
        }
    }
    return kinds;
}

void every_kind_is_read_as_opencv_reads_it()
{
    unsigned int seed = 1;
    for (const Kind &kind : all_kinds()) {
        const File file = made(kind, seed++);
        const cv::Mat expected = judged(file);
        expect(!expected.empty(), "OpenCV reads " + kind.text());
        expect(same(opms_host::png_to_matrix(file), expected), kind.text() + " is read as it is");
    }
}

/** Where OpenCV reads a damaged file nevertheless (a damaged comment), the pixels are the same. */
void damaged_files_are_refused_as_opencv_refuses_them()
{
    int refused = 0;
    for (const Kind &kind : {Kind{PNG_COLOR_TYPE_GRAY, 8, false, false, 31, 17},
                             Kind{PNG_COLOR_TYPE_PALETTE, 4, true, true, 31, 17}}) {
        const File whole = made(kind, 99);
        for (std::size_t i = 0; i < whole.size(); i++) {
            File changed = whole;
            changed[i] ^= 0x40;
            const cv::Mat found = opms_host::png_to_matrix(changed);
            refused += found.empty();
            expect(same(found, judged(changed)),
                   kind.text() + " with byte " + std::to_string(i) + " changed");
            const File cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(i));
            expect(opms_host::png_to_matrix(cut).empty(),
                   kind.text() + " is refused where it ends after " + std::to_string(i));
        }
    }
    expect(refused > 500, "most damages are refused");
}

void every_matrix_is_written_without_loss()
{
    cv::RNG random(7);
    for (const int depth : {CV_8U, CV_16U}) {
        for (const int channels : {1, 3, 4}) {
            for (const int level : {0, 1, 3, 9}) {
                cv::Mat wide(23, 40, CV_MAKETYPE(depth, channels));
                random.fill(wide, cv::RNG::UNIFORM, 0, 65536);
                const cv::Mat part = wide(cv::Rect(3, 2, 31, 19)); /* rows with gaps */
                const File file = opms_host::png_from_matrix(part, level);
                expect(same(judged(file), part.clone()),
                       "type " + std::to_string(part.type()) + " at level " +
                           std::to_string(level) + " is written as it is");
            }
        }
    }
}

void other_matrices_are_not_written()
{
    for (const cv::Mat &picture : {cv::Mat(), cv::Mat(8, 8, CV_32F, cv::Scalar(1)),
                                   cv::Mat(8, 8, CV_8UC2, cv::Scalar(1, 2))}) {
        expect(opms_host::png_from_matrix(picture, 1).empty(), "no file of what PNG has not");
    }
}

}  // namespace

int main()
{
    every_kind_is_read_as_opencv_reads_it();
    damaged_files_are_refused_as_opencv_refuses_them();
    every_matrix_is_written_without_loss();
    other_matrices_are_not_written();
    if (failures == 0) {
        std::printf("PNG as OpenCV has it\n");
    }
    return failures != 0;
}
