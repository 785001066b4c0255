/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Errors that stretches have in common. */
#ifndef OPMS_BAR_CORRELATION_H
#define OPMS_BAR_CORRELATION_H

#include "bar/map_refine.h"

/** State larger standard deviations where errors run alike along a side or along the bar, as shade
 * and grass make them: what is averaged does then not grow more certain by as much. */
void correlation_state(const edge_scene_t *scene, bar_fit_t *fit);

#endif
