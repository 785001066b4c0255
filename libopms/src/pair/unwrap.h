/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Counters of any width to 64 bit: nothing behind this ever sees a number wrap. */
#ifndef OPMS_PAIR_UNWRAP_H
#define OPMS_PAIR_UNWRAP_H

#include <stdint.h>

/** A counter of 8 to 64 bit, and the last number it showed. */
typedef struct pair_unwrap {
    uint32_t bits;
    uint32_t skips_0; /* goes from its largest number to 1 */
    int started;
    int64_t last;
} pair_unwrap_t;

/** The number nearest to the last one that the counter shows as `raw`; the first one is `raw`
 * itself. Bits beyond the counter's width are ignored; a step of exactly half its range counts as
 * a step back. With skips_0 the numbers have no hole where the counter leaves out 0. */
int64_t pair_unwrap(pair_unwrap_t *counter, uint64_t raw);

#endif
