/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the flags of a pulse may be, in TRIGGER as in HISTORY. */
#ifndef OPMS_WIRE_FLAGS_H
#define OPMS_WIRE_FLAGS_H

#include <opms/wire.h>

/** Flags of a pulse that is held: of the preamble or of the run, and a cut only in a run. */
static inline bool are_pulse_flags(uint16_t flags)
{
    const bool preamble = (flags & OPMS_TRIGGER_PREAMBLE) != 0;
    const bool run = (flags & OPMS_TRIGGER_RUN) != 0;
    const bool cut = (flags & OPMS_TRIGGER_PREAMBLE_CUT) != 0;
    return flags < OPMS_TRIGGER_NOT_HELD && preamble != run && (run || !cut);
}

#endif
