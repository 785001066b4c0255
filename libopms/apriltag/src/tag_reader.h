/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The one place that calls libapriltag: a picture in, sightings of tags in our conventions out. */
#ifndef OPMS_TAG_READER_H
#define OPMS_TAG_READER_H

#include <memory>
#include <vector>

#include <opms/types.h>

#include "tag_plane.h"

namespace opms_tag {

constexpr int CELLS = 8; /**< cells along a side, the black border's included */

/** A tag that libapriltag read. */
struct Sighting {
    int id;
    int hamming;        /**< wrong bits that its code corrected */
    double margin;      /**< how far grey levels of its bits lie from the threshold */
    Point corners_px[4]; /**< order of opms_square_t, (0, 0) the centre of the top left pixel */
};

/** Cells just inside the black border, along each side: 1 white, 0 black.
 *
 * Sides 0 and 2 run with +Y, sides 1 and 3 with +X of the bar. */
struct InnerCells {
    double white[4][CELLS];
};

/** Holds libapriltag's detector and a copy of the picture. Throws std::bad_alloc. */
class Reader {
public:
    Reader(int width_px, int height_px, int decimate);
    ~Reader();
    Reader(const Reader &) = delete;
    Reader &operator=(const Reader &) = delete;

    /** Tags of the bar (ids 0 to 32) in the picture, in no order. */
    void read(const opms_image_t &image, std::vector<Sighting> &tags);
    const InnerCells &inner_cells(int id) const { return inner_[static_cast<size_t>(id)]; }

private:
    struct Handles;
    std::unique_ptr<Handles> handles_;
    std::vector<InnerCells> inner_;
};

} // namespace opms_tag

#endif
