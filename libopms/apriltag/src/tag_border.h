/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Measures the four sides of a tag's black border on the raw grey levels. */
#ifndef OPMS_TAG_BORDER_H
#define OPMS_TAG_BORDER_H

#include <vector>

#include <opms/bar.h>
#include <opms/types.h>

#include "blurred_step.h"
#include "tag_reader.h"

namespace opms_tag {

/** One measured side: a line through two points, whose errors are independent. */
struct BorderSide {
    bool measured;
    BlurredStep fit;
    opms_edge_t edges[2];
};

/** A tag with its measured sides. */
struct Border {
    BorderSide sides[4]; /**< order of opms_edge_t's side */
    Point corners_px[4]; /**< where the sides meet */
};

/** Measures borders; keeps its buffer between tags. */
class BorderMeter {
public:
    BorderMeter(const opms_lens_t &lens, const opms_image_t &image)
        : lens_(lens), image_(image)
    {
    }
    Border measure(const Sighting &tag, const InnerCells &inner);

private:
    struct Side;
    bool expect(const Point corners_px[4], int index, Side &side) const;
    void collect(const Side &side, const double white[CELLS]);
    void measure_side(const Side &side, const double white[CELLS], BorderSide &out);
    void write_edges(int square, int index, const Side &side, BorderSide &out) const;
    double level(int u, int v) const;

    const opms_lens_t &lens_;
    const opms_image_t &image_;
    std::vector<StepSample> samples_;
};

} // namespace opms_tag

#endif
