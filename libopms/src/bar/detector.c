/* SPDX-License-Identifier: Apache-2.0 */
#include <opms/bar.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <opms/lens.h>

#include "bar/bar_code.h"
#include "bar/chain.h"
#include "bar/labels.h"
#include "bar/map_refine.h"
#include "bar/search_plan.h"
#include "base/fail.h"
#include "lens/lens_fast.h"

/* Lines of the picture are searched, coarse to fine, for dark runs; a run becomes a quadrilateral, a
 * quadrilateral a row of squares, a row gets its labels, and the labelled row is refined on all its
 * edges. The first row that passes every test ends the search, so the cost of a picture with a bar
 * is that of a few lines and of the bar itself. */

#define STAGE "bar"
#define BLUR_START_PX 0.85
#define SHORTEST_RUN_PX 4
#define REJECTED_MAX 128

/** A quadrilateral that was tried and is no square of a bar. */
typedef struct rejected {
    float x, y, radius;
} rejected_t;

struct opms_bar_detector {
    opms_lens_t lens;
    opms_bar_options_t options;
    double ray_limit;
    /* The picture at hand. */
    opms_lens_t local_lens; /* with the region's corner as the origin */
    view_t view;
    quad_limits_t limits;
    long traces_left;
    int settled; /* the bar is found and cannot be measured: no use to search on */
    int rejected_count;
    rejected_t rejected[REJECTED_MAX];
    /* Results. */
    uint32_t square_count, edge_count;
    opms_square_t squares[OPMS_BAR_SQUARES];
    opms_edge_t edges[OPMS_BAR_EDGES_MAX];
    /* Work space. */
    bar_fit_t fit;
    point_t points[QUAD_POINTS_MAX];
    uint16_t line[16384];
};

void opms_bar_options_init(opms_bar_options_t *options)
{
    if (options) {
        memset(options, 0, sizeof *options);
        options->struct_size = sizeof *options;
        options->min_square_px = 7;
    }
}

/** The largest radius of a ray inside the picture, with a little to spare. */
static double ray_limit_of(const opms_lens_t *lens)
{
    double most = 0;
    for (int i = 0; i <= 16; ++i) {
        const double u = lens->width_px * i / 16.0 - 0.5, v = lens->height_px * i / 16.0 - 0.5;
        const double border[4][2] = {{u, -0.5}, {u, lens->height_px - 0.5}, {-0.5, v}, {lens->width_px - 0.5, v}};
        for (int k = 0; k < 4; ++k) {
            double ray[2];
            if (opms_lens_unproject(lens, border[k], ray, NULL, NULL) == OPMS_OK) {
                most = fmax(most, hypot(ray[0], ray[1]));
            }
        }
    }
    return 1.03 * most;
}

opms_status_t opms_bar_detector_create(const opms_lens_t *lens, const opms_bar_options_t *options,
                                       opms_bar_detector_t **detector, opms_error_t *err)
{
    if (!detector) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "detector is NULL");
    }
    OPMS_TRY(opms_lens_check(lens, err));
    opms_bar_options_t chosen;
    opms_bar_options_init(&chosen);
    if (options) {
        if (options->struct_size < sizeof chosen.struct_size ||
            options->struct_size > sizeof chosen) {
            return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                             "options.struct_size is %u, this library knows up to %u",
                             (unsigned)options->struct_size, (unsigned)sizeof chosen);
        }
        memcpy(&chosen, options, options->struct_size);
    }
    if (chosen.min_square_px < 6 || chosen.min_square_px > 64) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "min_square_px is %d, allowed are 6 to 64",
                         (int)chosen.min_square_px);
    }
    if (!chosen.allocator.alloc != !chosen.allocator.free) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "allocator needs both alloc and free");
    }
    opms_bar_detector_t *fresh = chosen.allocator.alloc
        ? chosen.allocator.alloc(chosen.allocator.user, sizeof *fresh)
        : malloc(sizeof *fresh);
    if (!fresh) {
        return opms_fail(err, OPMS_ERR_MEMORY, STAGE, -1, "no memory for a detector (%zu bytes)",
                         sizeof *fresh);
    }
    memset(fresh, 0, sizeof *fresh);
    fresh->lens = *lens;
    fresh->options = chosen;
    fresh->ray_limit = ray_limit_of(lens);
    *detector = fresh;
    return OPMS_OK;
}

