/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Asking the memory for the pixels of a square before they are needed. */
#ifndef OPMS_BAR_FETCH_SQUARE_H
#define OPMS_BAR_FETCH_SQUARE_H

#include "bar/edge_fit.h"

/** Start to load a square and what lies around it. Changes nothing but the time of what follows. */
void fetch_square(const edge_scene_t *scene, int square);

#endif
