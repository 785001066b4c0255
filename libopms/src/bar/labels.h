/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Which squares of the bar a row is: likelihood over the whole visible sequence. */
#ifndef OPMS_BAR_LABELS_H
#define OPMS_BAR_LABELS_H

#include "bar/chain.h"
#include "bar/plane_map.h"
#include "image/view.h"

typedef enum label_verdict {
    LABELS_NOT_A_BAR, /**< the cells fit no place of the bar */
    LABELS_UNDECIDED, /**< they fit two places about as well */
    LABELS_CERTAIN
} label_verdict_t;

typedef struct labels {
    int turn;      /**< the row runs against the bar: index = offset - place */
    int offset;    /**< else index = place + offset */
    double margin; /**< log-likelihood ratio to the next best place */
} labels_t;

/** Label a row whose map is known up to its origin and direction. */
label_verdict_t labels_decide(const view_t *view, const chain_t *chain, const plane_map_t *map,
                              const opms_lens_t *lens, double ray_limit, labels_t *labels);

#endif