void opms_bar_detector_destroy(opms_bar_detector_t *detector)
{
    if (!detector) {
        return;
    }
    const opms_allocator_t allocator = detector->options.allocator;
    if (allocator.free) {
        allocator.free(allocator.user, detector);
    } else {
        free(detector);
    }
}

static opms_status_t check_image(const opms_bar_detector_t *d, const opms_image_t *image,
                                 opms_error_t *err)
{
    if (!image || !image->pixels) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL", image ? "image.pixels" : "image");
    }
    if (image->format != OPMS_PIXEL_GREY8 && image->format != OPMS_PIXEL_GREY16) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "image.format %d is unknown", (int)image->format);
    }
    if (image->width_px != d->lens.width_px || image->height_px != d->lens.height_px) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "image is %d x %d px, the lens is for %d x %d",
                         (int)image->width_px, (int)image->height_px, (int)d->lens.width_px,
                         (int)d->lens.height_px);
    }
    const ptrdiff_t size = image->format == OPMS_PIXEL_GREY16 ? 2 : 1;
    if (image->stride_bytes < image->width_px * size || image->stride_bytes % size != 0) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "image.stride_bytes is %td, a row of %d px needs %td (a multiple of %td)",
                         image->stride_bytes, (int)image->width_px, image->width_px * size, size);
    }
    if (size == 2 && (uintptr_t)image->pixels % 2 != 0) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "image.pixels is not aligned to 2 bytes");
    }
    if (image->format == OPMS_PIXEL_GREY8 && image->white_level > 255) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "image.white_level is %u, a grey8 picture has up to 255",
                         (unsigned)image->white_level);
    }
    return OPMS_OK;
}

static opms_status_t check_roi(const opms_image_t *image, const opms_roi_t *roi, opms_roi_t *whole,
                               opms_error_t *err)
{
    const opms_roi_t all = {0, 0, image->width_px, image->height_px};
    *whole = all;
    if (!roi || roi->width_px == 0 || roi->height_px == 0) {
        return OPMS_OK;
    }
    if (roi->x_px < 0 || roi->y_px < 0 || roi->width_px < 0 || roi->height_px < 0 ||
        roi->width_px > image->width_px - roi->x_px || roi->height_px > image->height_px - roi->y_px) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "roi %d,%d %d x %d is not inside the picture",
                         (int)roi->x_px, (int)roi->y_px, (int)roi->width_px, (int)roi->height_px);
    }
    *whole = *roi;
    return OPMS_OK;
}

static opms_status_t check_hint(const opms_transform_t *hint, opms_error_t *err)
{
    for (int i = 0; hint && i < 12; ++i) {
        if (!isfinite(i < 9 ? hint->R[i] : hint->t_m[i - 9])) {
            return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "hint holds a number that is not finite");
        }
    }
    return OPMS_OK;
}

/** Least contrast that a search asks for: a part of the grey range that a few lines see. */
static int grey_range(opms_bar_detector_t *d)
{
    int low = 1 << 16, high = 0;
    for (int i = 0; i < 8; ++i) {
        const search_line_t line = {0, (2 * i + 1) * d->view.height / 16, 0, d->view.width - 1};
        for (int x = line.from; x <= line.to; x += 3) {
            const int v = view_at(&d->view, x, line.at);
            low = v < low ? v : low;
            high = v > high ? v : high;
        }
    }
    return high - low;
}

static int was_rejected(const opms_bar_detector_t *d, float x, float y)
{
    for (int i = 0; i < d->rejected_count; ++i) {
        const rejected_t *r = &d->rejected[i];
        if (fabsf(x - r->x) < r->radius && fabsf(y - r->y) < r->radius) {
            return 1;
        }
    }
    return 0;
}

static void reject(opms_bar_detector_t *d, point_t centre, float radius)
{
    if (d->rejected_count < REJECTED_MAX) {
        const rejected_t r = {centre.x, centre.y, radius};
        d->rejected[d->rejected_count++] = r;
    }
}

