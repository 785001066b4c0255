/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The box's clock seen from the host: where a box time lies on the host's monotonic clock.
 *
 * Ping round trips go in. Of the last 31 the 8 fastest are kept, because what delays a round trip
 * also makes it lopsided; a line through them gives offset and drift, a gate throws out what does
 * not fit the line. Nothing here reads a clock. Method and figures: docs/pairing.md.
 *
 * Times are int64_t nanoseconds of the clock that the name tells: `_box_ns` of the box,
 * `_host_ns` of the host's monotonic clock, `_wall_ns` since 1970 UTC. */
#ifndef OPMS_CLOCK_H
#define OPMS_CLOCK_H

#include <stddef.h>
#include <stdint.h>

#include <opms/status.h>
#include <opms/types.h>

#ifdef __cplusplus
extern "C" {
#endif

#define OPMS_CLOCK_WINDOW_MAX 127 /**< most round trips that a clock remembers */

/** How much is known. */
typedef enum opms_clock_state {
    OPMS_CLOCK_UNKNOWN = 0, /**< no round trip yet: no conversion */
    OPMS_CLOCK_COARSE = 1,  /**< too few for a line: offset of the fastest one, no drift */
    OPMS_CLOCK_FITTED = 2   /**< offset and drift by a line */
} opms_clock_state_t;

/** One ping and its pong. */
typedef struct opms_round_trip {
    int64_t sent_host_ns;    /**< before the ping was handed to the system */
    int64_t received_box_ns; /**< as the box tells in its pong */
    int64_t sent_box_ns;     /**< as the box tells in its pong */
    int64_t arrived_host_ns; /**< after the pong was read */
} opms_round_trip_t;

/** What the clock knows. All figures are of the round trips that the line was put through. */
typedef struct opms_clock_fit {
    opms_clock_state_t state;
    uint32_t round_trips; /**< that the line goes through */
    double drift_ppm;     /**< how much faster the box's clock runs than the host's */
    double drift_sigma_ppm; /**< standard deviation of it; 0 where it is not known */
    int64_t residual_ns;  /**< largest distance of a round trip's middle from the line */
    int64_t sigma_ns;     /**< standard deviation of a conversion at the newest round trip */
    int64_t bound_ns;     /**< no conversion there is off by more: half the longest one used */
    int64_t newest_host_ns; /**< arrival of the newest round trip */
    uint64_t accepted, refused; /**< since the clock was reset; refused: impossible or gated */
} opms_clock_fit_t;

/** Options of a clock; fill with opms_clock_options_init() first. */
typedef struct opms_clock_options {
    uint32_t struct_size;
    uint32_t window;          /**< round trips remembered, 3 to 127; default 31 */
    uint32_t best;            /**< fastest ones used, 2 to window; default 8 */
    uint32_t drift_max_ppm;   /**< no two quartz clocks drift more, 1 to 10,000; default 300 */
    opms_allocator_t allocator;
} opms_clock_options_t;

/** One clock of one box. One handle, one thread at a time; different handles freely. */
typedef struct opms_clock opms_clock_t;

/** Fill in the defaults. @param[out] options not NULL. @since 0.2 */
OPMS_API void opms_clock_options_init(opms_clock_options_t *options);

/** Create a clock.
 * @param options  NULL for the defaults; copied.
 * @param[out] clock  Freed by opms_clock_destroy().
 * @return OPMS_OK, OPMS_ERR_ARG or OPMS_ERR_MEMORY. @since 0.2 */
OPMS_API opms_status_t opms_clock_create(const opms_clock_options_t *options, opms_clock_t **clock,
                                         opms_error_t *err);

/** Free a clock. NULL is allowed. @since 0.2 */
OPMS_API void opms_clock_destroy(opms_clock_t *clock);

/** Forget all round trips: the box has started up again. Wall time stays. @since 0.2 */
OPMS_API void opms_clock_reset(opms_clock_t *clock);

/** Take up a round trip. Never allocates; bounded time.
 *
 * One that cannot be (backwards, or longer in the box than in the host) or that lies off the line
 * by more than its own length and the drift allow is refused, that is counted and not an error.
 * @return OPMS_OK or OPMS_ERR_ARG (NULL). @since 0.2 */
OPMS_API opms_status_t opms_clock_push(opms_clock_t *clock, const opms_round_trip_t *trip,
                                       opms_error_t *err);

/** What is known. @param[out] fit not NULL. @since 0.2 */
OPMS_API void opms_clock_get(const opms_clock_t *clock, opms_clock_fit_t *fit);

/** A box time on the host's monotonic clock.
 * @return OPMS_OK, OPMS_ERR_ARG (NULL) or OPMS_ERR_DOMAIN (state UNKNOWN). @since 0.2 */
OPMS_API opms_status_t opms_clock_host_from_box(const opms_clock_t *clock, int64_t box_ns,
                                                int64_t *host_ns, opms_error_t *err);

/** A host time on the box's clock; inverse of the other to a nanosecond.
 * @return As opms_clock_host_from_box(). @since 0.2 */
OPMS_API opms_status_t opms_clock_box_from_host(const opms_clock_t *clock, int64_t host_ns,
                                                int64_t *box_ns, opms_error_t *err);

/** The two clocks of the host, read one right after the other.
 *
 * The first sample since create fixes wall time; a step of the wall clock (somebody sets it, NTP
 * corrects it) moves no conversion. It is counted and can be read.
 * @return OPMS_OK or OPMS_ERR_ARG. @since 0.2 */
OPMS_API opms_status_t opms_clock_push_wall(opms_clock_t *clock, int64_t host_ns, int64_t wall_ns,
                                            opms_error_t *err);

/** A host time as wall time.
 * @return OPMS_OK, OPMS_ERR_ARG or OPMS_ERR_DOMAIN (no sample yet). @since 0.2 */
OPMS_API opms_status_t opms_clock_wall_from_host(const opms_clock_t *clock, int64_t host_ns,
                                                 int64_t *wall_ns, opms_error_t *err);

/** How far the wall clock stands from the one that was fixed, and how often it stepped by more
 * than a millisecond. @param[out] steps may be NULL. @since 0.2 */
OPMS_API int64_t opms_clock_wall_steps_ns(const opms_clock_t *clock, uint32_t *steps);

#ifdef __cplusplus
}
#endif
#endif
