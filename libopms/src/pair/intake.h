/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What all inputs have in common. */
#ifndef OPMS_PAIR_INTAKE_H
#define OPMS_PAIR_INTAKE_H

#include "pair/pairer_state.h"

/** May an input be taken up? OPMS_ERR_ARG for a NULL of this name, OPMS_ERR_CAPACITY. */
opms_status_t pair_check_input(const opms_pairer_t *pairer, const void *input, const char *name,
                               opms_error_t *err);

/** OPMS_ERR_ARG for a host time that no monotonic clock shows. */
opms_status_t pair_check_time(int64_t host_ns, const char *name, opms_error_t *err);

/** Let the host's time go on; it never goes back. */
void pair_set_now(opms_pairer_t *pairer, int64_t now_host_ns);

/** The box has started anew while the session was open: it gets no more triggers. */
void pair_see_other_boot(opms_pairer_t *pairer);

/** Is a report of the session that is open? Another boot or session is counted. */
int pair_is_ours(opms_pairer_t *pairer, uint32_t boot_id, uint32_t session_id);

/** Let the clock run on and settle all that can be settled. */
void pair_go_on(opms_pairer_t *pairer, int64_t now_host_ns);

/** Make the triggers up to this number exist. @return 0 where the number cannot be. */
int pair_extend_triggers(opms_pairer_t *pairer, int64_t number);

#endif