/** Cheap look before a contour is followed: is the run's middle dark, and bounded across the line?
 * Returns the run's length across the line, or 0. */
static int plausible(const view_t *view, const search_line_t *line, const dark_run_t *run, int longest)
{
    const int middle = line->from + run->middle;
    const int x = line->upright ? line->at : middle, y = line->upright ? middle : line->at;
    const int half = (run->white + run->black) / 2;
    if (view_at(view, x, y) > run->black + (run->white - run->black) * 2 / 5) {
        return 0;
    }
    const int dx = line->upright, dy = !line->upright;
    int reach = run->length * 6;
    reach = reach < longest ? reach : longest;
    int across = 1;
    for (int way = -1; way <= 1; way += 2) {
        int px = x + way * dx, py = y + way * dy;
        while (px >= 0 && py >= 0 && px < view->width && py < view->height &&
               view_at(view, px, py) < half) {
            if (++across > reach) {
                return 0;
            }
            px += way * dx;
            py += way * dy;
        }
    }
    return across >= SHORTEST_RUN_PX && across * 6 >= run->length ? across : 0;
}

static int find_seed(opms_bar_detector_t *d, const search_line_t *line, const dark_run_t *run, int across,
                     quad_t *quad)
{
    static const float part[2] = {0.5f, 0.3f};
    const int middle = line->from + run->middle;
    const int x = line->upright ? line->at : middle, y = line->upright ? middle : line->at;
    /* A contour much longer than the two chords is grass or soil. */
    quad_limits_t limits = d->limits;
    const int longest = 5 * (run->length + across) + 20;
    limits.longest_contour = longest < limits.longest_contour ? longest : limits.longest_contour;
    for (int i = 0; i < 2; ++i) {
        const float threshold = (float)run->black + part[i] * (float)(run->white - run->black);
        if (quad_trace(&d->view, x, y, threshold, &limits, d->points, quad)) {
            return 1;
        }
    }
    return 0;
}

static void write_edges(opms_bar_detector_t *d, const opms_roi_t *roi)
{
    d->edge_count = 0;
    for (int i = 0; i < d->fit.count; ++i) {
        if (!d->fit.good[i]) {
            continue;
        }
        const stretch_t *s = &d->fit.stretch[i];
        opms_edge_t *edge = &d->edges[d->edge_count++];
        const double at = (s->side < 2 ? -1 : 1) * BAR_HALF_SQUARE_MM;
        const int along_y = s->side == 0 || s->side == 2;
        const double square_y = BAR_PITCH_MM * (s->square - OPMS_BAR_ORIGIN);
        edge->square = s->square;
        edge->side = s->side;
        edge->bar_m[0] = 1e-3 * (along_y ? at : (double)s->along_mm);
        edge->bar_m[1] = 1e-3 * (square_y + (along_y ? (double)s->along_mm : at));
        edge->px[0] = (double)s->predicted[0] + (double)(s->normal[0] * s->offset_px) + roi->x_px;
        edge->px[1] = (double)s->predicted[1] + (double)(s->normal[1] * s->offset_px) + roi->y_px;
        const double length = hypot((double)s->normal[0], (double)s->normal[1]);
        edge->normal[0] = (double)s->normal[0] / length;
        edge->normal[1] = (double)s->normal[1] / length;
        edge->sigma_px = (double)d->fit.sigma[i];
        edge->shift_gain = (double)d->fit.row[i][8];
    }
}

/** Corners from the map, for each square that has edges on two sides or more. */
static void write_squares(opms_bar_detector_t *d, const edge_scene_t *scene, const opms_roi_t *roi)
{
    unsigned sides[OPMS_BAR_SQUARES] = {0};
    uint32_t count[OPMS_BAR_SQUARES] = {0};
    for (uint32_t i = 0; i < d->edge_count; ++i) {
        sides[d->edges[i].square] |= 1u << d->edges[i].side;
        ++count[d->edges[i].square];
    }
    d->square_count = 0;
    for (int k = 0; k < OPMS_BAR_SQUARES; ++k) {
        if (!(sides[k] & 5u) || !(sides[k] & 10u)) {
            continue;
        }
        opms_square_t *square = &d->squares[d->square_count];
        square->index = k;
        square->edges = count[k];
        int all = 1;
        for (int c = 0; c < 4; ++c) {
            const double x = (c == 1 || c == 2) ? BAR_HALF_SQUARE_MM : -BAR_HALF_SQUARE_MM;
            const double y = BAR_PITCH_MM * (k - OPMS_BAR_ORIGIN) + (c >= 2 ? BAR_HALF_SQUARE_MM : -BAR_HALF_SQUARE_MM);
            all = all && plane_map_project(&scene->map, scene->lens, scene->ray_limit, x, y,
                                           square->corners_px[c], NULL);
            square->corners_px[c][0] += roi->x_px;
            square->corners_px[c][1] += roi->y_px;
        }
        d->square_count += (uint32_t)all;
    }
}

