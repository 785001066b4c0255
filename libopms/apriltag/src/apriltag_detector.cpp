/* SPDX-License-Identifier: Apache-2.0 */
#include <opms/apriltag.h>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <vector>

#include <opms/lens.h>

#include "tag_border.h"
#include "tag_labels.h"
#include "tag_reader.h"

namespace {

using namespace opms_tag;

constexpr int DECIMATE_MAX = 4;
/** Distance of two codes of family 36h11, and the odds of reading one of its bits right. */
constexpr double CODE_DISTANCE = 11.0, BIT_ODDS = 19.0;
/** A side whose levels scatter this much more than those of the others is covered in part. */
constexpr double NOISE_FACTOR = 4.0;
constexpr double SATURATED = 0.996; /* of the white level */

__attribute__((format(printf, 3, 4))) opms_status_t fail(opms_error_t *err, opms_status_t code,
                                                         const char *format, ...)
{
    if (err) {
        err->code = code;
        err->index = -1;
        std::snprintf(err->stage, sizeof err->stage, "apriltag");
        va_list args;
        va_start(args, format);
        std::vsnprintf(err->message, sizeof err->message, format, args);
        va_end(args);
    }
    return code;
}

double median(std::vector<double> &values)
{
    if (values.empty()) {
        return 0.0;
    }
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

opms_status_t check_image(const opms_lens_t &lens, const opms_image_t *image, opms_error_t *err)
{
    if (!image || !image->pixels) {
        return fail(err, OPMS_ERR_ARG, image ? "image->pixels is NULL" : "image is NULL");
    }
    /* C callers can put any number in an enum, which C++ may not even load as one. */
    int format = 0;
    static_assert(sizeof format == sizeof image->format, "an enum is an int");
    std::memcpy(&format, &image->format, sizeof format);
    if (format != OPMS_PIXEL_GREY8 && format != OPMS_PIXEL_GREY16) {
        return fail(err, OPMS_ERR_ARG, "image->format %d is unknown", format);
    }
    if (image->width_px != lens.width_px || image->height_px != lens.height_px) {
        return fail(err, OPMS_ERR_ARG, "image is %d x %d px, the lens is for %d x %d",
                    image->width_px, image->height_px, lens.width_px, lens.height_px);
    }
    const std::ptrdiff_t pixel_bytes = format == OPMS_PIXEL_GREY8 ? 1 : 2;
    if (image->stride_bytes < pixel_bytes * image->width_px) {
        return fail(err, OPMS_ERR_ARG, "image->stride_bytes %td is less than a row's %td",
                    image->stride_bytes, pixel_bytes * image->width_px);
    }
    if (pixel_bytes == 2 && (reinterpret_cast<uintptr_t>(image->pixels) % 2 != 0 ||
                             image->stride_bytes % 2 != 0)) {
        return fail(err, OPMS_ERR_ARG, "rows of a GREY16 image must be 2-byte aligned");
    }
    return OPMS_OK;
}

double white_level(const opms_image_t &image)
{
    if (image.white_level) {
        return image.white_level;
    }
    return image.format == OPMS_PIXEL_GREY8 ? 255.0 : 65535.0;
}

} // namespace

struct opms_apriltag_detector {
    opms_apriltag_detector(const opms_lens_t &lens_, int decimate)
        : lens(lens_), reader(lens_.width_px, lens_.height_px, decimate)
    {
    }

    void detect(const opms_image_t &image, opms_bar_summary_t &summary);

