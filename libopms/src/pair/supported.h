/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Pairs by frame id and arrival, and making a pair.
 *
 * A frame may be late by whole periods, and then it looks like the frame of a later trigger if its
 * id has jumped by as many. So it becomes a pair only when the frames after it fit, too: had the
 * ids jumped, those would be early, and no frame is early. */
#ifndef OPMS_PAIR_SUPPORTED_H
#define OPMS_PAIR_SUPPORTED_H

#include "pair/pairer_state.h"

/** A pair is made: both are settled, and what it teaches is learnt. */
void pair_commit(opms_pairer_t *pairer, pair_frame_t *frame);

/** A frame is on time: it confirms those before it, and waits to be confirmed. */
void pair_support(opms_pairer_t *pairer, uint64_t slot);

/** A frame contradicts: those that were not confirmed will not be, but for a frame that follows
 * right upon a pair. Nothing comes between the two ids; only an extra frame could pretend to be the
 * next one, and then this trigger's own frame comes in its place. */
void pair_bar_supported(opms_pairer_t *pairer, const pair_frame_t *contradicting);

/** A new offset holds from this trigger on: the same for the frames before it. */
void pair_leave_supported(opms_pairer_t *pairer, int64_t from_number);

/** The time of a trigger, or its frame's, is over: nothing contradicted. Where the frame before it
 * was paired with the trigger before it, that makes the pair. */
void pair_end_supported(opms_pairer_t *pairer, int64_t number);

#endif
