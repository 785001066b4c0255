/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Which pulse of the trigger box exposed which frame of the camera.
 *
 * Reports, HISTORY entries, pings and frames go in as they come, in any order and with any losses;
 * decisions come out by polling. A pair needs two agreeing witnesses; where there is one alone, or
 * two that contradict each other, the answer is UNCERTAIN and never a guess. Nothing is dropped in
 * silence: each trigger and each frame ends in exactly one state, and the sums are checked.
 * Method, evidence and figures: docs/pairing.md.
 *
 * Once a session:
 *
 *     opms_pairer_open(pairer, boot_id, session_id, &settings, &err);
 *     ...  push_trigger, push_frame, push_pong, push_status, push_event as they come in
 *     ...  advance every 10 to 100 ms, poll after it; ask the box for the gaps
 *     opms_pairer_close(pairer, &err);  then poll the rest
 *
 * Times are int64_t nanoseconds: `_box_ns` of the box, `_host_ns` of the host's monotonic clock. */
#ifndef OPMS_PAIR_H
#define OPMS_PAIR_H

#include <stddef.h>
#include <stdint.h>

#include <opms/clock.h>
#include <opms/status.h>
#include <opms/types.h>
#include <opms/wire.h>

#ifdef __cplusplus
extern "C" {
#endif

/** How sure the pairer is of what joins the camera's counting to the box's. */
typedef enum opms_pair_state {
    OPMS_PAIR_CLOSED = 0,    /**< no session is open */
    OPMS_PAIR_SEARCHING = 1, /**< not known yet */
    OPMS_PAIR_LOCKED = 2,    /**< known, and the last frames agree */
    OPMS_PAIR_SUSPECT = 3    /**< a frame or a gap disagrees: nothing is paired until a new lock */
} opms_pair_state_t;

/** How a trigger ends. */
typedef enum opms_trigger_state {
    OPMS_TRIGGER_NONE = 0,      /**< the result is of a frame alone */
    OPMS_TRIGGER_PAIRED = 1,
    OPMS_TRIGGER_MISSING = 2,   /**< certain: no frame of it came */
    OPMS_TRIGGER_UNCERTAIN = 3  /**< a frame of it may have come, or its report did not */
} opms_trigger_state_t;

/** How a frame ends. */
typedef enum opms_frame_state {
    OPMS_FRAME_NONE = 0,      /**< the result is of triggers alone */
    OPMS_FRAME_PAIRED = 1,
    OPMS_FRAME_ORPHAN = 2,    /**< certain: no trigger of this session exposed it */
    OPMS_FRAME_DUPLICATE = 3, /**< came before */
    OPMS_FRAME_STALE = 4,     /**< from before the session, or later than the longest wait */
    OPMS_FRAME_UNCERTAIN = 5  /**< one witness alone, or witnesses that disagree */
} opms_frame_state_t;

/** What speaks for a pair. */
enum {
    OPMS_WITNESS_FRAME_ID = 1U << 0,    /**< frame id minus trigger number is what it was */
    OPMS_WITNESS_CAMERA_TIME = 1U << 1, /**< the camera's clock says so */
    OPMS_WITNESS_ARRIVAL = 1U << 2,     /**< it came as long after the trigger as frames do */
    OPMS_WITNESS_STROBE = 1U << 3,      /**< the box saw the exposure */
    OPMS_WITNESS_PREAMBLE = 1U << 4     /**< the lock was made on the preamble's coded gaps */
};

/** What is known of a result; a field that its bit does not name is 0. */
enum {
    OPMS_PAIR_HAS_TRIGGER_TIME = 1U << 0,
    OPMS_PAIR_HAS_START_EDGE = 1U << 1,
    OPMS_PAIR_HAS_START_DELAY = 1U << 2,   /**< trigger to start of the exposure */
    OPMS_PAIR_HAS_EXPOSURE = 1U << 3,      /**< length of the exposure */
    OPMS_PAIR_START_DELAY_SEEN = 1U << 4,  /**< by the strobe; else as the camera profile states */
    OPMS_PAIR_EXPOSURE_SEEN = 1U << 5,     /**< by the strobe; else as the camera profile states */
    OPMS_PAIR_HAS_MID_EXPOSURE = 1U << 6,  /**< start delay and exposure both known */
    OPMS_PAIR_HAS_CAMERA_RESIDUAL = 1U << 7,
    OPMS_PAIR_HAS_ARRIVAL_DELAY = 1U << 8,
    OPMS_PAIR_FROM_HISTORY = 1U << 9,      /**< the trigger's own report did not come in time */
    OPMS_PAIR_FROM_GAP = 1U << 10, /**< its time is known from a later report's gaps, to 1 us */
    OPMS_PAIR_STROBE_MISSING = 1U << 11,   /**< the box saw no exposure after this trigger */
    OPMS_PAIR_PREAMBLE_PULSE = 1U << 12
};

/** What a camera tells with each frame. All-zero and no frame id means arrival alone: no pairs. */
typedef struct opms_camera_profile {
    uint32_t has_frame_id;
    uint32_t frame_id_bits;     /**< 8 to 64; the id wraps there */
    uint32_t frame_id_skips_0;  /**< wraps to 1 (GigE Vision with 16-bit ids) */
    uint32_t has_camera_time;
    uint32_t camera_time_bits;  /**< 16 to 64; wraps there */
    uint32_t has_strobe;        /**< exposure output is wired to the box and enabled there */
    uint64_t camera_tick_hz;    /**< 1,000 to 10,000,000,000 */
    uint32_t has_start_delay;   /**< the following are stated, for where no strobe shows them */
    uint32_t has_exposure;
    int64_t start_delay_ns;     /**< trigger to start of the exposure */
    int64_t exposure_ns;
} opms_camera_profile_t;

/** Flags of a frame, as the source of the camera gives them. */
enum {
    OPMS_FRAME_NO_ID = 1U << 0,   /**< frame_id is not valid for this frame */
    OPMS_FRAME_NO_TIME = 1U << 1, /**< camera_time_ticks is not valid for this frame */
    OPMS_FRAME_DAMAGED = 1U << 2  /**< the picture is incomplete; it is paired all the same */
};

/** Header of a frame as it was delivered. */
typedef struct opms_frame {
    uint64_t frame_id;          /**< raw, as wide as the profile says */
    uint64_t camera_time_ticks; /**< raw */
    int64_t arrival_host_ns;
    uint64_t tag;               /**< the caller's; comes back in the result */
    uint32_t flags;             /**< OPMS_FRAME_NO_ID ... */
    uint32_t reserved;
} opms_frame_t;

/** One decision: a pair, a frame alone, or one or more triggers alone. */
typedef struct opms_pair_result {
    uint64_t sequence;        /**< of results since create, from 0 */
    opms_trigger_state_t trigger_state;
    opms_frame_state_t frame_state;
    uint32_t witnesses;       /**< OPMS_WITNESS_ bits that agree */
    uint32_t against;         /**< OPMS_WITNESS_ bits that disagree; a reason for UNCERTAIN */
    uint32_t known;           /**< OPMS_PAIR_HAS_... */
    uint32_t boot_id, session_id; /**< 0 where no session was open */
    /** Triggers of this result: more than 1 only for numbers that were lost in one long gap. */
    uint32_t trigger_count;
    uint64_t trigger_number;  /**< unwrapped; the first one */
    uint64_t frame_number;    /**< unwrapped frame id */
    int64_t trigger_box_ns;
    int64_t start_edge_box_ns; /**< zero of the scan's time axis */
    int64_t start_delay_ns;
    int64_t exposure_ns;
    /** trigger + start delay + exposure / 2, of those terms that are known (`known`). */
    int64_t mid_exposure_box_ns;
    int64_t camera_residual_ns; /**< camera time less what is expected of the trigger */
    int64_t arrival_delay_ns;   /**< arrival less trigger */
    int64_t id_residual;        /**< frame id less what is expected of the trigger */
    opms_frame_t frame;         /**< as it was pushed */
} opms_pair_result_t;

/** Trigger numbers whose time is not known: ask the box for them by HISTORY. */
typedef struct opms_pair_gap {
    uint32_t first_number; /**< as on the wire */
    uint32_t count;
} opms_pair_gap_t;

/** All that is counted; since create where it is not said otherwise. */
typedef struct opms_pair_counters {
    uint64_t triggers, triggers_paired, triggers_missing, triggers_uncertain, triggers_pending;
    uint64_t frames, frames_paired, frames_orphan, frames_duplicate, frames_stale;
    uint64_t frames_uncertain, frames_pending;
    uint64_t reports, reports_repeated, reports_late, reports_foreign; /**< another boot, session */
    uint64_t reports_contradicting; /**< same number, another time: neither is believed */
    uint64_t history_used, gaps_filled; /**< entries that told something; numbers by gap fields */
    uint64_t locks, losses_of_lock, camera_restarts, id_changes;
    uint64_t boots_seen; /**< other boots of the box than the session's, seen while it was open */
} opms_pair_counters_t;

/** Where the pairer stands. */
typedef struct opms_pair_summary {
    opms_pair_state_t state;
    uint32_t sums_hold;         /**< states add up to what was pushed, for triggers and frames */
    uint32_t lock_witnesses;    /**< OPMS_WITNESS_ bits of the present lock */
    uint32_t ended;             /**< no more triggers will come: stopped, or the box started anew */
    int64_t arrival_floor_ns;   /**< learnt smallest delay from trigger to arrival; 0: not known */
    int64_t camera_drift_ppb;   /**< camera's clock against the box's */
    opms_pair_counters_t counters;
    opms_clock_fit_t clock;     /**< the box's against the host's */
    char line[160];             /**< one line for people */
} opms_pair_summary_t;

/** Options of a pairer; fill with opms_pair_options_init() first. */
typedef struct opms_pair_options {
    uint32_t struct_size;
    uint32_t max_wait_ms;   /**< a trigger waits this long for its frame; 100 to 60,000: 6,000 */
    uint32_t min_period_us; /**< shortest period that will be set; sizes the memory; 10,000 */
    uint32_t first_number;  /**< of a session's first pulse: 1; others for tests at the wrap */
    opms_camera_profile_t camera; /**< default: 64-bit frame id and nothing else */
    opms_allocator_t allocator;
} opms_pair_options_t;

/** Pairs one camera with one box. One handle, one thread at a time; different handles freely. */
typedef struct opms_pairer opms_pairer_t;

/** Fill in the defaults. @param[out] options not NULL. @since 0.2 */
OPMS_API void opms_pair_options_init(opms_pair_options_t *options);

/** Create a pairer; the only call that allocates.
 * @param options  NULL for the defaults; copied.
 * @param[out] pairer  Freed by opms_pairer_destroy().
 * @return OPMS_OK, OPMS_ERR_ARG or OPMS_ERR_MEMORY. @since 0.2 */
OPMS_API opms_status_t opms_pairer_create(const opms_pair_options_t *options,
                                          opms_pairer_t **pairer, opms_error_t *err);

/** Free a pairer. NULL is allowed. @since 0.2 */
OPMS_API void opms_pairer_destroy(opms_pairer_t *pairer);

/** Begin a session, right after the box took the command to arm.
 *
 * What was learnt of arrival delays stays; nothing else passes from one session to the next.
 * @param settings  Those in force in the box (period, preamble); copied.
 * @return OPMS_OK, or OPMS_ERR_ARG where ids are 0, settings are wrong or a session is open.
 * @since 0.2 */
OPMS_API opms_status_t opms_pairer_open(opms_pairer_t *pairer, uint32_t boot_id,
                                        uint32_t session_id, const opms_settings_t *settings,
                                        opms_error_t *err);

/** Take up a trigger report. Those of another boot or session are counted and left alone.
 *
 * All pushes: never block, never allocate, bounded time. OPMS_ERR_CAPACITY where results must be
 * polled first; nothing was taken up then.
 * @param arrival_host_ns  When it was read.
 * @return OPMS_OK, OPMS_ERR_ARG or OPMS_ERR_CAPACITY. @since 0.2 */
OPMS_API opms_status_t opms_pairer_push_trigger(opms_pairer_t *pairer,
                                                const opms_trigger_report_t *report,
                                                int64_t arrival_host_ns, opms_error_t *err);

/** Take up what HISTORY returned. @return As opms_pairer_push_trigger(). @since 0.2 */
OPMS_API opms_status_t opms_pairer_push_history(opms_pairer_t *pairer,
                                                const opms_history_report_t *report,
                                                opms_error_t *err);

/** Take up an event (start, stop, missing strobe, cut preamble).
 * @return As opms_pairer_push_trigger(). @since 0.2 */
OPMS_API opms_status_t opms_pairer_push_event(opms_pairer_t *pairer,
                                              const opms_event_report_t *report,
                                              opms_error_t *err);

/** Take up a status: last number, another boot. @return As opms_pairer_push_trigger().
 * @since 0.2 */
OPMS_API opms_status_t opms_pairer_push_status(opms_pairer_t *pairer,
                                               const opms_status_report_t *report,
                                               opms_error_t *err);

/** Take up a ping and its pong: without them arrival times are no witness.
 * @return As opms_pairer_push_trigger(). @since 0.2 */
OPMS_API opms_status_t opms_pairer_push_pong(opms_pairer_t *pairer, int64_t sent_host_ns,
                                             const opms_pong_report_t *pong,
                                             int64_t arrived_host_ns, opms_error_t *err);

/** Take up a frame, in the order of arrival. With no session open it ends as STALE.
 * @return As opms_pairer_push_trigger(). @since 0.2 */
OPMS_API opms_status_t opms_pairer_push_frame(opms_pairer_t *pairer, const opms_frame_t *frame,
                                              opms_error_t *err);

/** Let time pass: ends what has waited for too long.
 * @param now_host_ns  Of the monotonic clock; a time before the last one counts as the last one.
 * @return OPMS_OK or OPMS_ERR_ARG. @since 0.2 */
OPMS_API opms_status_t opms_pairer_advance(opms_pairer_t *pairer, int64_t now_host_ns,
                                           opms_error_t *err);

/** End the session: what still waits is decided now. The results stay until they are polled.
 * @return OPMS_OK, OPMS_ERR_ARG (no session), or OPMS_ERR_INTERNAL where the sums do not hold.
 * @since 0.2 */
OPMS_API opms_status_t opms_pairer_close(opms_pairer_t *pairer, opms_error_t *err);

/** Take out decisions, in the order in which they were made.
 * @param[out] results  `capacity` elements.
 * @param[out] count    Results written; 0: nothing is decided.
 * @return OPMS_OK or OPMS_ERR_ARG. @since 0.2 */
OPMS_API opms_status_t opms_pairer_poll(opms_pairer_t *pairer, opms_pair_result_t *results,
                                        uint32_t capacity, uint32_t *count, opms_error_t *err);

/** Trigger numbers to ask HISTORY for, oldest first: those that still wait and have no time, or,
 * where a strobe is wired, none of its exposure.
 * @param[out] count  Gaps written.
 * @return OPMS_OK or OPMS_ERR_ARG. @since 0.2 */
OPMS_API opms_status_t opms_pair_gaps(const opms_pairer_t *pairer, opms_pair_gap_t *gaps,
                                      uint32_t capacity, uint32_t *count, opms_error_t *err);

/** State, counters and the line for people. @param[out] summary not NULL. @since 0.2 */
OPMS_API void opms_pairer_summary(const opms_pairer_t *pairer, opms_pair_summary_t *summary);

/** The box's clock as the pairer has learnt it from the pongs, for conversions.
 * @return Owned by the pairer. @since 0.2 */
OPMS_API const opms_clock_t *opms_pairer_clock(const opms_pairer_t *pairer);

/** Name of a state, e.g. "LOCKED", "PAIRED"; "?" for other numbers. @return Static storage.
 * @since 0.2 */
OPMS_API const char *opms_pair_state_name(opms_pair_state_t state);
OPMS_API const char *opms_trigger_state_name(opms_trigger_state_t state);
OPMS_API const char *opms_frame_state_name(opms_frame_state_t state);

#ifdef __cplusplus
}
#endif
#endif
