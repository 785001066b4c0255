/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the witnesses of the present lock say of one frame. Changes nothing but its evidence. */
#ifndef OPMS_PAIR_JUDGE_H
#define OPMS_PAIR_JUDGE_H

#include "pair/pairer_state.h"

typedef enum pair_verdict {
    PAIR_VERDICT_PAIR,        /* two witnesses agree */
    PAIR_VERDICT_SUPPORTED,   /* id and arrival agree; what follows must not contradict them */
    PAIR_VERDICT_TRIGGER,     /* its trigger's time is not known yet */
    PAIR_VERDICT_OFF_GRID,    /* its camera time lies between two triggers */
    PAIR_VERDICT_ALONE,       /* one witness alone */
    PAIR_VERDICT_CONTRADICTS, /* the lock cannot be right, or the frame is none of it */
    PAIR_VERDICT_DUPLICATE,
    PAIR_VERDICT_STALE
} pair_verdict_t;

/** Judge a frame by the present lock.
 * @param looking_back  A lock was made after it: the camera's clock is known on both sides of it,
 *     so that camera time and arrival are two witnesses where the id is none. */
pair_verdict_t pair_judge(const opms_pairer_t *pairer, pair_frame_t *frame, int looking_back);

/** When this trigger's frame arrived, against what was learnt. */
pair_timing_t pair_judge_delay(const opms_pairer_t *pairer, int64_t delay_ns);

/** Did it arrive later than the longest wait, and that by more than the clocks are known to? */
int pair_is_too_late(const opms_pairer_t *pairer, int64_t delay_ns);

#endif
