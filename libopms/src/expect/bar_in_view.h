/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The edges of a bar as a perfect detector would measure them. */
#ifndef OPMS_EXPECT_BAR_IN_VIEW_H
#define OPMS_EXPECT_BAR_IN_VIEW_H

#include <opms/bar.h>
#include <opms/types.h>

/** Two stretches of each side of a square. */
#define BAR_IN_VIEW_EDGES_MAX (OPMS_BAR_SQUARES * 4 * 2)

/** What makes an edge exact. */
typedef struct bar_in_view_light {
    double sigma_sqrt_px; /**< standard deviation of an edge 1 px long */
    double min_square_px;
} bar_in_view_light_t;

/** Exact edges of the squares that are whole in the picture.
 *
 * @param bar_camera  camera to bar
 * @param[out] edges  BAR_IN_VIEW_EDGES_MAX
 * @param[out] square_count  how many squares they belong to
 * @return how many edges there are */
uint32_t bar_in_view(const opms_lens_t *lens, const opms_transform_t *bar_camera,
                     bar_in_view_light_t light, opms_edge_t *edges, uint32_t *square_count);

#endif