/** Read the labels once more from the refined map and all squares that were confirmed. */
static label_verdict_t check_labels(opms_bar_detector_t *d, const edge_scene_t *scene, double *margin)
{
    chain_t chain = {.count = 0};
    unsigned sides[OPMS_BAR_SQUARES] = {0};
    for (int i = 0; i < d->fit.count; ++i) {
        if (d->fit.good[i]) {
            sides[d->fit.stretch[i].square] |= 1u << d->fit.stretch[i].side;
        }
    }
    for (int k = 0; k < OPMS_BAR_SQUARES; ++k) {
        if ((sides[k] & 5u) && (sides[k] & 10u)) {
            chain.square[chain.count++].place = k - OPMS_BAR_ORIGIN;
        }
    }
    labels_t labels = {0, 0, 0};
    const label_verdict_t verdict = chain.count == 0 ? LABELS_NOT_A_BAR
        : labels_decide(&d->view, &chain, &scene->map, scene->lens, scene->ray_limit, &labels);
    *margin = labels.margin;
    if (verdict == LABELS_CERTAIN && (labels.turn || labels.offset != OPMS_BAR_ORIGIN)) {
        return LABELS_UNDECIDED;
    }
    return verdict;
}

static void summarise(const opms_bar_detector_t *d, const edge_scene_t *scene, double margin,
                      opms_bar_summary_t *summary)
{
    double pixels = 0, saturated = 0;
    for (int i = 0; i < d->fit.count; ++i) {
        if (d->fit.good[i]) {
            pixels += d->fit.stretch[i].pixels;
            saturated += d->fit.stretch[i].saturated;
        }
    }
    summary->state = OPMS_BAR_LOCATED;
    summary->square_count = d->square_count;
    summary->edge_count = d->edge_count;
    summary->label_margin = margin;
    summary->blur_px[0] = scene->blur_px[0];
    summary->blur_px[1] = scene->blur_px[1];
    summary->noise = (double)d->fit.noise;
    summary->contrast = (double)d->fit.contrast;
    summary->white_fraction_saturated = pixels > 0 ? fmin(1, 2 * saturated / pixels) : 0;
}

/** Grow, fit and label a row from a seed; rows that are not decided are grown as far as they go. */
static label_verdict_t label_row(opms_bar_detector_t *d, const quad_t *seed, float contrast, chain_t *chain,
                                 plane_map_t *map, double *shift_px, labels_t *labels)
{
    static const int most[2] = {9, CHAIN_MAX};
    label_verdict_t verdict = LABELS_NOT_A_BAR;
    for (int i = 0; i < 2; ++i) {
        const int grown = chain_grow(&d->view, seed, contrast, &d->limits, d->points, most[i], chain);
        if (grown < 3 || !chain_fit(chain, &d->local_lens, d->ray_limit, map, shift_px) || chain->count < 3) {
            return LABELS_NOT_A_BAR;
        }
        verdict = labels_decide(&d->view, chain, map, &d->local_lens, d->ray_limit, labels);
        if (verdict == LABELS_CERTAIN || grown < most[i]) {
            break;
        }
    }
    return verdict;
}

