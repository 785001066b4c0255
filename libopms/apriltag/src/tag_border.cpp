/* SPDX-License-Identifier: Apache-2.0 */
/* A side is expected between two corners, bent as the lens bends it. The grey levels in a band
 * about it are fitted by a blurred step; the band ends before the corners and before anything that
 * the model does not know: the second row of bits inside, the white's end outside. Done twice, the
 * second time from the corners that the first fit gives. */
#include "tag_border.h"

#include <algorithm>
#include <cmath>

#include <opms/lens.h>

namespace opms_tag {
namespace {

/** First and last corner of each side, in the direction of InnerCells. */
constexpr int SIDE_CORNERS[4][2] = {{0, 3}, {0, 1}, {1, 2}, {3, 2}};
/** The side opposite. */
constexpr int OPPOSITE[4] = {2, 3, 0, 1};
/** Sides that meet in each corner. */
constexpr int CORNER_SIDES[4][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};

constexpr double BAND_PX = 3.5;          /* widest reach to either side of the edge */
constexpr double BAND_INSIDE_CELLS = 1.0; /* the inner cell's edge is modelled, what follows not */
constexpr double BAND_OUTSIDE_CELLS = 1.4; /* of two cells of white */
constexpr double CORNER_CLIP_PX = 2.0;
constexpr double CORNER_CLIP_PART = 0.15; /* of the side, where it is short */
constexpr double CELL_SMOOTHING_PX = 2.6; /* between bits: a box as wide as a blur of 0.75 px */
constexpr double SIDE_MIN_PX = 8.0;

/** Mean of the cells over u +- half, in cells along the side. */
double mean_of_cells(const double white[CELLS], double u, double half)
{
    double sum = 0.0;
    for (int j = 0; j < CELLS; j++) {
        const double overlap = std::min(u + half, j + 1.0) - std::max(u - half, double(j));
        sum += white[j] * std::max(0.0, overlap);
    }
    return sum / (2.0 * half);
}

/** Where two lines, each through a point along a direction, meet. */
Point meet(Point a, Point along_a, Point b, Point along_b)
{
    const double cross = along_a.x * along_b.y - along_a.y * along_b.x;
    const Point ab = b - a;
    const double s = (ab.x * along_b.y - ab.y * along_b.x) / cross;
    return a + s * along_a;
}

} // namespace

/** An expected side: its chord and how far the lens bends its middle off the chord. */
struct BorderMeter::Side {
    Point middle_px, along, out;
    double half_px;   /**< half the chord */
    double usable_px; /**< half of what is measured */
    double bend_px;   /**< of the middle, outwards */
    double cell_px;   /**< width of the black border */

