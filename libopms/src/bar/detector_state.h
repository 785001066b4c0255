/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What a bar detector holds; shared by its own files alone. */
#ifndef OPMS_BAR_DETECTOR_STATE_H
#define OPMS_BAR_DETECTOR_STATE_H

#include <opms/bar.h>

#include "bar/map_refine.h"
#include "bar/quad.h"
#include "image/view.h"

#define REJECTED_MAX 128

/** A quadrilateral that was tried and is no square of a bar. */
typedef struct rejected {
    float x, y, radius;
} rejected_t;

struct opms_bar_detector {
    opms_lens_t lens;
    opms_bar_options_t options;
    double ray_limit;
    const struct stretch_kernel *kernel;
    /* The picture at hand. */
    opms_lens_t local_lens; /* with the region's corner as the origin */
    view_t view;
    quad_limits_t limits;
    long work_left; /* about a pixel read each; the search ends when none is left */
    int settled; /* the bar is found and cannot be measured: no use to search on */
    int rejected_count;
    unsigned rejected_next; /* the one to be forgotten when there is no more room */
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

#endif