/** From a seed to the located bar; the state says how far it came. */
static opms_bar_state_t try_seed(opms_bar_detector_t *d, const quad_t *seed, float contrast,
                                 const opms_roi_t *roi, opms_bar_summary_t *summary)
{
    chain_t chain;
    plane_map_t map;
    double shift_px;
    labels_t labels = {0, 0, 0};
    const label_verdict_t verdict = label_row(d, seed, contrast, &chain, &map, &shift_px, &labels);
    if (verdict != LABELS_CERTAIN) {
        return verdict == LABELS_UNDECIDED ? OPMS_BAR_AMBIGUOUS : OPMS_BAR_ABSENT;
    }
    plane_map_relabel(&map, labels.turn, BAR_PITCH_MM * (labels.offset - OPMS_BAR_ORIGIN));
    edge_scene_t scene = {&d->view, &d->local_lens, d->ray_limit, map, shift_px, {1, 1},
                          {BLUR_START_PX, BLUR_START_PX}, {0, 0}, 0, 1, 1};
    const int a = chain.square[0].place, b = chain.square[chain.count - 1].place;
    const int first = labels.turn ? labels.offset - b : labels.offset + a;
    const int last = labels.turn ? labels.offset - a : labels.offset + b;
    const map_verdict_t refined = map_refine(&scene, first, last, contrast, &d->fit);
    if (refined != MAP_FIRM) {
        d->settled = refined == MAP_UNSURE;
        return refined == MAP_UNSURE ? OPMS_BAR_AMBIGUOUS : OPMS_BAR_ABSENT;
    }
    double margin = 0;
    const label_verdict_t again = check_labels(d, &scene, &margin);
    if (again != LABELS_CERTAIN) {
        return again == LABELS_UNDECIDED ? OPMS_BAR_AMBIGUOUS : OPMS_BAR_ABSENT;
    }
    write_edges(d, roi);
    write_squares(d, &scene, roi);
    summarise(d, &scene, margin, summary);
    return OPMS_BAR_LOCATED;
}

/** Search one line; 1 when the bar is found and there is nothing more to search for. */
static int search_line(opms_bar_detector_t *d, const search_line_t *line, int contrast,
                       const opms_roi_t *roi, opms_bar_summary_t *summary)
{
    const int count = line->to - line->from + 1;
    if (count < SHORTEST_RUN_PX) {
        return 0;
    }
    line_load(&d->view, line, d->line);
    const int longest = (int)d->limits.longest_contour / 4;
    int cursor = 0;
    dark_run_t run;
    while (line_next_run(d->line, count, contrast, SHORTEST_RUN_PX, longest, &cursor, &run)) {
        const int middle = line->from + run.middle;
        const float x = (float)(line->upright ? line->at : middle);
        const float y = (float)(line->upright ? middle : line->at);
        if (d->traces_left <= 0 || was_rejected(d, x, y)) {
            continue;
        }
        const int across = plausible(&d->view, line, &run, longest);
        if (!across) {
            continue;
        }
        --d->traces_left;
        quad_t seed;
        if (!find_seed(d, line, &run, across, &seed)) {
            continue;
        }
        const opms_bar_state_t state = try_seed(d, &seed, (float)contrast, roi, summary);
        if (state == OPMS_BAR_LOCATED) {
            return 1;
        }
        if (state == OPMS_BAR_AMBIGUOUS) {
            summary->state = state;
            if (d->settled) {
                return 1;
            }
        }
        reject(d, seed.centre, 0.4f * seed.shortest);
    }
    return 0;
}

static int search_picture(opms_bar_detector_t *d, int contrast, const opms_roi_t *roi,
                          opms_bar_summary_t *summary)
{
    search_plan_t plan;
    search_plan_init(&plan, d->view.width, d->view.height, d->options.min_square_px);
    search_line_t line;
    while (search_plan_next(&plan, &line)) {
        if (search_line(d, &line, contrast, roi, summary)) {
            return 1;
        }
    }
    return 0;
}

