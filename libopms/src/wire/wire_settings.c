/* SPDX-License-Identifier: Apache-2.0 */
#include "wire_bytes.h"
#include "wire_frame.h"

enum {
    LAST_SET = 2,
    FLAGS = 3,
    PERIOD_US = 4,
    WIDTH_US = 8,
    DEBOUNCE = 12,
    LINES = 16,
    SYNC = 17,
    WAIT_TIMEOUT = 18,
    PREAMBLE = 20,
    SETTINGS_CRC = 36
};

enum { FLAG_PENDING = 1U << 0, FLAG_STORED = 1U << 1 };

enum {
    LINE_TRIG_LOW = 1U << 0,
    LINE_START_FALLING = 1U << 1,
    LINE_STROBE = 1U << 2,
    LINE_STROBE_LOW = 1U << 3
};

static uint8_t line_bits(const opms_settings_t *settings)
{
    return (uint8_t)((settings->trig_active_low ? LINE_TRIG_LOW : 0U) |
                     (settings->start_falling_edge ? LINE_START_FALLING : 0U) |
                     (settings->strobe_enabled ? LINE_STROBE : 0U) |
                     (settings->strobe_active_low ? LINE_STROBE_LOW : 0U));
}

static void put_settings(uint8_t *bytes, const opms_settings_t *settings)
{
    put_u32(bytes + PERIOD_US, settings->period_us);
    put_u32(bytes + WIDTH_US, settings->width_us);
    put_u32(bytes + DEBOUNCE, settings->debounce_cycles);
    bytes[LINES] = line_bits(settings);
    bytes[SYNC] = (uint8_t)settings->sync;
    put_u16(bytes + WAIT_TIMEOUT, settings->wait_timeout_s);
    for (unsigned i = 0; i < OPMS_BOX_PREAMBLE_MAX; i++) {
        put_u16(bytes + PREAMBLE + 2 * i, settings->preamble_gap_ms[i]);
    }
}

static opms_settings_t decode_settings(const uint8_t *bytes)
{
    opms_settings_t settings = {
        .period_us = get_u32(bytes + PERIOD_US),
        .width_us = get_u32(bytes + WIDTH_US),
        .debounce_cycles = get_u32(bytes + DEBOUNCE),
        .trig_active_low = (bytes[LINES] & LINE_TRIG_LOW) != 0,
        .start_falling_edge = (bytes[LINES] & LINE_START_FALLING) != 0,
        .strobe_enabled = (bytes[LINES] & LINE_STROBE) != 0,
        .strobe_active_low = (bytes[LINES] & LINE_STROBE_LOW) != 0,
        .sync = (opms_sync_mode_t)bytes[SYNC],
        .wait_timeout_s = get_u16(bytes + WAIT_TIMEOUT),
    };
    for (unsigned i = 0; i < OPMS_BOX_PREAMBLE_MAX; i++) {
        settings.preamble_gap_ms[i] = get_u16(bytes + PREAMBLE + 2 * i);
    }
    return settings;
}

static uint16_t crc_of(const uint8_t *bytes)
{
    return opms_wire_crc16(bytes + PERIOD_US, SETTINGS_CRC - PERIOD_US);
}

uint16_t opms_wire_settings_crc(const opms_settings_t *settings)
{
    uint8_t bytes[OPMS_WIRE_SIZE];
    put_settings(bytes, settings);
    return crc_of(bytes);
}

void opms_wire_write_settings(const opms_settings_report_t *report, uint8_t *bytes)
{
    wire_begin(bytes, OPMS_REPORT_SETTINGS);
    bytes[LAST_SET] = (uint8_t)report->last_set;
    bytes[FLAGS] =
        (uint8_t)((report->pending ? FLAG_PENDING : 0U) | (report->stored ? FLAG_STORED : 0U));
    put_settings(bytes, &report->settings);
    put_u16(bytes + SETTINGS_CRC, crc_of(bytes));
    wire_seal(bytes);
}

void opms_wire_write_settings_set(const opms_settings_t *settings, uint8_t *bytes)
{
    wire_begin(bytes, OPMS_REPORT_SETTINGS);
    put_settings(bytes, settings);
    wire_seal(bytes);
}

opms_wire_result_t opms_wire_read_settings(const uint8_t *bytes, size_t size,
                                           opms_settings_report_t *report)
{
    const opms_wire_result_t result = wire_open(bytes, size, OPMS_REPORT_SETTINGS);
    if (result != OPMS_WIRE_OK) {
        return result;
    }
    if (bytes[LAST_SET] > OPMS_REFUSAL_BUSY || bytes[SYNC] > OPMS_SYNC_RUN) {
        return OPMS_WIRE_VALUE;
    }
    const opms_settings_report_t got = {
        .settings = decode_settings(bytes),
        .last_set = (opms_refusal_t)bytes[LAST_SET],
        .pending = (bytes[FLAGS] & FLAG_PENDING) != 0,
        .stored = (bytes[FLAGS] & FLAG_STORED) != 0,
        .settings_crc = get_u16(bytes + SETTINGS_CRC),
    };
    uint8_t again[OPMS_WIRE_SIZE];
    opms_wire_write_settings(&got, again);
    if (opms_wire_check_settings(&got.settings) != NULL || !wire_same(bytes, again)) {
        return OPMS_WIRE_VALUE;
    }
    if (report != NULL) {
        *report = got;
    }
    return OPMS_WIRE_OK;
}

opms_wire_result_t opms_wire_read_settings_set(const uint8_t *bytes, size_t size,
                                               opms_settings_t *settings)
{
    const opms_wire_result_t result = wire_open(bytes, size, OPMS_REPORT_SETTINGS);
    if (result != OPMS_WIRE_OK) {
        return result;
    }
    if (bytes[SYNC] > OPMS_SYNC_RUN) {
        return OPMS_WIRE_VALUE;
    }
    const opms_settings_t got = decode_settings(bytes);
    uint8_t again[OPMS_WIRE_SIZE];
    opms_wire_write_settings_set(&got, again);
    if (opms_wire_check_settings(&got) != NULL || !wire_same(bytes, again)) {
        return OPMS_WIRE_VALUE;
    }
    if (settings != NULL) {
        *settings = got;
    }
    return OPMS_WIRE_OK;
}
