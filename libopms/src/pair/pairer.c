/* SPDX-License-Identifier: Apache-2.0 */
/* A pairer's life: memory, sessions, time, results. */
#include <string.h>

#include "base/fail.h"
#include "base/memory.h"
#include "pair/intake.h"
#include "pair/pairer_state.h"
#include "pair/settle.h"

#define STAGE "pair"
#define SETTLE_PERIODS 20        /* a lock needs some frames, and a pair the ones after it */
#define SETTLE_MAX_NS 2000000000
#define SLOTS_MIN 1024

void opms_pair_options_init(opms_pair_options_t *options)
{
    if (options) {
        memset(options, 0, sizeof *options);
        options->struct_size = sizeof *options;
        options->max_wait_ms = 6000;
        options->min_period_us = 10000;
        options->first_number = 1;
        options->camera.has_frame_id = 1;
        options->camera.frame_id_bits = 64;
    }
}

static opms_status_t check_camera(const opms_camera_profile_t *camera, opms_error_t *err)
{
    if (camera->has_frame_id && (camera->frame_id_bits < 8 || camera->frame_id_bits > 64)) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "frame_id_bits is %u, allowed is 8 to 64",
                         (unsigned)camera->frame_id_bits);
    }
    if (!camera->has_camera_time) {
        return OPMS_OK;
    }
    if (camera->camera_time_bits < 16 || camera->camera_time_bits > 64) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "camera_time_bits is %u, allowed is 16 to 64",
                         (unsigned)camera->camera_time_bits);
    }
    if (camera->camera_tick_hz < 1000 || camera->camera_tick_hz > 10000000000) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "camera_tick_hz is %llu, allowed is 1000 to 10000000000",
                         (unsigned long long)camera->camera_tick_hz);
    }
    return OPMS_OK;
}

static opms_status_t check_options(const opms_pair_options_t *options, opms_error_t *err)
{
    if (options->struct_size != sizeof *options) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "options.struct_size is %u, this library needs %u",
                         (unsigned)options->struct_size, (unsigned)sizeof *options);
    }
    if (options->max_wait_ms < 100 || options->max_wait_ms > 60000) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "max_wait_ms is %u, allowed is 100 to 60000",
                         (unsigned)options->max_wait_ms);
    }
    if (options->min_period_us < 10000 || options->min_period_us > 10000000) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "min_period_us is %u, allowed is 10000 to 10000000",
                         (unsigned)options->min_period_us);
    }
    OPMS_TRY(opms_check_allocator(&options->allocator, STAGE, err));
    return check_camera(&options->camera, err);
}

/** How many triggers can wait at once, as a power of two. */
static uint32_t slots_for(const opms_pair_options_t *options)
{
    const uint64_t longest_us = (uint64_t)options->max_wait_ms * 1000 + SETTLE_MAX_NS / 1000;
    const uint64_t waiting = longest_us / options->min_period_us + 64;
    uint32_t slots = SLOTS_MIN;
    while (slots < waiting) {
        slots *= 2;
    }
    return slots;
}

static opms_status_t allocate(opms_pairer_t *pairer, uint32_t slots, opms_error_t *err)
{
    const opms_allocator_t *allocator = &pairer->options.allocator;
    opms_clock_options_t clock_options;
    opms_clock_options_init(&clock_options);
    clock_options.allocator = *allocator;
    pairer->jump_max = slots / 2;
    /* All that can wait, and the most that one push brings twice over. */
    pairer->results.capacity = 2 * slots + 4 * (pairer->jump_max + 2);
    pairer->triggers.mask = (int64_t)slots - 1;
    pairer->frames.mask = slots - 1;
    pairer->triggers.slots = opms_take(allocator, slots * sizeof *pairer->triggers.slots);
    pairer->frames.slots = opms_take(allocator, slots * sizeof *pairer->frames.slots);
    pairer->results.slots =
        opms_take(allocator, pairer->results.capacity * sizeof *pairer->results.slots);
    if (!pairer->triggers.slots || !pairer->frames.slots || !pairer->results.slots) {
        return opms_fail(err, OPMS_ERR_MEMORY, STAGE, -1, "no memory for %u triggers and frames",
                         (unsigned)slots);
    }
    return opms_clock_create(&clock_options, &pairer->clock, err);
}

opms_status_t opms_pairer_create(const opms_pair_options_t *options, opms_pairer_t **pairer,
                                 opms_error_t *err)
{
    if (!pairer) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "pairer is NULL");
    }
    opms_pair_options_t chosen;
    opms_pair_options_init(&chosen);
    if (options) {
        OPMS_TRY(check_options(options, err));
        chosen = *options;
    }
    opms_pairer_t *fresh = opms_take(&chosen.allocator, sizeof *fresh);
    if (!fresh) {
        return opms_fail(err, OPMS_ERR_MEMORY, STAGE, -1, "no memory for a pairer (%zu bytes)",
                         sizeof *fresh);
    }
    fresh->options = chosen;
    fresh->max_wait_ns = (int64_t)chosen.max_wait_ms * 1000000;
    const opms_status_t status = allocate(fresh, slots_for(&chosen), err);
    if (status != OPMS_OK) {
        opms_pairer_destroy(fresh);
        return status;
    }
    *pairer = fresh;
    return OPMS_OK;
}

void opms_pairer_destroy(opms_pairer_t *pairer)
{
    if (!pairer) {
        return;
    }
    const opms_allocator_t *allocator = &pairer->options.allocator;
    opms_clock_destroy(pairer->clock);
    opms_give_back(allocator, pairer->triggers.slots);
    opms_give_back(allocator, pairer->frames.slots);
    opms_give_back(allocator, pairer->results.slots);
    opms_give_back(allocator, pairer);
}