/** Search short lines through the places where the hint has squares. */
static int search_hint(opms_bar_detector_t *d, const opms_transform_t *hint, int contrast,
                       const opms_roi_t *roi, opms_bar_summary_t *summary)
{
    static const int order[] = {16, 8, 24, 12, 20, 4, 28, 0, 32, 10, 22, 14, 18, 6, 26, 2, 30};
    const double *R = hint->R;
    const int reach = (d->view.width + d->view.height) / 12;
    int tried = 0;
    for (size_t i = 0; i < sizeof order / sizeof order[0] && tried < 8; ++i) {
        const double p[3] = {-hint->t_m[0], OPMS_BAR_PITCH_M * (order[i] - OPMS_BAR_ORIGIN) - hint->t_m[1],
                             -hint->t_m[2]};
        const double z = R[2] * p[0] + R[5] * p[1] + R[8] * p[2];
        if (!(z > 1e-3)) {
            continue;
        }
        const double x = (R[0] * p[0] + R[3] * p[1] + R[6] * p[2]) / z;
        const double y = (R[1] * p[0] + R[4] * p[1] + R[7] * p[2]) / z;
        double u, v;
        if (!(x * x + y * y < d->ray_limit * d->ray_limit) ||
            !lens_project_ray(&d->local_lens, x, y, &u, &v) || !view_holds(&d->view, u, v, 2)) {
            continue;
        }
        ++tried;
        for (int upright = 0; upright < 2; ++upright) {
            const int middle = (int)(upright ? v : u), size = upright ? d->view.height : d->view.width;
            const search_line_t line = {upright, (int)(upright ? u : v), middle > reach ? middle - reach : 0,
                                        middle + reach < size ? middle + reach : size - 1};
            if (search_line(d, &line, contrast, roi, summary)) {
                return 1;
            }
        }
    }
    return 0;
}

static void begin(opms_bar_detector_t *d, const opms_image_t *image, const opms_roi_t *roi)
{
    opms_image_t part = *image;
    const ptrdiff_t size = image->format == OPMS_PIXEL_GREY16 ? 2 : 1;
    part.pixels = (const uint8_t *)image->pixels + roi->y_px * image->stride_bytes + roi->x_px * size;
    part.width_px = roi->width_px;
    part.height_px = roi->height_px;
    d->view = view_of(&part);
    d->local_lens = d->lens;
    d->local_lens.cx_px -= roi->x_px;
    d->local_lens.cy_px -= roi->y_px;
    const int longer = d->view.width > d->view.height ? d->view.width : d->view.height;
    d->limits.longest_contour = longer < QUAD_POINTS_MAX ? longer : QUAD_POINTS_MAX;
    d->limits.shortest_side = 5.f;
    d->traces_left = 4000 + (long)d->view.width * d->view.height / 400;
    d->rejected_count = 0;
    d->settled = 0;
    d->square_count = d->edge_count = 0;
}

opms_status_t opms_bar_detect(opms_bar_detector_t *detector, const opms_image_t *image,
                              const opms_roi_t *roi, const opms_transform_t *hint,
                              opms_bar_summary_t *summary, opms_error_t *err)
{
    if (!detector || !summary) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL", detector ? "summary" : "detector");
    }
    OPMS_TRY(check_image(detector, image, err));
    opms_roi_t whole;
    OPMS_TRY(check_roi(image, roi, &whole, err));
    OPMS_TRY(check_hint(hint, err));
    memset(summary, 0, sizeof *summary);
    begin(detector, image, &whole);
    const int range = grey_range(detector);
    const int floor_grey = 8 * detector->view.white_level / 255;
    const int least = image->format == OPMS_PIXEL_GREY8 ? floor_grey : (floor_grey < 32 ? floor_grey : 32);
    /* Once for bars with a good part of the picture's contrast, once for those in the shade. */
    static const int part[2] = {5, 16};
    for (int i = 0; i < 2; ++i) {
        const int contrast = range / part[i] > least ? range / part[i] : least;
        if (hint && search_hint(detector, hint, contrast, &whole, summary)) {
            summary->followed = 1;
            break;
        }
        if (range >= least && search_picture(detector, contrast, &whole, summary)) {
            break;
        }
    }
    return OPMS_OK;
}

const opms_square_t *opms_bar_squares(const opms_bar_detector_t *detector, uint32_t *count)
{
    if (count) {
        *count = detector ? detector->square_count : 0;
    }
    return detector ? detector->squares : NULL;
}

const opms_edge_t *opms_bar_edges(const opms_bar_detector_t *detector, uint32_t *count)
{
    if (count) {
        *count = detector ? detector->edge_count : 0;
    }
    return detector ? detector->edges : NULL;
}
