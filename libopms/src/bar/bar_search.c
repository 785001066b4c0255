/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/bar_search.h"

#include <math.h>

#include "bar/bar_code.h"
#include "bar/bar_settle.h"
#include "bar/chain.h"
#include "bar/follow.h"
#include "bar/labels.h"
#include "bar/search_plan.h"

/* Lines of the picture are searched, coarse to fine, for dark runs; a run becomes a quadrilateral,
 * a quadrilateral a row of squares, a row gets its labels, and the labelled row is refined on all
 * its edges. The first row that passes every test ends the search, so the cost of a picture with a
 * bar is that of a few lines and of the bar itself. */

#define SHORTEST_RUN_PX 4
#define WORK_OF_RUN 12    /* in pixel reads, as all that follow */
#define WORK_OF_SEED 3000
#define WORK_OF_ROW 60000

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
    const rejected_t r = {centre.x, centre.y, radius};
    if (d->rejected_count < REJECTED_MAX) {
        d->rejected[d->rejected_count++] = r;
    } else {
        d->rejected[d->rejected_next++ % REJECTED_MAX] = r;
    }
}

/** Cheap look before a contour is followed: is the run's middle dark, and bounded across the line?
 * Returns the run's length across the line, or 0. */
static int plausible(const view_t *view, const search_line_t *line, const dark_run_t *run,
                     int longest)
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

static int find_seed(opms_bar_detector_t *d, const search_line_t *line, const dark_run_t *run,
                     int across, quad_t *quad)
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

/** Grow, fit and label a row from a seed; rows that are not decided are grown as far as they go. */
static label_verdict_t label_row(opms_bar_detector_t *d, const quad_t *seed, float contrast,
                                 chain_t *chain, plane_map_t *map, double *shift_px,
                                 labels_t *labels)
{
    static const int most[2] = {9, CHAIN_MAX};
    label_verdict_t verdict = LABELS_NOT_A_BAR;
    for (int i = 0; i < 2; ++i) {
        const int grown =
            chain_grow(&d->view, seed, contrast, &d->limits, d->points, most[i], chain);
        if (grown < 3 || !chain_fit(chain, &d->local_lens, d->ray_limit, map, shift_px) ||
            chain->count < 3) {
            return LABELS_NOT_A_BAR;
        }
        d->work_left -= WORK_OF_ROW;
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
    const int a = chain.square[0].place, b = chain.square[chain.count - 1].place;
    const int first = labels.turn ? labels.offset - b : labels.offset + a;
    const int last = labels.turn ? labels.offset - a : labels.offset + b;
    const bar_start_t start = {map, shift_px, first, last, 0};
    return bar_settle(d, &start, contrast, roi, summary);
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
    d->work_left -= line->upright ? 3L * count : count;
    const int longest = (int)d->limits.longest_contour / 4;
    int cursor = 0;
    dark_run_t run;
    while (d->work_left > 0 &&
           line_next_run(d->line, count, contrast, SHORTEST_RUN_PX, longest, &cursor, &run)) {
        const int middle = line->from + run.middle;
        const float x = (float)(line->upright ? line->at : middle);
        const float y = (float)(line->upright ? middle : line->at);
        d->work_left -= WORK_OF_RUN + 4L * run.length;
        if (was_rejected(d, x, y)) {
            continue;
        }
        const int across = plausible(&d->view, line, &run, longest);
        if (!across) {
            continue;
        }
        d->work_left -= 8L * (run.length + across);
        quad_t seed;
        if (!find_seed(d, line, &run, across, &seed)) {
            continue;
        }
        d->work_left -= WORK_OF_SEED;
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

static int search_picture(opms_bar_detector_t *d, int contrast, int levels,
                          const opms_roi_t *roi, opms_bar_summary_t *summary)
{
    search_plan_t plan;
    search_plan_init(&plan, d->view.width, d->view.height, d->options.min_square_px);
    search_line_t line;
    while (d->work_left > 0 && search_plan_next(&plan, &line) && plan.level < levels) {
        if (search_line(d, &line, contrast, roi, summary)) {
            return 1;
        }
    }
    return 0;
}

void bar_search(opms_bar_detector_t *d, const opms_transform_t *hint, int least_contrast,
                const opms_roi_t *roi, opms_bar_summary_t *summary)
{
    /* A few lines for a bar that has most of the picture's contrast, as no soil has; then all for
     * bars with a good part of it, and all for those in the shade. */
    static const struct {
        int part, levels;
    } looks[3] = {{2, 2}, {5, SEARCH_LEVELS}, {16, SEARCH_LEVELS}};
    if (hint && follow_hint(d, hint, least_contrast, roi, summary)) {
        summary->followed = 1;
        return;
    }
    const int range = grey_range(d);
    for (int i = 0; i < 3 && !d->settled && summary->state != OPMS_BAR_LOCATED; ++i) {
        const int part = range / looks[i].part;
        const int contrast = part > least_contrast ? part : least_contrast;
        if (range >= least_contrast) {
            search_picture(d, contrast, looks[i].levels, roi, summary);
        }
    }
}
