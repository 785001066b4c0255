/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What follows from a verdict, and the end of what has waited for too long. */
#ifndef OPMS_PAIR_SETTLE_H
#define OPMS_PAIR_SETTLE_H

#include "pair/pairer_state.h"

/** Judge a frame that waits, if there is a lock, and act on it. */
void pair_settle_frame(opms_pairer_t *pairer, uint64_t slot, int looking_back);

/** Would a new lock change what it is? */
int pair_waits_for_lock(const pair_frame_t *frame);

/** Go over the frames that wait for what may have come by now. */
void pair_settle_waiting(opms_pairer_t *pairer);

/** After a new lock: judge again all that waits. */
void pair_settle_again(opms_pairer_t *pairer);

/** End the triggers and frames whose time is over; all of them with `everything`. */
void pair_settle_expired(opms_pairer_t *pairer, int everything);

/** End the oldest trigger, or the oldest frame, now: its place is needed. */
void pair_settle_oldest_trigger(opms_pairer_t *pairer);
void pair_settle_oldest_frame(opms_pairer_t *pairer);

#endif
