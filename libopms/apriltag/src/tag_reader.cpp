/* SPDX-License-Identifier: Apache-2.0 */
#include "tag_reader.h"

#include <algorithm>
#include <cstring>
#include <new>

#include <apriltag.h>
#include <tag36h11.h>

#include <opms/bar.h>

namespace opms_tag {
namespace {

/** libapriltag's threshold works in tiles and takes no picture of less than a few of them. */
constexpr int32_t SMALLEST_PICTURE_PX = 16;

InnerCells cells_of(const apriltag_family_t &family, int id)
{
    /* Bits are counted from the border's top left cell, the most significant first, 1 for white. */
    bool white[CELLS][CELLS] = {};
    for (uint32_t bit = 0; bit < family.nbits; bit++) {
        const uint64_t mask = uint64_t{1} << (family.nbits - bit - 1);
        white[family.bit_y[bit]][family.bit_x[bit]] = (family.codes[id] & mask) != 0;
    }
    InnerCells inner;
    for (int j = 0; j < CELLS; j++) {
        inner.white[0][j] = white[1][j];
        inner.white[1][j] = white[j][1];
        inner.white[2][j] = white[CELLS - 2][j];
        inner.white[3][j] = white[j][CELLS - 2];
    }
    return inner;
}

/** Copy with 16 bits brought to 8; libapriltag may write to its picture. */
void copy_grey8(const opms_image_t &image, uint8_t *to)
{
    const uint32_t white = image.white_level ? image.white_level : 65535;
    for (int32_t v = 0; v < image.height_px; v++) {
        const char *row = static_cast<const char *>(image.pixels) + v * image.stride_bytes;
        uint8_t *out = to + static_cast<ptrdiff_t>(v) * image.width_px;
        if (image.format == OPMS_PIXEL_GREY8) {
            std::memcpy(out, row, static_cast<size_t>(image.width_px));
            continue;
        }
        const uint16_t *levels = reinterpret_cast<const uint16_t *>(row);
        for (int32_t u = 0; u < image.width_px; u++) {
            out[u] = static_cast<uint8_t>(std::min<uint32_t>(255, levels[u] * 255u / white));
        }
    }
}

Sighting sighting_of(const apriltag_detection_t &tag)
{
    /* libapriltag: bottom left, bottom right, top right, top left of the upright tag, and the top
     * left pixel's corner as (0, 0). The tag's top is the bar's -X, its right the bar's +Y. */
    static const int order[4] = {3, 0, 1, 2};
    Sighting seen = {tag.id, tag.hamming, static_cast<double>(tag.decision_margin), {}};
    for (int i = 0; i < 4; i++) {
        seen.corners_px[i] = {tag.p[order[i]][0] - 0.5, tag.p[order[i]][1] - 0.5};
    }
    return seen;
}

} // namespace

struct Reader::Handles {
    apriltag_family_t *family = nullptr;
    apriltag_detector_t *detector = nullptr;
    std::vector<uint8_t> grey8;

    ~Handles()
    {
        if (detector) {
            apriltag_detector_destroy(detector);
        }
        if (family) {
            tag36h11_destroy(family);
        }
    }
};

Reader::Reader(int width_px, int height_px, int decimate)
    : handles_(std::make_unique<Handles>())
{
    handles_->family = tag36h11_create();
    handles_->detector = apriltag_detector_create();
    handles_->grey8.resize(static_cast<size_t>(width_px) * static_cast<size_t>(height_px));
    if (!handles_->family || !handles_->detector) {
        throw std::bad_alloc();
    }
    apriltag_detector_add_family(handles_->detector, handles_->family);
    handles_->detector->quad_decimate = static_cast<float>(decimate);
    handles_->detector->nthreads = 1;
    inner_.reserve(OPMS_BAR_SQUARES);
    for (int id = 0; id < OPMS_BAR_SQUARES; id++) {
        inner_.push_back(cells_of(*handles_->family, id));
    }
}

Reader::~Reader() = default;

void Reader::read(const opms_image_t &image, std::vector<Sighting> &tags)
{
    tags.clear();
    if (std::min(image.width_px, image.height_px) <
        SMALLEST_PICTURE_PX * static_cast<int32_t>(handles_->detector->quad_decimate)) {
        return;
    }
    copy_grey8(image, handles_->grey8.data());
    image_u8_t picture = {image.width_px, image.height_px, image.width_px, handles_->grey8.data()};
    zarray_t *found = apriltag_detector_detect(handles_->detector, &picture);
    for (int i = 0; i < zarray_size(found); i++) {
        apriltag_detection_t *tag = nullptr;
        zarray_get(found, i, &tag);
        if (tag->id < OPMS_BAR_SQUARES) {
            tags.push_back(sighting_of(*tag));
        }
    }
    apriltag_detections_destroy(found);
}

} // namespace opms_tag
