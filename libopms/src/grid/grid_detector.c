/* SPDX-License-Identifier: Apache-2.0 */
/* The handle, and the order of the steps. */
#include <string.h>

#include "base/fail.h"
#include "base/memory.h"
#include "grid/grid_label.h"
#include "grid/grid_seed.h"
#include "grid/grid_spread.h"
#include "grid/node_fit.h"
#include "grid/node_scatter.h"
#include "image/image_check.h"

#define STAGE "grid"
#define SEEDS_ACROSS 13    /* places of the picture where a cell is looked for, each way */
#define NODES_LEAST 25     /* of a grid: fewer may be chance */
#define NODES_ENOUGH 60    /* so many need no other seed */
#define TRIES_MOST 12      /* seeds that found a cell but no grid, or a small one */

void opms_grid_options_init(opms_grid_options_t *options)
{
    memset(options, 0, sizeof *options);
    options->struct_size = sizeof *options;
    options->min_pitch_px = 9.0;
}

static opms_status_t check_options(const opms_grid_options_t *options, opms_error_t *err)
{
    if (options->struct_size != sizeof *options) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "options->struct_size is %u: fill in by opms_grid_options_init()",
                         (unsigned)options->struct_size);
    }
    if (options->width_px < 16 || options->width_px > 16384 || options->height_px < 16 ||
        options->height_px > 16384) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "pictures of %d x %d, not 16 to 16384 px",
                         (int)options->width_px, (int)options->height_px);
    }
    if (!(options->min_pitch_px >= 8.0) || options->min_pitch_px > 100.0) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "min_pitch_px is %g, allowed are 8 to 100",
                         options->min_pitch_px);
    }
    return opms_check_allocator(&options->allocator, STAGE, err);
}

opms_status_t opms_grid_detector_create(const opms_grid_options_t *options,
                                        opms_grid_detector_t **detector, opms_error_t *err)
{
    if (!options || !detector) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL",
                         options ? "detector" : "options");
    }
    OPMS_TRY(check_options(options, err));
    opms_grid_detector_t *fresh = opms_take(&options->allocator, sizeof *fresh);
    if (!fresh) {
        return opms_fail(err, OPMS_ERR_MEMORY, STAGE, -1, "no memory for a detector (%zu bytes)",
                         sizeof *fresh);
    }
    fresh->options = *options;
    *detector = fresh;
    return OPMS_OK;
}

void opms_grid_detector_destroy(opms_grid_detector_t *detector)
{
    if (detector) {
        opms_give_back(&detector->options.allocator, detector);
    }
}

/* The k-th place to look at: rings around the picture's middle, the nearest first. */
static vec2_t seed_place(const opms_grid_detector_t *d, int k)
{
    int x = 0, y = 0, step_x = 0, step_y = -1; /* a square spiral */
    for (int i = 0; i < k; ++i) {
        if (x == y || (x < 0 && x == -y) || (x > 0 && x == 1 - y)) {
            const int turned = step_x;
            step_x = -step_y;
            step_y = turned;
        }
        x += step_x;
        y += step_y;
    }
    const vec2_t place = {((float)x / SEEDS_ACROSS + 0.5f) * (float)d->view.width,
                          ((float)y / SEEDS_ACROSS + 0.5f) * (float)d->view.height};
    return place;
}

/* Look for cells until nodes spread from one; the largest spread wins. */
static uint32_t find_nodes(opms_grid_detector_t *d)
{
    grid_cell_t cell, best_cell;
    uint32_t best = 0, last = 0;
    int tries = 0;
    for (int k = 0; k < SEEDS_ACROSS * SEEDS_ACROSS && tries < TRIES_MOST; ++k) {
        /* A place may lie on a line: look beside it, too. */
        const vec2_t place = seed_place(d, k);
        const float aside = 0.4f * (float)d->options.min_pitch_px;
        const vec2_t beside = {place.x + aside, place.y + 0.7f * aside};
        if (!find_cell(&d->view, place, 0.8f * (float)d->options.min_pitch_px, &cell) &&
            !find_cell(&d->view, beside, 0.8f * (float)d->options.min_pitch_px, &cell)) {
            continue;
        }
        ++tries;
        last = spread_nodes(d, &cell);
        if (last > best) {
            best = last;
            best_cell = cell;
        }
        if (best >= NODES_ENOUGH) {
            break;
        }
    }
    if (best >= NODES_LEAST && best != last) {
        spread_nodes(d, &best_cell);
    }
    return best;
}

/* The marker lies beside two arms of the centre node and would pull them. */
static void mend_centre(opms_grid_detector_t *d, const lattice_label_t *label)
{
    unsigned arms = 0;
    for (int row = 0; row < 2; ++row) {
        const int x = label->turn[2 * row], y = label->turn[2 * row + 1];
        arms |= x > 0 ? ARM_PLUS_I : x < 0 ? ARM_MINUS_I : y > 0 ? ARM_PLUS_J : ARM_MINUS_J;
    }
    refit_node(d, label->origin[0], label->origin[1], arms);
}

opms_status_t opms_grid_detect(opms_grid_detector_t *detector, const opms_image_t *image,
                               opms_grid_summary_t *summary, opms_error_t *err)
{
    if (!detector || !summary) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL",
                         detector ? "summary" : "detector");
    }
    OPMS_TRY(image_check(image, detector->options.width_px, detector->options.height_px, "detector",
                         STAGE, err));
    memset(summary, 0, sizeof *summary);
    detector->node_count = 0;
    detector->view = view_of(image);
    if (find_nodes(detector) < NODES_LEAST) {
        return OPMS_OK;
    }
    fit_nodes(detector);
    lattice_label_t label;
    const int certain = label_lattice(detector, &label);
    if (certain) {
        mend_centre(detector, &label);
    }
    straighten_nodes(detector);
    hold_sigmas_to_scatter(detector);
    if (detector->found < NODES_LEAST || !write_nodes(detector, &label, certain)) {
        return OPMS_OK;
    }
    summary->state = certain ? OPMS_GRID_LABELLED : OPMS_GRID_UNLABELLED;
    summary->node_count = detector->node_count;
    summary->noise = (double)detector->noise;
    summary->contrast = (double)detector->contrast;
    summary->blur_px = (double)detector->blur;
    summary->marker_margin = (double)label.margin;
    return OPMS_OK;
}

const opms_node_t *opms_grid_nodes(const opms_grid_detector_t *detector, uint32_t *count)
{
    if (count) {
        *count = detector ? detector->node_count : 0;
    }
    return detector ? detector->nodes : NULL;
}
