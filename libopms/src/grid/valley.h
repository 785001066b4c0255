/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Dark valleys along a straight probe: where a line of the grid crosses it. */
#ifndef OPMS_GRID_VALLEY_H
#define OPMS_GRID_VALLEY_H

#include "grid/vec2.h"
#include "image/view.h"

#define PROBE_MAX 128 /* samples of one probe */

/** Where a probe meets a valley. */
typedef struct valley {
    float at;    /**< px along the probe */
    float depth; /**< grey levels below the white on its lower side */
    float white; /**< grey level of that white */
} valley_t;

/** The first valley along a probe from `from`, which lies on white, in steps of one pixel.
 *
 * @param unit   direction of the probe
 * @param reach  px that it may go, at most PROBE_MAX
 * @param least  depth that counts, as a part of the white */
int first_valley(const view_t *view, vec2_t from, vec2_t unit, float reach, float least,
                 valley_t *valley);

/** The deepest valley within `reach` px on either side of `middle`, white on both sides of it. */
int nearest_valley(const view_t *view, vec2_t middle, vec2_t unit, float reach, float least,
                   valley_t *valley);

#endif
