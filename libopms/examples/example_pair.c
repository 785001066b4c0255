/* SPDX-License-Identifier: Apache-2.0 */
/* Pair the frames of a small recording with the triggers that exposed them.
 *
 * The recording: a preamble, a START, seven pulses of the run. One report was lost, one frame, and
 * one frame came twice. Camera with frame ids and time stamps; times in ms of the box. */
#include <stdio.h>

#include <opms/opms.h>

#define MS 1000000LL
#define HOST_LESS_BOX_NS (5000 * MS) /* found by the pings */

typedef struct recorded {
    char kind; /* t: trigger report, f: frame */
    uint32_t number;
    int64_t box_ms; /* of the pulse; of the exposure */
} recorded_t;

static const recorded_t recording[] = {
    {'t', 1, 9000}, {'f', 501, 9000}, {'t', 2, 9100},  {'f', 502, 9100}, {'t', 3, 9300},
    {'f', 503, 9300}, {'t', 4, 9400}, {'f', 504, 9400}, {'t', 5, 9700}, {'f', 505, 9700},
    {'t', 6, 9800}, {'f', 506, 9800}, {'t', 7, 11000}, {'f', 507, 11000}, {'f', 508, 11100},
    {'t', 9, 11200}, {'f', 509, 11200}, {'t', 10, 11300}, {'t', 11, 11400}, {'f', 511, 11400},
    {'f', 511, 11400}, {'t', 12, 11500}, {'f', 512, 11500}, {'t', 13, 11600}, {'f', 513, 11600},
};

static opms_status_t push(opms_pairer_t *pairer, const recorded_t *entry, int64_t before_ms,
                          opms_error_t *err)
{
    const int64_t host_ns = entry->box_ms * MS + HOST_LESS_BOX_NS;
    if (entry->kind == 'f') {
        const opms_frame_t frame = {.frame_id = entry->number,
                                    .camera_time_ticks = (uint64_t)(entry->box_ms + 77) * 1000,
                                    .arrival_host_ns = host_ns + 28 * MS};
        return opms_pairer_push_frame(pairer, &frame, err);
    }
    opms_trigger_report_t report = {.boot_id = 1, .session_id = 1};
    report.flags = entry->number <= 6 ? OPMS_TRIGGER_PREAMBLE : OPMS_TRIGGER_RUN;
    report.trigger_number = entry->number;
    report.time.us = (uint64_t)entry->box_ms * 1000;
    report.first_run_number = entry->number > 6 ? 7 : 0;
    report.start_edge.us = entry->number > 6 ? 11000 * 1000 - 1 : 0;
    report.gap_us[0] = before_ms > 0 ? (uint32_t)before_ms * 1000 : 0;
    return opms_pairer_push_trigger(pairer, &report, host_ns + MS, err);
}

/** What the box said to ten pings: its clock on the host's. */
static opms_status_t push_pings(opms_pairer_t *pairer, opms_error_t *err)
{
    opms_status_t status = OPMS_OK;
    for (int i = 0; i < 10 && status == OPMS_OK; ++i) {
        const int64_t at = (8000 + i * 90) * MS;
        opms_pong_report_t pong = {.boot_id = 1, .ping_id = (uint32_t)i};
        pong.received.us = pong.sent.us = (uint64_t)(at / 1000);
        status = opms_pairer_push_pong(pairer, at + HOST_LESS_BOX_NS - MS / 2, &pong,
                                       at + HOST_LESS_BOX_NS + MS / 2, err);
    }
    return status;
}

static void print(const opms_pair_result_t *result)
{
    if (result->trigger_state == OPMS_TRIGGER_PAIRED) {
        printf("frame %llu: trigger %llu", (unsigned long long)result->frame.frame_id,
               (unsigned long long)result->trigger_number);
        if (result->known & OPMS_PAIR_HAS_START_EDGE) {
            printf(", %.3f ms after the start",
                   (double)(result->trigger_box_ns - result->start_edge_box_ns) / 1e6);
        }
        printf(", witnesses 0x%x\n", (unsigned)result->witnesses);
    } else if (result->trigger_state != OPMS_TRIGGER_NONE) {
        printf("trigger %llu: %s\n", (unsigned long long)result->trigger_number,
               opms_trigger_state_name(result->trigger_state));
    } else {
        printf("frame %llu: %s\n", (unsigned long long)result->frame.frame_id,
               opms_frame_state_name(result->frame_state));
    }
}

int main(void)
{
    opms_pair_options_t options;
    opms_pair_options_init(&options);
    options.camera.has_camera_time = 1;
    options.camera.camera_time_bits = 64;
    options.camera.camera_tick_hz = 1000000;
    opms_settings_t settings;
    opms_wire_default_settings(&settings);
    opms_pairer_t *pairer = NULL;
    opms_error_t err;

    opms_status_t status = opms_pairer_create(&options, &pairer, &err);
    if (status == OPMS_OK) {
        status = push_pings(pairer, &err);
    }
    if (status == OPMS_OK) {
        status = opms_pairer_open(pairer, 1, 1, &settings, &err);
    }
    int64_t last_ms = 0; /* of the pulse that was reported last */
    for (size_t i = 0; i < sizeof recording / sizeof recording[0] && status == OPMS_OK; ++i) {
        const recorded_t *entry = &recording[i];
        const int is_report = entry->kind == 't';
        const int64_t before_ms = entry->number == 9 ? 100 : entry->box_ms - last_ms;
        status = push(pairer, entry, is_report && last_ms > 0 ? before_ms : 0, &err);
        last_ms = is_report ? entry->box_ms : last_ms;
    }
    if (status == OPMS_OK) {
        status = opms_pairer_close(pairer, &err);
    }
    uint32_t count = status == OPMS_OK;
    opms_pair_result_t result;
    while (count > 0 && opms_pairer_poll(pairer, &result, 1, &count, &err) == OPMS_OK &&
           count > 0) {
        print(&result);
    }
    if (status != OPMS_OK) {
        fprintf(stderr, "%s: %s\n", err.stage, err.message);
        opms_pairer_destroy(pairer);
        return 1;
    }
    opms_pair_summary_t summary;
    opms_pairer_summary(pairer, &summary);
    printf("%s\n", summary.line);
    opms_pairer_destroy(pairer);
    return summary.counters.triggers_paired == 12 && summary.sums_hold ? 0 : 1;
}