    opms_lens_t lens;
    Reader reader;
    std::vector<Sighting> tags;
    std::vector<Border> borders; /**< of each of tags */
    std::vector<opms_square_t> squares;
    std::vector<opms_edge_t> edges;

private:
    double usable_noise() const;
    void collect(double noise_limit);
    void summarise(const opms_image_t &image, double noise_limit,
                   opms_bar_summary_t &summary) const;
};

double opms_apriltag_detector::usable_noise() const
{
    std::vector<double> noises;
    for (const Border &border : borders) {
        for (const BorderSide &side : border.sides) {
            if (side.measured) {
                noises.push_back(side.fit.noise);
            }
        }
    }
    return NOISE_FACTOR * median(noises);
}

void opms_apriltag_detector::collect(double noise_limit)
{
    for (size_t i = 0; i < tags.size(); i++) {
        opms_square_t square = {tags[i].id, 0, {}};
        for (const BorderSide &side : borders[i].sides) {
            if (side.measured && side.fit.noise <= noise_limit) {
                edges.insert(edges.end(), side.edges, side.edges + 2);
                square.edges += 2;
            }
        }
        for (int c = 0; c < 4; c++) {
            square.corners_px[c][0] = borders[i].corners_px[c].x;
            square.corners_px[c][1] = borders[i].corners_px[c].y;
        }
        squares.push_back(square);
    }
}

void opms_apriltag_detector::summarise(const opms_image_t &image, double noise_limit,
                                       opms_bar_summary_t &summary) const
{
    std::vector<double> blurs[2], contrasts;
    double variance = 0.0;
    size_t saturated = 0;
    for (const Border &border : borders) {
        for (int i = 0; i < 4; i++) {
            const BorderSide &side = border.sides[i];
            if (side.measured && side.fit.noise <= noise_limit) {
                /* Sides 1 and 3 run along X, 0 and 2 along Y. */
                blurs[i % 2 == 1 ? 0 : 1].push_back(side.fit.blur_px);
                contrasts.push_back(side.fit.step);
                variance += side.fit.noise * side.fit.noise;
                saturated += side.fit.black + side.fit.step >= SATURATED * white_level(image);
            }
        }
    }
    for (const Sighting &tag : tags) {
        summary.label_margin += (CODE_DISTANCE - 2.0 * tag.hamming) * std::log(BIT_ODDS);
    }
    summary.square_count = static_cast<uint32_t>(squares.size());
    summary.edge_count = static_cast<uint32_t>(edges.size());
    if (!contrasts.empty()) {
        const double sides = static_cast<double>(contrasts.size());
        summary.noise = std::sqrt(variance / sides);
        summary.white_fraction_saturated = static_cast<double>(saturated) / sides;
        summary.contrast = median(contrasts);
        summary.blur_px[0] = median(blurs[0]);
        summary.blur_px[1] = median(blurs[1]);
    }
}

void opms_apriltag_detector::detect(const opms_image_t &image, opms_bar_summary_t &summary)
{
    borders.clear();
    squares.clear();
    edges.clear();
    reader.read(image, tags);
    summary.state = tags_of_one_bar(lens, tags);
    BorderMeter meter(lens, image);
    for (const Sighting &tag : tags) {
        borders.push_back(meter.measure(tag, reader.inner_cells(tag.id)));
    }
    const double noise_limit = usable_noise();
    collect(noise_limit);
    summarise(image, noise_limit, summary);
}

void opms_apriltag_options_init(opms_apriltag_options_t *options)
{
    *options = {sizeof *options, 1};
}

opms_status_t opms_apriltag_detector_create(const opms_lens_t *lens,
                                            const opms_apriltag_options_t *options,
                                            opms_apriltag_detector_t **detector, opms_error_t *err)
{
    opms_apriltag_options_t used;
    opms_apriltag_options_init(&used);
    if (!detector) {
        return fail(err, OPMS_ERR_ARG, "detector is NULL");
    }
    const opms_status_t status = opms_lens_check(lens, err);
    if (status != OPMS_OK) {
        return status;
    }
    if (options) {
        if (options->struct_size < sizeof used) {
            return fail(err, OPMS_ERR_ARG,
                        "options->struct_size %u is too small; use opms_apriltag_options_init()",
                        options->struct_size);
        }
        used.decimate = options->decimate;
    }
    if (used.decimate < 1 || used.decimate > DECIMATE_MAX) {
        return fail(err, OPMS_ERR_ARG, "options->decimate %d is not 1 to %d", used.decimate,
                    DECIMATE_MAX);
    }
    try {
        *detector = new opms_apriltag_detector(*lens, used.decimate);
    } catch (const std::bad_alloc &) {
        return fail(err, OPMS_ERR_MEMORY, "no memory for a detector");
    } catch (const std::exception &cause) {
        return fail(err, OPMS_ERR_INTERNAL, "%s", cause.what());
    }
    return OPMS_OK;
}

void opms_apriltag_detector_destroy(opms_apriltag_detector_t *detector)
{
    delete detector;
}

opms_status_t opms_apriltag_detect(opms_apriltag_detector_t *detector, const opms_image_t *image,
                                   opms_bar_summary_t *summary, opms_error_t *err)
{
    if (!detector || !summary) {
        return fail(err, OPMS_ERR_ARG, "%s is NULL", detector ? "summary" : "detector");
    }
    const opms_status_t status = check_image(detector->lens, image, err);
    if (status != OPMS_OK) {
        return status;
    }
    opms_bar_summary_t found = {};
    try {
        detector->detect(*image, found);
    } catch (const std::bad_alloc &) {
        return fail(err, OPMS_ERR_MEMORY, "no memory to read the tags");
    } catch (const std::exception &cause) {
        return fail(err, OPMS_ERR_INTERNAL, "%s", cause.what());
    }
    *summary = found;
    return OPMS_OK;
}

const opms_square_t *opms_apriltag_squares(const opms_apriltag_detector_t *detector,
                                           uint32_t *count)
{
    if (count) {
        *count = detector ? static_cast<uint32_t>(detector->squares.size()) : 0;
    }
    return detector ? detector->squares.data() : nullptr;
}

const opms_edge_t *opms_apriltag_edges(const opms_apriltag_detector_t *detector, uint32_t *count)
{
    if (count) {
        *count = detector ? static_cast<uint32_t>(detector->edges.size()) : 0;
    }
    return detector ? detector->edges.data() : nullptr;
}