    double bend_at(double along_px) const
    {
        const double t = along_px / half_px;
        return bend_px * (1.0 - t * t);
    }
};

double BorderMeter::level(int u, int v) const
{
    const char *row = static_cast<const char *>(image_.pixels) + v * image_.stride_bytes;
    return image_.format == OPMS_PIXEL_GREY8
               ? static_cast<double>(reinterpret_cast<const uint8_t *>(row)[u])
               : static_cast<double>(reinterpret_cast<const uint16_t *>(row)[u]);
}

bool BorderMeter::expect(const Point corners_px[4], int index, Side &side) const
{
    const Point a = corners_px[SIDE_CORNERS[index][0]], b = corners_px[SIDE_CORNERS[index][1]];
    const int *far = SIDE_CORNERS[OPPOSITE[index]];
    const Point far_middle = 0.5 * (corners_px[far[0]] + corners_px[far[1]]);
    side.half_px = 0.5 * length(b - a);
    if (!(2.0 * side.half_px >= SIDE_MIN_PX)) {
        return false;
    }
    side.middle_px = 0.5 * (a + b);
    side.along = (0.5 / side.half_px) * (b - a);
    side.out = {-side.along.y, side.along.x};
    double across_px = dot(side.out, side.middle_px - far_middle);
    if (across_px < 0.0) {
        side.out = -1.0 * side.out;
        across_px = -across_px;
    }
    side.cell_px = across_px / CELLS;
    side.usable_px =
        side.half_px - std::min(CORNER_CLIP_PX, 2.0 * CORNER_CLIP_PART * side.half_px);

    /* A straight side is straight in rays: its middle there, brought to the picture, is bent. */
    double ray_a[2], ray_b[2], middle_px[2];
    const double px_a[2] = {a.x, a.y}, px_b[2] = {b.x, b.y};
    if (opms_lens_unproject(&lens_, px_a, ray_a, nullptr, nullptr) != OPMS_OK ||
        opms_lens_unproject(&lens_, px_b, ray_b, nullptr, nullptr) != OPMS_OK) {
        return false;
    }
    const double middle[3] = {0.5 * (ray_a[0] + ray_b[0]), 0.5 * (ray_a[1] + ray_b[1]), 1.0};
    if (opms_lens_project(&lens_, middle, middle_px, nullptr, nullptr, nullptr) != OPMS_OK) {
        return false;
    }
    side.bend_px = dot(side.out, Point{middle_px[0], middle_px[1]} - side.middle_px);
    return side.cell_px > 1.0;
}

void BorderMeter::collect(const Side &side, const double white[CELLS])
{
    samples_.clear();
    const double inside = std::min(BAND_PX, BAND_INSIDE_CELLS * side.cell_px);
    const double outside = std::min(BAND_PX, BAND_OUTSIDE_CELLS * side.cell_px);
    const double reach = std::max(inside, outside) + std::fabs(side.bend_px);
    const double reach_u = std::fabs(side.along.x) * side.usable_px + std::fabs(side.out.x) * reach;
    const double reach_v = std::fabs(side.along.y) * side.usable_px + std::fabs(side.out.y) * reach;
    const int u0 = std::max(0, static_cast<int>(std::ceil(side.middle_px.x - reach_u)));
    const int v0 = std::max(0, static_cast<int>(std::ceil(side.middle_px.y - reach_v)));
    const int u1 = std::min(image_.width_px - 1,
                            static_cast<int>(std::floor(side.middle_px.x + reach_u)));
    const int v1 = std::min(image_.height_px - 1,
                            static_cast<int>(std::floor(side.middle_px.y + reach_v)));
    const double cell_along_px = 2.0 * side.half_px / CELLS;
    const double smoothing = 0.5 * CELL_SMOOTHING_PX / cell_along_px;
    for (int v = v0; v <= v1; v++) {
        for (int u = u0; u <= u1; u++) {
            const Point p = Point{double(u), double(v)} - side.middle_px;
            const double along_px = dot(p, side.along);
            const double out_px = dot(p, side.out) - side.bend_at(along_px);
            if (std::fabs(along_px) <= side.usable_px && out_px >= -inside && out_px <= outside) {
                const double cell = (along_px + side.half_px) / cell_along_px;
                samples_.push_back(
                    {along_px, out_px, mean_of_cells(white, cell, smoothing), level(u, v)});
            }
        }
    }
}

void BorderMeter::measure_side(const Side &side, const double white[CELLS], BorderSide &out)
{
    collect(side, white);
    out.measured = fit_blurred_step(samples_, side.cell_px, out.fit);
}

/** Two points at +- usable / sqrt(3): there the errors of a line fitted to evenly spread pixels are
 * independent of each other, so that the two carry what the line says and no more. */
void BorderMeter::write_edges(int square, int index, const Side &side, BorderSide &out) const
{
    const Point a_m = tag_corner_m(square, SIDE_CORNERS[index][0]);
    const Point b_m = tag_corner_m(square, SIDE_CORNERS[index][1]);
    for (int i = 0; i < 2; i++) {
        const double along_px = (i ? 1.0 : -1.0) * side.usable_px / std::sqrt(3.0);
        const double t = 0.5 * (1.0 + along_px / side.half_px);
        const double off_px =
            out.fit.offset_px + out.fit.slope * along_px + side.bend_at(along_px);
        const Point px = side.middle_px + along_px * side.along + off_px * side.out;
        const double slope =
            out.fit.slope - 2.0 * side.bend_px * along_px / (side.half_px * side.half_px);
        const Point normal = (1.0 / std::hypot(1.0, slope)) * (side.out - slope * side.along);
        const Point bar_m = (1.0 - t) * a_m + t * b_m;
        const double sigma_px =
            std::hypot(out.fit.sigma_offset_px, along_px * out.fit.sigma_slope);
        out.edges[i] = {square,   index, {bar_m.x, bar_m.y}, {px.x, px.y}, {normal.x, normal.y},
                        sigma_px, 1.0};
    }
}

Border BorderMeter::measure(const Sighting &tag, const InnerCells &inner)
{
    Border border = {};
    std::copy_n(tag.corners_px, 4, border.corners_px);
    for (int pass = 0; pass < 2; pass++) {
        Side sides[4];
        Point on_side[4], along[4];
        for (int i = 0; i < 4; i++) {
            BorderSide &out = border.sides[i];
            out.measured = false;
            if (!expect(border.corners_px, i, sides[i])) {
                return border;
            }
            measure_side(sides[i], inner.white[i], out);
            on_side[i] = sides[i].middle_px;
            along[i] = sides[i].along;
            if (out.measured) {
                on_side[i] = on_side[i] + out.fit.offset_px * sides[i].out;
                along[i] = along[i] + out.fit.slope * sides[i].out;
                write_edges(tag.id, i, sides[i], out);
            }
        }
        for (int i = 0; i < 4; i++) {
            const int a = CORNER_SIDES[i][0], b = CORNER_SIDES[i][1];
            border.corners_px[i] = meet(on_side[a], along[a], on_side[b], along[b]);
        }
    }
    return border;
}

} // namespace opms_tag