/** The shortest gap between two triggers that these settings make. */
static int64_t shortest_gap_ns(const opms_settings_t *settings)
{
    int64_t least_us = settings->period_us;
    for (int i = 0; i < OPMS_BOX_PREAMBLE_MAX && settings->preamble_gap_ms[i] > 0; ++i) {
        const int64_t gap_us = (int64_t)settings->preamble_gap_ms[i] * 1000;
        least_us = gap_us < least_us ? gap_us : least_us;
    }
    return least_us * 1000;
}

static opms_status_t check_open(const opms_pairer_t *pairer, uint32_t boot_id,
                                uint32_t session_id, const opms_settings_t *settings,
                                opms_error_t *err)
{
    if (!pairer || !settings) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL",
                         pairer ? "settings" : "pairer");
    }
    if (pairer->state != OPMS_PAIR_CLOSED) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "session %u is open: close it first",
                         (unsigned)pairer->session_id);
    }
    if (boot_id == 0 || session_id == 0) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is 0",
                         boot_id == 0 ? "boot_id" : "session_id");
    }
    const char *wrong = opms_wire_check_settings(settings);
    if (wrong) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "settings: %s", wrong);
    }
    if (shortest_gap_ns(settings) < (int64_t)pairer->options.min_period_us * 1000) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "settings: triggers every %lld us, the pairer was made for min_period_us "
                         "of %u",
                         (long long)(shortest_gap_ns(settings) / 1000),
                         (unsigned)pairer->options.min_period_us);
    }
    return OPMS_OK;
}

/** Nothing but counters, clock and arrival delays passes from one session to the next. */
static void forget_session(opms_pairer_t *pairer)
{
    const opms_camera_profile_t *camera = &pairer->options.camera;
    pairer->ended = 0;
    pairer->start_edge_box_ns = 0;
    pairer->recent_count = 0;
    pairer->supported_count = 0;
    memset(pairer->sightings, 0, sizeof pairer->sightings);
    pairer->lock = (pair_lock_t){0};
    for (int i = 0; i < PAIR_SEGMENTS; ++i) {
        pairer->lock.segments[i] = (pair_segment_t){0, 0, -1};
    }
    pairer->camera = (pair_camera_clock_t){0};
    pairer->id_unwrap = (pair_unwrap_t){.bits = camera->frame_id_bits,
                                        .skips_0 = camera->frame_id_skips_0};
    pairer->tick_unwrap = (pair_unwrap_t){.bits = camera->camera_time_bits};
    pair_ring_start(&pairer->triggers, (int64_t)pairer->options.first_number);
}

opms_status_t opms_pairer_open(opms_pairer_t *pairer, uint32_t boot_id, uint32_t session_id,
                               const opms_settings_t *settings, opms_error_t *err)
{
    OPMS_TRY(check_open(pairer, boot_id, session_id, settings, err));
    forget_session(pairer);
    if (pairer->clock_boot_id != boot_id) {
        opms_clock_reset(pairer->clock);
        pairer->clock_boot_id = boot_id;
    }
    pairer->boot_id = boot_id;
    pairer->session_id = session_id;
    pairer->period_ns = (int64_t)settings->period_us * 1000;
    pairer->min_gap_ns = shortest_gap_ns(settings);
    pairer->settle_ns = SETTLE_PERIODS * pairer->period_ns < SETTLE_MAX_NS
                            ? SETTLE_PERIODS * pairer->period_ns
                            : SETTLE_MAX_NS;
    pairer->state = OPMS_PAIR_SEARCHING;
    return OPMS_OK;
}

opms_status_t opms_pairer_advance(opms_pairer_t *pairer, int64_t now_host_ns, opms_error_t *err)
{
    if (!pairer) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "pairer is NULL");
    }
    OPMS_TRY(pair_check_time(now_host_ns, "now_host_ns", err));
    pair_go_on(pairer, now_host_ns);
    return OPMS_OK;
}

opms_status_t opms_pairer_close(opms_pairer_t *pairer, opms_error_t *err)
{
    if (!pairer || pairer->state == OPMS_PAIR_CLOSED) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s",
                         pairer ? "no session is open" : "pairer is NULL");
    }
    pair_settle_expired(pairer, 1);
    pairer->state = OPMS_PAIR_CLOSED;
    pairer->boot_id = 0;
    pairer->session_id = 0;
    opms_pair_summary_t summary;
    opms_pairer_summary(pairer, &summary);
    if (!summary.sums_hold || summary.counters.triggers_pending > 0 ||
        summary.counters.frames_pending > 0) {
        return opms_fail(err, OPMS_ERR_INTERNAL, STAGE, -1, "sums do not hold: %s", summary.line);
    }
    return OPMS_OK;
}

opms_status_t opms_pairer_poll(opms_pairer_t *pairer, opms_pair_result_t *results,
                               uint32_t capacity, uint32_t *count, opms_error_t *err)
{
    if (!pairer || !count || (!results && capacity > 0)) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL",
                         !pairer ? "pairer" : !count ? "count" : "results");
    }
    pair_results_t *queue = &pairer->results;
    uint32_t taken = 0;
    while (taken < capacity && queue->count > 0) {
        results[taken++] = queue->slots[queue->first];
        queue->first = (queue->first + 1) % queue->capacity;
        --queue->count;
    }
    *count = taken;
    return OPMS_OK;
}

const opms_clock_t *opms_pairer_clock(const opms_pairer_t *pairer)
{
    return pairer ? pairer->clock : NULL;
}
