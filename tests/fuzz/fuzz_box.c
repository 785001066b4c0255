/* SPDX-License-Identifier: Apache-2.0 */
/* Any host and any sequence of edges against the box's logic: whatever is asked, every report that
 * comes out reads, nothing that touches the flash is done outside IDLE, and each pulse is told by a
 * TRIGGER or counted as dropped.
 *
 * The bytes are a script: one byte what happens (enum step), then its operands. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "box.h"

typedef struct script {
    const uint8_t *data;
    size_t size;
} script_t;

static box_t box;
static box_cycles_t now;
static bool armed;          /* the hardware is */
static uint32_t pulses;     /* of the session */
static uint64_t all_pulses; /* of all sessions, lost ones included */
static uint64_t told;       /* by TRIGGER reports */
static uint32_t last_report, last_trigger, trigger_session;

static void require(bool holds)
{
    if (!holds) {
        abort();
    }
}

static uint8_t take(script_t *script)
{
    if (script->size == 0) {
        return 0;
    }
    script->size--;
    return *script->data++;
}

static uint32_t take32(script_t *script)
{
    uint32_t value = 0;
    for (unsigned i = 0; i < 4; i++) {
        value = value << 8 | take(script);
    }
    return value;
}

/* --- the host --------------------------------------------------------------------------------- */

static void seal(uint8_t *bytes)
{
    bytes[1] = OPMS_WIRE_PROTOCOL;
    const uint16_t crc = opms_wire_crc16(bytes, OPMS_WIRE_SIZE - 2);
    bytes[OPMS_WIRE_SIZE - 2] = (uint8_t)crc;
    bytes[OPMS_WIRE_SIZE - 1] = (uint8_t)(crc >> 8);
}

/* In a block of its own, so that a sanitizer sees a byte read beyond. */
static void send(script_t *script, bool feature, bool sealed)
{
    const size_t size = sealed ? OPMS_WIRE_SIZE : take(script) % (OPMS_WIRE_SIZE + 20U);
    const size_t given = sealed ? take(script) % OPMS_WIRE_SIZE : size;
    uint8_t *bytes = calloc(size + (size == 0), 1);
    require(bytes != NULL);
    for (size_t i = 0; i < given; i++) {
        bytes[i] = take(script);
    }
    if (sealed) {
        seal(bytes);
    }
    if (feature) {
        box_set_feature(&box, bytes, size, now);
    } else {
        box_command(&box, bytes, size, now);
    }
    free(bytes);
}

static void send_command(script_t *script)
{
    const opms_command_report_t command = {(opms_command_opcode_t)(1 + take(script) % 3),
                                           take(script)};
    uint8_t bytes[OPMS_WIRE_SIZE];
    opms_wire_write_command(&command, bytes);
    box_command(&box, bytes, sizeof bytes, now);
}

static void get_feature(uint8_t id)
{
    uint8_t bytes[OPMS_WIRE_SIZE];
    if (!box_get_feature(&box, id, bytes)) {
        return;
    }
    opms_wire_result_t result = OPMS_WIRE_ID;
    if (id == OPMS_REPORT_IDENTITY) {
        result = opms_wire_read_identity(bytes, sizeof bytes, NULL);
    } else if (id == OPMS_REPORT_SETTINGS) {
        result = opms_wire_read_settings(bytes, sizeof bytes, NULL);
    } else if (id == OPMS_REPORT_HISTORY) {
        result = opms_wire_read_history(bytes, sizeof bytes, NULL);
    }
    require(result == OPMS_WIRE_OK);
}

static void check_trigger(const uint8_t *bytes, uint32_t *number)
{
    opms_trigger_report_t trigger;
    require(opms_wire_read_trigger(bytes, OPMS_WIRE_SIZE, &trigger) == OPMS_WIRE_OK);
    if (trigger.session_id == trigger_session) {
        require(trigger.trigger_number > last_trigger);
    }
    trigger_session = trigger.session_id;
    last_trigger = trigger.trigger_number;
    told++;
    *number = trigger.report_number;
}

static bool take_report(void)
{
    uint8_t bytes[OPMS_WIRE_SIZE];
    if (!box_next_report(&box, now, bytes)) {
        return false;
    }
    uint32_t number = 0;
    opms_pong_report_t pong;
    opms_status_report_t status;
    opms_event_report_t event;
    if (bytes[0] == OPMS_REPORT_TRIGGER) {
        check_trigger(bytes, &number);
    } else if (opms_wire_read_pong(bytes, sizeof bytes, &pong) == OPMS_WIRE_OK) {
        number = pong.report_number;
    } else if (opms_wire_read_status(bytes, sizeof bytes, &status) == OPMS_WIRE_OK) {
        number = status.report_number;
    } else {
        require(opms_wire_read_event(bytes, sizeof bytes, &event) == OPMS_WIRE_OK);
        number = event.report_number;
    }
    require(number == ++last_report);
    return true;
}

