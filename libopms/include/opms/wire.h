/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Reports between the trigger box and its host: bytes to structs and back.
 *
 * One file for both sides: the firmware compiles libopms/src/wire as the host does. Freestanding
 * C11, no allocation, no state; every call may be made from any thread. Offsets of every field:
 * docs/wire.md. Numbers are little-endian; every report has 64 bytes with its id first, the
 * protocol version second and a CRC-16 last; reserved bytes are 0. */
#ifndef OPMS_WIRE_H
#define OPMS_WIRE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <opms/export.h>

#ifdef __cplusplus
extern "C" {
#endif

#define OPMS_WIRE_PROTOCOL 1       /**< version of the protocol; another one is refused */
#define OPMS_WIRE_SIZE 64          /**< bytes of every report, its id included */
#define OPMS_USB_VENDOR_ID 0x1209  /**< pid.codes */
#define OPMS_USB_PRODUCT_ID 0x0001 /**< its id for tests, until one is granted */
#define OPMS_USB_USAGE_PAGE 0xFF4F /**< of the box's HID collection */
#define OPMS_USB_USAGE 0x0001
#define OPMS_BOX_CLOCK_HZ 125000000 /**< one cycle is 8 ns */
#define OPMS_BOX_CYCLES_PER_US 125
#define OPMS_BOX_START_CYCLES 4    /**< start edge to first pulse, beyond the debounce */
#define OPMS_BOX_RING_ENTRIES 1024 /**< pulses that hardware remembers without the CPU */
#define OPMS_BOX_HISTORY_ENTRIES 8192 /**< pulses that HISTORY can return */
#define OPMS_BOX_PREAMBLE_MAX 8    /**< most gaps of a preamble; one pulse more than gaps */
#define OPMS_HISTORY_PER_REPORT 2  /**< most entries in one HISTORY report */

/** Report ids. */
typedef enum opms_report_id {
    OPMS_REPORT_TRIGGER = 0x01,   /**< in: one pulse */
    OPMS_REPORT_PONG = 0x02,      /**< in: answer to a ping */
    OPMS_REPORT_STATUS = 0x03,    /**< in: once a second */
    OPMS_REPORT_EVENT = 0x04,     /**< in: something happened */
    OPMS_REPORT_COMMAND = 0x10,   /**< out */
    OPMS_REPORT_IDENTITY = 0x20,  /**< feature, get */
    OPMS_REPORT_SETTINGS = 0x21,  /**< feature, get and set */
    OPMS_REPORT_HISTORY = 0x22,   /**< feature: set selects, each get returns the next entries */
    OPMS_REPORT_BOOTLOADER = 0x23 /**< feature, set */
} opms_report_id_t;

/** What is wrong with the bytes of a report. */
typedef enum opms_wire_result {
    OPMS_WIRE_OK = 0,
    OPMS_WIRE_LENGTH = 1,  /**< not OPMS_WIRE_SIZE bytes */
    OPMS_WIRE_ID = 2,      /**< unknown, or not the id that was asked for */
    OPMS_WIRE_VERSION = 3, /**< another protocol version */
    OPMS_WIRE_CRC = 4,
    OPMS_WIRE_VALUE = 5    /**< a field out of its range, or a reserved byte that is not 0 */
} opms_wire_result_t;

/** States of the box. READY is shown to people in WAITING only. */
typedef enum opms_box_state {
    OPMS_BOX_IDLE = 0,
    OPMS_BOX_ARMED = 1,    /**< told to get ready */
    OPMS_BOX_PREAMBLE = 2, /**< sends the preamble's pulses */
    OPMS_BOX_WAITING = 3,  /**< for the hardware start */
    OPMS_BOX_RUNNING = 4   /**< a pulse each period since the start edge */
} opms_box_state_t;

/** Why the box started up. */
typedef enum opms_reset_cause {
    OPMS_RESET_UNKNOWN = 0,
    OPMS_RESET_POWER = 1,
    OPMS_RESET_PIN = 2,
    OPMS_RESET_WATCHDOG = 3, /**< the program hung: a run that was going on has ended */
    OPMS_RESET_SOFTWARE = 4
} opms_reset_cause_t;

/** Time of the box since it started up: 8 ns steps, never wraps in practice. */
typedef struct opms_box_time {
    uint64_t us;
    uint8_t cycles; /**< 0 to 124, of 8 ns, beyond us */
} opms_box_time_t;

/** A box time in ns. */
static inline int64_t opms_box_time_ns(opms_box_time_t time)
{
    return (int64_t)(time.us * 1000U + time.cycles * 8U);
}

/** Flags of a trigger, in reports and in HISTORY. */
enum {
    OPMS_TRIGGER_PREAMBLE = 1U << 0,       /**< a pulse of the preamble */
    OPMS_TRIGGER_RUN = 1U << 1,            /**< a pulse of the run; exactly one of the two */
    OPMS_TRIGGER_PREAMBLE_CUT = 1U << 2,   /**< START came within the preamble */
    OPMS_TRIGGER_STROBE = 1U << 3,         /**< the strobe fields hold an exposure */
    OPMS_TRIGGER_STROBE_MISSING = 1U << 4, /**< an exposure was due and did not come */
    OPMS_TRIGGER_DELAYED = 1U << 5,        /**< report sent more than 2 ms after the pulse */
    OPMS_TRIGGER_NOT_HELD = 1U << 6        /**< HISTORY only: too old, or not sent yet */
};

/** 0x01 TRIGGER: one pulse, as it left the box. */
typedef struct opms_trigger_report {
    uint16_t flags;          /**< OPMS_TRIGGER_... */
    uint32_t boot_id;        /**< random, another one at each start-up; never 0 */
    uint32_t session_id;     /**< set by the host when it armed */
    uint32_t report_number;  /**< of all input reports since start-up, from 1 */
    uint32_t trigger_number; /**< pulses since arming, the preamble included, from 1 */
    opms_box_time_t time;    /**< rising edge (of active TRIG) */
    opms_box_time_t start_edge; /**< START's edge; zero before the run */
    uint32_t first_run_number;  /**< number of the run's first pulse; 0 before the run */
    /** The last completed exposure, by OPMS_TRIGGER_STROBE; 0 if none. */
    uint32_t strobe_for_trigger;  /**< the pulse that it followed */
    uint32_t strobe_delay_cycles; /**< from that pulse to its start, 8 ns */
    uint32_t strobe_length_cycles;
    /** Whole us from the pulse before this one, and from the one before that to it; 0 if there is
     * none, or more than 16.7 s. One or two lost reports lose nothing. */
    uint32_t gap_us[2];
    uint16_t dropped; /**< pulses whose number and time were lost since start-up, stays at 65535 */
} opms_trigger_report_t;

/** 0x02 PONG: when the box got a ping and when it handed the answer to USB. */
typedef struct opms_pong_report {
    uint32_t boot_id;
    uint32_t report_number;
    uint32_t ping_id;
    opms_box_time_t received;
    opms_box_time_t sent;
} opms_pong_report_t;

/** 0x03 STATUS: all that the box counts. Counters start at 0 at start-up and wrap. */
typedef struct opms_status_report {
    opms_box_state_t state;
    opms_reset_cause_t reset_cause;
    uint32_t boot_id;
    uint32_t session_id;
    uint32_t report_number;
    uint64_t uptime_us;
    uint32_t trigger_number;   /**< of the last pulse; 0 if none since arming */
    uint32_t first_run_number; /**< 0 before the run */
    uint32_t glitches;         /**< START was high for less than the debounce */
    uint32_t starts_refused;   /**< START edges in another state */
    uint32_t strobes_missing;
    uint32_t dropped;          /**< pulses whose number and time were lost */
    uint32_t commands_refused; /**< commands and settings that were not carried out */
    uint16_t reenumerations;   /**< times that a wedged endpoint was healed */
    uint16_t settings_crc;     /**< CRC of the settings in force, see opms_settings_t */
} opms_status_report_t;

/** Kinds of 0x04 EVENT. */
typedef enum opms_event_kind {
    OPMS_EVENT_ARMED = 1,           /**< argument: session id */
    OPMS_EVENT_WAITING = 2,         /**< ready for START; argument: pulses of the preamble */
    OPMS_EVENT_START = 3,           /**< time: the edge; argument: the run's first pulse */
    OPMS_EVENT_STOP = 4,            /**< argument: number of the last pulse */
    OPMS_EVENT_GLITCH = 5,          /**< time: its edge; argument: its length in cycles */
    OPMS_EVENT_START_REFUSED = 6,   /**< START in IDLE, ARMED or RUNNING; argument: the state */
    OPMS_EVENT_PREAMBLE_CUT = 7,    /**< START in PREAMBLE; argument: pulses sent before it */
    OPMS_EVENT_STROBE_MISSING = 8,  /**< argument: the pulse without an exposure */
    OPMS_EVENT_WAIT_TIMEOUT = 9,    /**< no START came: the box is IDLE again */
    OPMS_EVENT_REFUSED = 10,        /**< argument: report id + 256 * opcode; detail: refusal */
    OPMS_EVENT_SETTINGS_STORED = 11, /**< argument: CRC of the settings */
    OPMS_EVENT_ENDPOINT_HEALED = 12 /**< argument: times so far */
} opms_event_kind_t;

/** Why the box refused. */
typedef enum opms_refusal {
    OPMS_REFUSAL_NONE = 0,
    OPMS_REFUSAL_STATE = 1,   /**< not in this state */
    OPMS_REFUSAL_LENGTH = 2,  /**< 2 to 6: what opms_wire_result_t says, plus one */
    OPMS_REFUSAL_ID = 3,
    OPMS_REFUSAL_VERSION = 4,
    OPMS_REFUSAL_CRC = 5,
    OPMS_REFUSAL_VALUE = 6,
    OPMS_REFUSAL_MAGIC = 7,   /**< BOOTLOADER without its magic word */
    OPMS_REFUSAL_FLASH = 8,   /**< the flash did not keep what was written */
    OPMS_REFUSAL_BUSY = 9     /**< the one before is still being carried out */
} opms_refusal_t;

/** 0x04 EVENT. */
typedef struct opms_event_report {
    opms_event_kind_t kind;
    opms_box_state_t state; /**< after the event */
    uint32_t boot_id;
    uint32_t session_id;
    uint32_t report_number;
    uint32_t event_number; /**< since start-up, from 1: a gap is a lost event */
    opms_box_time_t time;
    uint32_t argument;     /**< by kind */
    uint32_t detail;       /**< by kind, else 0 */
} opms_event_report_t;

/** Opcodes of 0x10 COMMAND. */
typedef enum opms_command_opcode {
    OPMS_COMMAND_PING = 1,  /**< argument: ping id */
    OPMS_COMMAND_ARM = 2,   /**< argument: session id, not 0; in IDLE only */
    OPMS_COMMAND_DISARM = 3 /**< software stop, in any state */
} opms_command_opcode_t;

/** 0x10 COMMAND. */
typedef struct opms_command_report {
    opms_command_opcode_t opcode;
    uint32_t argument;
} opms_command_report_t;

/** Capabilities in IDENTITY. */
enum {
    OPMS_CAPABILITY_STROBE = 1U << 0,
    OPMS_CAPABILITY_SYNC = 1U << 1,
    OPMS_CAPABILITY_HISTORY = 1U << 2,
    OPMS_CAPABILITY_BOOTLOADER = 1U << 3
};

/** 0x20 IDENTITY. */
typedef struct opms_identity_report {
    uint16_t hardware_version;
    uint8_t firmware_version[3]; /**< major, minor, patch */
    bool firmware_modified;      /**< built from a tree with uncommitted changes */
    uint16_t capabilities;       /**< OPMS_CAPABILITY_... */
    uint8_t unique_id[8];        /**< of the board's flash; the USB serial number is its hex */
    char git_hash[21];           /**< first 20 hex digits, NUL-terminated */
    uint32_t boot_id;
    uint32_t clock_hz;
    uint16_t start_cycles;       /**< start edge to first pulse beyond the debounce */
    uint16_t ring_entries;
    uint16_t history_entries;
} opms_identity_report_t;

/** What SYNC sends while RUNNING. */
typedef enum opms_sync_mode {
    OPMS_SYNC_OFF = 0,
    OPMS_SYNC_1HZ = 1,      /**< 1 Hz from the start edge on, each 100 ms high */
    OPMS_SYNC_RUN = 2       /**< high from the start edge to the stop */
} opms_sync_mode_t;

/** Settings of the box, kept in its flash. Ranges are those of opms_wire_check_settings(). */
typedef struct opms_settings {
    uint32_t period_us;       /**< 10,000 to 10,000,000; default 100,000 */
    uint32_t width_us;        /**< 10 to period - 1,000; default 1,000 */
    uint32_t debounce_cycles; /**< 0 to 1,250,000 (10 ms); default 125 (1 us) */
    bool trig_active_low;
    bool start_falling_edge;  /**< START is active low */
    bool strobe_enabled;      /**< a camera's exposure output is wired; else none is expected */
    bool strobe_active_low;
    opms_sync_mode_t sync;
    /** Gaps between the preamble's pulses in ms, 10 to 10,000; the first 0 ends the list. No gap
     * at all: no preamble. Default 100, 200, 100, 300, 100. No gap shorter than width + 1 ms. */
    uint16_t preamble_gap_ms[OPMS_BOX_PREAMBLE_MAX];
    uint16_t wait_timeout_s;  /**< in WAITING; 0 waits for ever (default) */
} opms_settings_t;

/** 0x21 SETTINGS, as it is read back. `settings` are those in force. */
typedef struct opms_settings_report {
    opms_settings_t settings;
    opms_refusal_t last_set;  /**< what became of the last SET; NONE if there was none */
    bool pending;             /**< a SET is being written; read again */
    bool stored;              /**< read from flash; false: the defaults, nothing valid was there */
    uint16_t settings_crc;    /**< opms_wire_settings_crc() of the settings in force */
} opms_settings_report_t;

/** 0x22 HISTORY, set: what to return next. */
typedef struct opms_history_request {
    uint16_t token;           /**< comes back with each entry; tells apart the hands that ask */
    uint32_t session_id;
    uint32_t first_number;    /**< from 1 */
    uint16_t count;           /**< 1 to 8192 */
} opms_history_request_t;

/** One pulse out of the box's memory. */
typedef struct opms_history_entry {
    uint32_t number;
    uint16_t flags; /**< OPMS_TRIGGER_...; with NOT_HELD all that follows is 0 */
    opms_box_time_t time;
    uint32_t strobe_delay_cycles; /**< by OPMS_TRIGGER_STROBE, from this pulse */
    uint32_t strobe_length_cycles;
} opms_history_entry_t;

/** 0x22 HISTORY, get. */
typedef struct opms_history_report {
    uint16_t token;        /**< of the selection; 0 if nothing was selected since start-up */
    uint32_t boot_id;
    uint32_t session_id;   /**< of the entries; 0 where the session asked for is not held */
    uint16_t remaining;    /**< entries of the selection that follow this report */
    uint32_t count;        /**< of entries, 0 to OPMS_HISTORY_PER_REPORT; 0 at the end */
    opms_history_entry_t entries[OPMS_HISTORY_PER_REPORT]; /**< consecutive numbers */
} opms_history_report_t;

/** CRC-16 with polynomial 0x1021, start value 0xFFFF, not reflected ("CRC-16/IBM-3740").
 * @since 0.2 */
OPMS_API uint16_t opms_wire_crc16(const uint8_t *bytes, size_t size);

/** Name of a result, e.g. "bad CRC"; for messages. @return Static storage. @since 0.2 */
OPMS_API const char *opms_wire_result_name(opms_wire_result_t result);

/** Name of a refusal, e.g. "not in this state". @return Static storage. @since 0.2 */
OPMS_API const char *opms_refusal_name(opms_refusal_t refusal);

/** Name of a state, e.g. "WAITING". @return Static storage. @since 0.2 */
OPMS_API const char *opms_box_state_name(opms_box_state_t state);

/** Name of an event's kind, e.g. "start refused". @return Static storage. @since 0.2 */
OPMS_API const char *opms_event_name(opms_event_kind_t kind);

/** The id of a report whose length, id, version and CRC are right.
 * @param bytes  `size` bytes; may be NULL when size is 0.
 * @param[out] id  The id where the result is OK; for others the first byte, or 0. May be NULL.
 * @since 0.2 */
OPMS_API opms_wire_result_t opms_wire_check(const uint8_t *bytes, size_t size, uint8_t *id);

/** Are the settings in their ranges?
 * @return NULL if so, else a message in static storage that names the field and its range.
 * @since 0.2 */
OPMS_API const char *opms_wire_check_settings(const opms_settings_t *settings);

/** Fill in the defaults. @since 0.2 */
OPMS_API void opms_wire_default_settings(opms_settings_t *settings);

/** CRC-16 of the settings as they stand on the wire: the same on both sides. @since 0.2 */
OPMS_API uint16_t opms_wire_settings_crc(const opms_settings_t *settings);

/** Structs to bytes. The struct must hold values of their ranges; `bytes` holds OPMS_WIRE_SIZE.
 * A gap that does not fit is written as 0; the settings' CRC is computed, not taken.
 * @since 0.2 */
OPMS_API void opms_wire_write_trigger(const opms_trigger_report_t *report, uint8_t *bytes);
OPMS_API void opms_wire_write_pong(const opms_pong_report_t *report, uint8_t *bytes);
OPMS_API void opms_wire_write_status(const opms_status_report_t *report, uint8_t *bytes);
OPMS_API void opms_wire_write_event(const opms_event_report_t *report, uint8_t *bytes);
OPMS_API void opms_wire_write_command(const opms_command_report_t *report, uint8_t *bytes);
OPMS_API void opms_wire_write_identity(const opms_identity_report_t *report, uint8_t *bytes);
/** What the box answers to a get. */
OPMS_API void opms_wire_write_settings(const opms_settings_report_t *report, uint8_t *bytes);
/** What the host sends with a set: the same layout, the box's fields 0. */
OPMS_API void opms_wire_write_settings_set(const opms_settings_t *settings, uint8_t *bytes);
OPMS_API void opms_wire_write_history_request(const opms_history_request_t *request,
                                              uint8_t *bytes);
OPMS_API void opms_wire_write_history(const opms_history_report_t *report, uint8_t *bytes);
OPMS_API void opms_wire_write_bootloader(uint8_t *bytes);

/** Bytes to structs. The output is written only where the result is OPMS_WIRE_OK; it may be NULL,
 * to check the report alone. `bytes` may be NULL: OPMS_WIRE_LENGTH.
 * @since 0.2 */
OPMS_API opms_wire_result_t opms_wire_read_trigger(const uint8_t *bytes, size_t size,
                                                   opms_trigger_report_t *report);
OPMS_API opms_wire_result_t opms_wire_read_pong(const uint8_t *bytes, size_t size,
                                                opms_pong_report_t *report);
OPMS_API opms_wire_result_t opms_wire_read_status(const uint8_t *bytes, size_t size,
                                                  opms_status_report_t *report);
OPMS_API opms_wire_result_t opms_wire_read_event(const uint8_t *bytes, size_t size,
                                                 opms_event_report_t *report);
OPMS_API opms_wire_result_t opms_wire_read_command(const uint8_t *bytes, size_t size,
                                                   opms_command_report_t *report);
OPMS_API opms_wire_result_t opms_wire_read_identity(const uint8_t *bytes, size_t size,
                                                    opms_identity_report_t *report);
OPMS_API opms_wire_result_t opms_wire_read_settings(const uint8_t *bytes, size_t size,
                                                    opms_settings_report_t *report);
OPMS_API opms_wire_result_t opms_wire_read_settings_set(const uint8_t *bytes, size_t size,
                                                        opms_settings_t *settings);
OPMS_API opms_wire_result_t opms_wire_read_history_request(const uint8_t *bytes, size_t size,
                                                           opms_history_request_t *request);
OPMS_API opms_wire_result_t opms_wire_read_history(const uint8_t *bytes, size_t size,
                                                   opms_history_report_t *report);
/** OPMS_WIRE_VALUE where the magic word is missing. */
OPMS_API opms_wire_result_t opms_wire_read_bootloader(const uint8_t *bytes, size_t size);

#ifdef __cplusplus
}
#endif
#endif
