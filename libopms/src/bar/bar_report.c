/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/bar_report.h"

#include <math.h>

#include "bar/bar_code.h"
#include "bar/picture_shape.h"

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
        const double u = (double)s->normal[0], v = (double)s->normal[1];
        const double per_length = 1 / sqrt(u * u + v * v);
        edge->normal[0] = u * per_length;
        edge->normal[1] = v * per_length;
        edge->sigma_px = (double)d->fit.sigma[i];
        edge->shift_gain = (double)d->fit.shift_gain[i];
    }
}

/** Corners from the map, for each square with edges of which a side along X and one along Y are
 * seen. Grass over a side may leave nothing of it to be measured by, and the square is still there:
 * were it one only with good edges on both, a little noise would decide. */
static void write_squares(opms_bar_detector_t *d, const edge_scene_t *scene, const opms_roi_t *roi)
{
    unsigned sides[OPMS_BAR_SQUARES] = {0};
    uint32_t count[OPMS_BAR_SQUARES] = {0};
    for (int i = 0; i < d->fit.count; ++i) {
        const stretch_t *s = &d->fit.stretch[i];
        if (d->fit.seen[i] || d->fit.good[i]) {
            sides[s->square] |= 1u << s->side;
        }
        count[s->square] += d->fit.good[i] != 0;
    }
    d->square_count = 0;
    for (int k = 0; k < OPMS_BAR_SQUARES; ++k) {
        if (!(sides[k] & 5u) || !(sides[k] & 10u) || count[k] == 0) {
            continue;
        }
        opms_square_t *square = &d->squares[d->square_count];
        square->index = k;
        square->edges = count[k];
        int all = 1;
        for (int c = 0; c < 4; ++c) {
            const double x = (c == 1 || c == 2) ? BAR_HALF_SQUARE_MM : -BAR_HALF_SQUARE_MM;
            const double y = BAR_PITCH_MM * (k - OPMS_BAR_ORIGIN) +
                             (c >= 2 ? BAR_HALF_SQUARE_MM : -BAR_HALF_SQUARE_MM);
            all = all && plane_map_project(&scene->map, scene->lens, scene->ray_limit, x, y,
                                           square->corners_px[c], NULL);
            square->corners_px[c][0] += roi->x_px;
            square->corners_px[c][1] += roi->y_px;
        }
        d->square_count += (uint32_t)all;
    }
}

static void summarise(const opms_bar_detector_t *d, const edge_scene_t *scene, double margin,
                      opms_bar_summary_t *summary)
{
    summary->state = OPMS_BAR_LOCATED;
    summary->square_count = d->square_count;
    summary->edge_count = d->edge_count;
    summary->label_margin = margin;
    summary->blur_px[0] = scene->blur_px[0];
    summary->blur_px[1] = scene->blur_px[1];
    summary->noise = (double)d->fit.noise;
    summary->contrast = (double)d->fit.contrast;
    /* About half of the pixels next to the sides are white. */
    summary->white_fraction_saturated = fmin(1, 2 * shape_saturated_part(&d->fit));
}

void bar_report(opms_bar_detector_t *d, const edge_scene_t *scene, const opms_roi_t *roi,
                double margin, opms_bar_summary_t *summary)
{
    write_edges(d, roi);
    write_squares(d, scene, roi);
    summarise(d, scene, margin, summary);
}
