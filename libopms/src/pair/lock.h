/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Gaining the lock. */
#ifndef OPMS_PAIR_LOCK_H
#define OPMS_PAIR_LOCK_H

#include "pair/pairer_state.h"

/** Where there is no lock, look for one; where it is found, settle what waits for it. */
void pair_seek_lock(opms_pairer_t *pairer);

#endif
