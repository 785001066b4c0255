/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Decisions into the queue of results, and their counters. Nothing that is here is undone. */
#ifndef OPMS_PAIR_EMIT_H
#define OPMS_PAIR_EMIT_H

#include "pair/pairer_state.h"

/** Is there room for all that now waits, and for `more` results? */
int pair_has_room(const opms_pairer_t *pairer, uint32_t more);

/** The pair of a frame's evidence. The frame is decided then. */
void pair_emit_pair(opms_pairer_t *pairer, pair_frame_t *frame);

/** A frame alone. The frame is decided then. */
void pair_emit_frame(opms_pairer_t *pairer, pair_frame_t *frame, opms_frame_state_t state);

/** A trigger alone. */
void pair_emit_trigger(opms_pairer_t *pairer, int64_t number, opms_trigger_state_t state);

/** Triggers that were never held: too many at once. */
void pair_emit_lost(opms_pairer_t *pairer, int64_t first, uint32_t count);

#endif
