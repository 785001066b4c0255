/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/bar_settle.h"

#include "bar/bar_code.h"
#include "bar/bar_report.h"
#include "bar/chain.h"
#include "bar/labels.h"

#define BLUR_START_PX 0.85

/** All squares with good stretches on a side along Y and on one along X. */
static void confirmed_squares(const bar_fit_t *fit, chain_t *chain)
{
    unsigned sides[OPMS_BAR_SQUARES] = {0};
    for (int i = 0; i < fit->count; ++i) {
        if (fit->good[i]) {
            sides[fit->stretch[i].square] |= 1u << fit->stretch[i].side;
        }
    }
    chain->count = 0;
    for (int k = 0; k < OPMS_BAR_SQUARES; ++k) {
        if ((sides[k] & 5u) && (sides[k] & 10u)) {
            chain->square[chain->count++].place = k - OPMS_BAR_ORIGIN;
        }
    }
}

/** Read the labels once more from the refined map and all squares that were confirmed. */
static label_verdict_t check_labels(const opms_bar_detector_t *d, const edge_scene_t *scene,
                                    int squares_least, double *margin)
{
    chain_t chain;
    confirmed_squares(&d->fit, &chain);
    labels_t labels = {0, 0, 0};
    const label_verdict_t verdict = chain.count == 0 || chain.count < squares_least
        ? LABELS_NOT_A_BAR
        : labels_decide(&d->view, &chain, &scene->map, scene->lens, scene->ray_limit, &labels);
    *margin = labels.margin;
    if (verdict == LABELS_CERTAIN && (labels.turn || labels.offset != OPMS_BAR_ORIGIN)) {
        return LABELS_UNDECIDED;
    }
    return verdict;
}

opms_bar_state_t bar_settle(opms_bar_detector_t *d, const bar_start_t *start, float contrast,
                            const opms_roi_t *roi, opms_bar_summary_t *summary)
{
    edge_scene_t scene = {.view = &d->view,
                          .lens = &d->local_lens,
                          .ray_limit = d->ray_limit,
                          .map = start->map,
                          .shift_px = start->shift_px,
                          .shift_gain = {1, 1},
                          .blur_px = {BLUR_START_PX, BLUR_START_PX},
                          .still_px = BLUR_START_PX,
                          .clip = UNCUT,
                          .ground_drop = 0.5,
                          .cut_level = (double)d->view.white_level,
                          .kernel = d->kernel};
    const map_verdict_t refined = map_refine(&scene, start->first, start->last, contrast, &d->fit);
    if (refined != MAP_FIRM) {
        d->settled = refined == MAP_UNSURE;
        return refined == MAP_UNSURE ? OPMS_BAR_AMBIGUOUS : OPMS_BAR_ABSENT;
    }
    double margin = 0;
    const label_verdict_t again = check_labels(d, &scene, start->squares_least, &margin);
    if (again != LABELS_CERTAIN) {
        return again == LABELS_UNDECIDED ? OPMS_BAR_AMBIGUOUS : OPMS_BAR_ABSENT;
    }
    bar_report(d, &scene, roi, margin, summary);
    return OPMS_BAR_LOCATED;
}
