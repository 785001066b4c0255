/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Ranges and defaults of the box's settings. */
#include <opms/wire.h>

enum {
    PERIOD_MIN_US = 10000,
    PERIOD_MAX_US = 10000000,
    WIDTH_MIN_US = 10,
    REST_MIN_US = 1000, /* TRIG is inactive for at least this long before the next pulse */
    DEBOUNCE_MAX_CYCLES = 1250000,
    GAP_MIN_MS = 10,
    GAP_MAX_MS = 10000
};

void opms_wire_default_settings(opms_settings_t *settings)
{
    const opms_settings_t defaults = {
        .period_us = 100000,
        .width_us = 1000,
        .debounce_cycles = 125,
        .sync = OPMS_SYNC_OFF,
        .preamble_gap_ms = {100, 200, 100, 300, 100},
    };
    *settings = defaults;
}

static const char *check_preamble(const opms_settings_t *settings)
{
    bool ended = false;
    for (unsigned i = 0; i < OPMS_BOX_PREAMBLE_MAX; i++) {
        const uint32_t gap_ms = settings->preamble_gap_ms[i];
        if (gap_ms == 0) {
            ended = true;
        } else if (ended) {
            return "preamble_gap_ms must be 0 after the first 0";
        } else if (gap_ms < GAP_MIN_MS || gap_ms > GAP_MAX_MS) {
            return "preamble_gap_ms must be 10 to 10000, or 0 at the end";
        } else if (gap_ms * 1000U < settings->width_us + REST_MIN_US) {
            return "preamble_gap_ms must be at least width_us + 1000 us";
        }
    }
    return NULL;
}

const char *opms_wire_check_settings(const opms_settings_t *settings)
{
    if (settings == NULL) {
        return "settings must not be NULL";
    }
    if (settings->period_us < PERIOD_MIN_US || settings->period_us > PERIOD_MAX_US) {
        return "period_us must be 10000 to 10000000";
    }
    if (settings->width_us < WIDTH_MIN_US ||
        settings->width_us > settings->period_us - REST_MIN_US) {
        return "width_us must be 10 to period_us - 1000";
    }
    if (settings->debounce_cycles > DEBOUNCE_MAX_CYCLES) {
        return "debounce_cycles must be 0 to 1250000";
    }
    if ((unsigned)settings->sync > OPMS_SYNC_RUN) {
        return "sync must be 0 (off), 1 (1 Hz) or 2 (high while running)";
    }
    return check_preamble(settings);
}