/* --- the hardware ----------------------------------------------------------------------------- */

static void tell(box_input_kind_t kind, box_cycles_t ago, uint32_t length)
{
    const box_input_t input = {kind, now - (ago < now ? ago : now), pulses, length};
    box_input(&box, &input);
}

static void pulse(uint8_t lost)
{
    if (!armed || box_state(&box) < OPMS_BOX_PREAMBLE) {
        return;
    }
    pulses += 1U + lost;
    all_pulses += 1U + lost;
    tell(BOX_INPUT_PULSE, 0, 0);
}

static void act(bool flash_keeps)
{
    const uint32_t actions = box_take_actions(&box);
    const uint32_t flash_work = BOX_DO_STORE_SETTINGS | BOX_DO_BOOTLOADER;
    require((actions & flash_work) == 0 || box_state(&box) == OPMS_BOX_IDLE);
    if ((actions & BOX_DO_ARM) != 0) {
        require(!armed && box_state(&box) == OPMS_BOX_ARMED);
        armed = true;
        pulses = 0;
        trigger_session = 0; /* the host may give the same id again */
        tell(BOX_INPUT_ARMED, 0, 0);
    }
    if ((actions & BOX_DO_STOP) != 0) {
        require(armed);
        armed = false;
        tell(BOX_INPUT_STOPPED, 0, 0);
        require(box_state(&box) == OPMS_BOX_IDLE);
    }
    if ((actions & BOX_DO_STORE_SETTINGS) != 0) {
        require(opms_wire_check_settings(box_settings_to_store(&box)) == NULL);
        box_stored(&box, flash_keeps, now);
    }
}

static void pass(uint32_t cycles)
{
    now += cycles;
    box_tick(&box, now);
}

/* --- the script ------------------------------------------------------------------------------- */

enum step {
    STEP_COMMAND,
    STEP_COMMAND_BYTES,
    STEP_COMMAND_SEALED,
    STEP_FEATURE_BYTES,
    STEP_FEATURE_SEALED,
    STEP_GET,
    STEP_PASS,
    STEP_PULSE,
    STEP_START,
    STEP_GLITCH,
    STEP_STROBE,
    STEP_ACT,
    STEP_REPORTS,
    STEP_HEAL,
    STEPS
};

static void run_step(script_t *script)
{
    switch (take(script) % STEPS) {
    case STEP_COMMAND: send_command(script); break;
    case STEP_COMMAND_BYTES: send(script, false, false); break;
    case STEP_COMMAND_SEALED: send(script, false, true); break;
    case STEP_FEATURE_BYTES: send(script, true, false); break;
    case STEP_FEATURE_SEALED: send(script, true, true); break;
    case STEP_GET: get_feature(take(script)); break;
    case STEP_PASS: pass(take32(script)); break;
    case STEP_PULSE: pulse(take(script) % 4); break;
    case STEP_START: tell(BOX_INPUT_START, take(script), 0); break;
    case STEP_GLITCH: tell(BOX_INPUT_GLITCH, take(script), take(script)); break;
    case STEP_STROBE: tell(BOX_INPUT_STROBE, take32(script), take(script)); break;
    case STEP_ACT: act(take(script) % 4 != 0); break;
    case STEP_REPORTS:
        for (uint8_t count = take(script); count > 0 && take_report(); count--) {
        }
        break;
    case STEP_HEAL: box_endpoint_healed(&box, now); break;
    default: break;
    }
    require(opms_wire_check_settings(box_settings(&box)) == NULL);
    (void)box_led(&box, now);
}

static void power_on(bool strobe)
{
    const box_identity_t identity = {
        .report = {.git_hash = "0123456789abcdef0123", .boot_id = 1, .clock_hz = 125000000}};
    opms_settings_t settings;
    opms_wire_default_settings(&settings);
    settings.strobe_enabled = strobe;
    settings.wait_timeout_s = 10;
    box_init(&box, &identity, &settings);
    now = 1000;
    armed = false;
    pulses = 0;
    all_pulses = told = 0;
    last_report = last_trigger = trigger_session = 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    script_t script = {data, size};
    power_on(take(&script) % 2 != 0);
    while (script.size > 0) {
        run_step(&script);
    }
    pass(1000); /* a pulse that is held for its successor is let go */
    while (take_report()) {
    }
    require(!box_has_report(&box));
    require(told + box.dropped == all_pulses);
    return 0;
}
