/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * opms::hid: the trigger box, opened and read.
 *
 * A library of its own beside libopms, the only user of hidapi. A handle has two threads: one reads
 * reports, checks and numbers them off and opens the box again after an unplug; the other one
 * carries out what callers ask and fetches lost pulses from the box's HISTORY. So no call blocks
 * longer than its deadline, and what happened comes out as items, in order, by polling:
 *
 *     opms_box_options_t options;
 *     opms_box_options_init(&options);
 *     opms_box_open(&options, &box, &err);
 *     opms_box_arm(box, session_id, 0, &err);
 *     while (opms_box_poll(box, 100, &item, &err) == OPMS_OK) { switch (item.kind) ... }
 *
 * The emulated box (docs/emulated-box.md) is reached the same way through its socket.
 * Calls of one handle may come from any thread at any time, opms_box_close() excepted. */
#ifndef OPMS_HID_H
#define OPMS_HID_H

#include <opms/status.h>
#include <opms/wire.h>

#ifdef __cplusplus
extern "C" {
#endif

#define OPMS_BOX_EMULATED_PORT 47653 /**< of the emulated box, unless told otherwise */
#define OPMS_BOX_ID_SIZE 17          /**< of a unique id as 16 hex digits, with its NUL */

/** How a box is reached. */
typedef enum opms_box_transport {
    OPMS_BOX_USB = 0,     /**< HID, by hidapi */
    OPMS_BOX_EMULATED = 1 /**< a socket of this machine */
} opms_box_transport_t;

/** A box that is plugged in. */
typedef struct opms_box_entry {
    char unique_id[OPMS_BOX_ID_SIZE]; /**< "" where the system does not let us read it */
    char product[64];
    char path[128];   /**< as hidapi names the place, such as /dev/hidraw3 */
    uint16_t release; /**< bcdDevice */
    bool accessible;  /**< false: no permission, see docs/box.md */
} opms_box_entry_t;

/** Kinds of items. */
typedef enum opms_item_kind {
    OPMS_ITEM_NONE = 0,     /**< nothing came within the time */
    OPMS_ITEM_TRIGGER = 1,  /**< a pulse was reported */
    OPMS_ITEM_PONG = 2,
    OPMS_ITEM_STATUS = 3,
    OPMS_ITEM_EVENT = 4,
    OPMS_ITEM_HISTORY = 5,  /**< a pulse whose report got lost, out of the box's memory */
    OPMS_ITEM_LINK = 6,     /**< unplugged, back again, rebooted, ... */
    OPMS_ITEM_LOST = 7,     /**< something did not get here */
    OPMS_ITEM_MALFORMED = 8 /**< a report that does not read */
} opms_item_kind_t;

/** What became of the connection. */
typedef enum opms_link_change {
    OPMS_LINK_CONNECTED = 1,    /**< after opening, and after each replug */
    OPMS_LINK_DISCONNECTED = 2, /**< it is sought by its unique id until it is back */
    OPMS_LINK_REBOOTED = 3,     /**< another boot id: nothing may be paired across this item */
    OPMS_LINK_SILENT = 4,       /**< no report for 3 s, where STATUS comes each second */
    OPMS_LINK_FAILED = 5        /**< the box is there but cannot be used; the message says why */
} opms_link_change_t;

/** What was lost. */
typedef enum opms_lost_what {
    OPMS_LOST_REPORTS = 1,  /**< input reports, by their numbers */
    OPMS_LOST_TRIGGERS = 2, /**< pulses whose reports are missing; HISTORY is asked for them */
    OPMS_LOST_UNFILLED = 3, /**< pulses that HISTORY could not give, either */
    OPMS_LOST_ITEMS = 4     /**< the queue was full: this many items are missing at this place */
} opms_lost_what_t;

/** A pong, and when its ping left. */
typedef struct opms_pong_item {
    opms_pong_report_t report;
    int64_t t_sent_host_ns; /**< host time just before the ping was sent; 0: not our ping */
} opms_pong_item_t;

/** One pulse of a gap. Entries the box holds no more come with OPMS_TRIGGER_NOT_HELD. */
typedef struct opms_history_item {
    uint32_t boot_id;
    uint32_t session_id;
    opms_history_entry_t entry;
} opms_history_item_t;

typedef struct opms_link_item {
    opms_link_change_t change;
    uint32_t boot_id;  /**< of the box now, 0 if not known */
    char message[120]; /**< for people */
} opms_link_item_t;

typedef struct opms_lost_item {
    opms_lost_what_t what;
    uint32_t session_id; /**< of pulses, else 0 */
    uint32_t first;      /**< number of the first one; 0 of items */
    uint32_t count;
} opms_lost_item_t;

typedef struct opms_malformed_item {
    opms_wire_result_t result;
    uint8_t id;    /**< first byte, 0 if there was none */
    uint32_t size; /**< bytes that came */
} opms_malformed_item_t;

/** What comes out of a box, in the order in which it happened. */
typedef struct opms_box_item {
    opms_item_kind_t kind;
    int64_t t_host_ns; /**< arrival by the host's monotonic clock (CLOCK_MONOTONIC) */
    union {            /**< by kind */
        opms_trigger_report_t trigger;
        opms_pong_item_t pong;
        opms_status_report_t status;
        opms_event_report_t event;
        opms_history_item_t history;
        opms_link_item_t link;
        opms_lost_item_t lost;
        opms_malformed_item_t malformed;
    } as;
} opms_box_item_t;

/** Takes items at once instead of the queue. Called by the handle's threads, one call at a time and
 * none after opms_box_close(); must return soon, and must not call with the same handle. */
typedef void (*opms_box_item_fn)(void *user, const opms_box_item_t *item);

/** Options of opms_box_open(); fill with opms_box_options_init() first. */
typedef struct opms_box_options {
    uint32_t struct_size;
    opms_box_transport_t transport;   /**< default USB */
    char unique_id[OPMS_BOX_ID_SIZE]; /**< 16 hex digits; "" (default): the only box */
    uint16_t emulated_port;           /**< default OPMS_BOX_EMULATED_PORT */
    uint32_t queue_items;             /**< 16 to 1,000,000, default 4096 */
    uint32_t open_timeout_ms;         /**< default 3000 */
    uint32_t ping_interval_ms;        /**< pings of its own, for a clock model; default 0: none */
    bool fill_gaps;                   /**< ask HISTORY for lost pulses, default true */
    opms_box_item_fn on_item;         /**< NULL (default): items go to the queue */
    void *user;                       /**< for on_item */
} opms_box_options_t;

/** What a handle counted since it was opened. */
typedef struct opms_box_counters {
    uint64_t triggers, pongs, statuses, events; /**< reports that read well */
    uint64_t malformed[6];      /**< by opms_wire_result_t */
    uint64_t reports_lost;      /**< by gaps in the report numbers */
    uint64_t reports_repeated;  /**< numbers that were not newer than the last one */
    uint64_t triggers_missed;   /**< pulses whose reports did not come */
    uint64_t triggers_filled;   /**< of them, those that HISTORY gave */
    uint64_t triggers_unfilled; /**< of them, those that are lost for good */
    uint64_t items_lost;        /**< the queue was full */
    uint64_t connections, reboots;
    uint64_t requests_failed;   /**< stalled, timed out, or answered with bytes that do not read */
} opms_box_counters_t;

/** A box, open or waiting to be plugged in again. */
typedef struct opms_box opms_box_t;

/** Boxes that are plugged in by USB.
 *
 * @param[out] entries  `capacity` of them; may be NULL when that is 0.
 * @param[out] count    How many there are, also when that is more than `capacity`.
 * @return OPMS_OK (none is no error), OPMS_ERR_ARG, or OPMS_ERR_CAPACITY with `capacity` filled in.
 * @since 0.2 */
OPMS_API opms_status_t opms_box_list(opms_box_entry_t *entries, uint32_t capacity, uint32_t *count,
                                     opms_error_t *err);

/** Fill in the defaults. @param[out] options not NULL. @since 0.2 */
OPMS_API void opms_box_options_init(opms_box_options_t *options);

/** Open a box, read its identity and check that it speaks this protocol.
 *
 * @param options  NULL for the defaults; copied.
 * @param[out] box  Closed by opms_box_close().
 * @return OPMS_OK; OPMS_ERR_DEVICE (none, several, or no permission: the message lists what there
 *         is), OPMS_ERR_TIMEOUT, OPMS_ERR_VERSION, OPMS_ERR_ARG or OPMS_ERR_MEMORY.
 * @since 0.2 */
OPMS_API opms_status_t opms_box_open(const opms_box_options_t *options, opms_box_t **box,
                                     opms_error_t *err);

/** Close a box; it is not disarmed. Takes 2 s at most; a system call that hangs longer is left to
 * end by itself. NULL is allowed. @since 0.2 */
OPMS_API void opms_box_close(opms_box_t *box);

/** The next item.
 *
 * @param timeout_ms  Longest wait for one; 0 does not wait.
 * @param[out] item   Its kind is OPMS_ITEM_NONE if none came.
 * @return OPMS_OK or OPMS_ERR_ARG. @since 0.2 */
OPMS_API opms_status_t opms_box_poll(opms_box_t *box, uint32_t timeout_ms, opms_box_item_t *item,
                                     opms_error_t *err);

/** Identity as it was read when the box was connected last. Does not wait.
 * @param[out] connected  Whether it is plugged in now; may be NULL.
 * @since 0.2 */
OPMS_API opms_status_t opms_box_get_identity(opms_box_t *box, opms_identity_report_t *identity,
                                             bool *connected, opms_error_t *err);

/** Counters so far. Does not wait. @since 0.2 */
OPMS_API opms_status_t opms_box_get_counters(opms_box_t *box, opms_box_counters_t *counters,
                                             opms_error_t *err);

/* The calls below talk to the box. `timeout_ms` is the longest that they take, 0 for 2000. They
 * return OPMS_ERR_DEVICE where the box is unplugged, OPMS_ERR_TIMEOUT where it does not answer in
 * time, OPMS_ERR_REFUSED where it refuses (the message says why) and OPMS_ERR_ARG. */

/** Send a ping; its answer comes as an item. @param[out] ping_id may be NULL. @since 0.2 */
OPMS_API opms_status_t opms_box_ping(opms_box_t *box, uint32_t timeout_ms, uint32_t *ping_id,
                                     opms_error_t *err);

/** Arm, and wait until the box says so. @param session_id Not 0, another one than the last.
 * @since 0.2 */
OPMS_API opms_status_t opms_box_arm(opms_box_t *box, uint32_t session_id, uint32_t timeout_ms,
                                    opms_error_t *err);

/** Stop in whatever state, and wait until the box is IDLE. @since 0.2 */
OPMS_API opms_status_t opms_box_disarm(opms_box_t *box, uint32_t timeout_ms, opms_error_t *err);

/** Read the settings. @since 0.2 */
OPMS_API opms_status_t opms_box_get_settings(opms_box_t *box, uint32_t timeout_ms,
                                             opms_settings_report_t *report, opms_error_t *err);

/** Write the settings, wait until they are in flash (timeout_ms 0: 4000), read them back.
 * @param[out] report  What is in force then; may be NULL.
 * @since 0.2 */
OPMS_API opms_status_t opms_box_set_settings(opms_box_t *box, const opms_settings_t *settings,
                                             uint32_t timeout_ms, opms_settings_report_t *report,
                                             opms_error_t *err);

/** Read pulses out of the box's memory.
 *
 * @param count  1 to OPMS_BOX_HISTORY_ENTRIES; `entries` holds as many.
 * @param timeout_ms  0: 2000 and 20 more for each pulse.
 * @param[out] entries  In order, with OPMS_TRIGGER_NOT_HELD where the box has none.
 * @since 0.2 */
OPMS_API opms_status_t opms_box_history(opms_box_t *box, uint32_t session_id, uint32_t first,
                                        uint32_t count, uint32_t timeout_ms,
                                        opms_history_entry_t *entries, opms_error_t *err);

/** Restart the box as the RP2040's USB drive, ready to be flashed; in IDLE only. @since 0.2 */
OPMS_API opms_status_t opms_box_bootloader(opms_box_t *box, uint32_t timeout_ms,
                                           opms_error_t *err);

/** Lines of the emulated box. */
typedef enum opms_emulated_line {
    OPMS_EMULATED_START = 0,
    OPMS_EMULATED_STROBE = 1
} opms_emulated_line_t;

/* What people do with their hands, for the emulated box: OPMS_ERR_ARG with any other. They do not
 * wait for the box. */

/** Drive an input line `delay_ns` after now. @since 0.2 */
OPMS_API opms_status_t opms_box_emulate_line(opms_box_t *box, opms_emulated_line_t line, bool level,
                                             uint64_t delay_ns, opms_error_t *err);

/** Pull the cable or put it back; the box keeps its power. @since 0.2 */
OPMS_API opms_status_t opms_box_emulate_plug(opms_box_t *box, bool plugged, opms_error_t *err);

/** Power off and on. @since 0.2 */
OPMS_API opms_status_t opms_box_emulate_power(opms_box_t *box, opms_error_t *err);

#ifdef __cplusplus
}
#endif
#endif
