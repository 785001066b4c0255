/* SPDX-License-Identifier: Apache-2.0 */
#include "pair_scene.h"

#include <string.h>

#include <unity.h>

static const int64_t starts_ms[PREAMBLE] = {0, 100, 300, 400, 700, 800};

opms_pair_options_t scene_options(pair_kind_t kind)
{
    opms_pair_options_t options;
    opms_pair_options_init(&options);
    options.camera.has_camera_time = kind == STAMP_AND_STROBE || kind == STAMP_ONLY;
    options.camera.camera_time_bits = 64;
    options.camera.camera_tick_hz = 1000000000;
    options.camera.has_strobe = kind == STAMP_AND_STROBE || kind == STROBE_ONLY;
    return options;
}

opms_settings_t scene_settings(void)
{
    opms_settings_t settings;
    opms_wire_default_settings(&settings);
    return settings;
}

void scene_ping(pair_scene_t *scene, uint32_t boot_id, int64_t from_box_ns, int count)
{
    for (int i = 0; i < count; ++i) {
        const int64_t at = from_box_ns + i * 100 * MS;
        opms_pong_report_t pong = {.boot_id = boot_id, .ping_id = (uint32_t)i};
        pong.received.us = (uint64_t)(at / 1000);
        pong.sent.us = (uint64_t)(at / 1000) + 20;
        TEST_ASSERT_EQUAL(OPMS_OK, opms_pairer_push_pong(scene->pairer,
                                                         at + HOST_LESS_BOX_NS - 300000, &pong,
                                                         at + HOST_LESS_BOX_NS + 320000, NULL));
    }
}

void scene_open(pair_scene_t *scene, uint32_t boot_id, uint32_t session_id)
{
    const opms_settings_t settings = scene_settings();
    opms_error_t err = {OPMS_OK, 0, "", ""};
    TEST_ASSERT_EQUAL_MESSAGE(
        OPMS_OK, opms_pairer_open(scene->pairer, boot_id, session_id, &settings, &err),
        err.message);
}

void scene_start_with(pair_scene_t *scene, pair_kind_t kind, const opms_pair_options_t *options)
{
    memset(scene, 0, sizeof *scene);
    scene->kind = kind;
    scene->first_number = options->first_number;
    scene->start_ns = 20000 * MS;
    opms_error_t err = {OPMS_OK, 0, "", ""};
    TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK, opms_pairer_create(options, &scene->pairer, &err),
                              err.message);
    scene_ping(scene, BOOT, scene->start_ns - 3000 * MS, 20);
    scene_open(scene, BOOT, SESSION);
}

void scene_start(pair_scene_t *scene, pair_kind_t kind)
{
    const opms_pair_options_t options = scene_options(kind);
    scene_start_with(scene, kind, &options);
}

void scene_end(pair_scene_t *scene)
{
    opms_pairer_destroy(scene->pairer);
    scene->pairer = NULL;
}

int64_t scene_trigger_ns(const pair_scene_t *scene, int n)
{
    const int64_t ms = n <= PREAMBLE ? starts_ms[n - 1] : 1370 + (n - PREAMBLE - 1) * 100;
    return scene->start_ns + ms * MS;
}

static opms_box_time_t to_box(int64_t ns)
{
    const opms_box_time_t time = {(uint64_t)(ns / 1000), (uint8_t)(ns % 1000 / 8)};
    return time;
}

opms_trigger_report_t scene_report(const pair_scene_t *scene, int n)
{
    opms_trigger_report_t report = {
        .flags = n <= PREAMBLE ? OPMS_TRIGGER_PREAMBLE : OPMS_TRIGGER_RUN,
        .boot_id = BOOT,
        .session_id = SESSION,
        .report_number = (uint32_t)n,
        .trigger_number = scene->first_number + (uint32_t)n - 1,
        .time = to_box(scene_trigger_ns(scene, n)),
    };
    if (n > PREAMBLE) {
        report.first_run_number = scene->first_number + PREAMBLE;
        report.start_edge = to_box(scene_trigger_ns(scene, PREAMBLE + 1) - 1032);
    }
    for (int i = 0; i < 2 && n - i > 1; ++i) {
        report.gap_us[i] = (uint32_t)((scene_trigger_ns(scene, n - i) -
                                       scene_trigger_ns(scene, n - i - 1)) / 1000);
    }
    if (n > 1 && (scene->kind == STAMP_AND_STROBE || scene->kind == STROBE_ONLY)) {
        report.flags |= OPMS_TRIGGER_STROBE;
        report.strobe_for_trigger = report.trigger_number - 1;
        report.strobe_delay_cycles = 1250;    /* 10 us */
        report.strobe_length_cycles = 500000; /* 4 ms */
    }
    return report;
}

opms_frame_t scene_frame(const pair_scene_t *scene, int n)
{
    const int64_t at = scene_trigger_ns(scene, n);
    const opms_frame_t frame = {.frame_id = (uint64_t)(n + ID_LESS_NUMBER),
                                .camera_time_ticks = (uint64_t)(at + CAMERA_LESS_BOX_NS),
                                .arrival_host_ns = at + HOST_LESS_BOX_NS + FRAME_DELAY_NS,
                                .tag = (uint64_t)n};
    return frame;
}

static void poll(pair_scene_t *scene)
{
    uint32_t count = 0;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pairer_poll(scene->pairer, scene->results + scene->count,
                                                RESULTS_MAX - scene->count, &count, NULL));
    scene->count += count;
    TEST_ASSERT_LESS_THAN_UINT32(RESULTS_MAX, scene->count);
}

void scene_push_report(pair_scene_t *scene, const opms_trigger_report_t *report)
{
    const int64_t at = opms_box_time_ns(report->time) + HOST_LESS_BOX_NS + MS;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pairer_push_trigger(scene->pairer, report, at, NULL));
    poll(scene);
}

void scene_push_frame(pair_scene_t *scene, const opms_frame_t *frame)
{
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pairer_push_frame(scene->pairer, frame, NULL));
    poll(scene);
}

void scene_report_only(pair_scene_t *scene, int n)
{
    const opms_trigger_report_t report = scene_report(scene, n);
    scene_push_report(scene, &report);
}

void scene_frame_only(pair_scene_t *scene, int n)
{
    const opms_frame_t frame = scene_frame(scene, n);
    scene_push_frame(scene, &frame);
}

void scene_step(pair_scene_t *scene, int n)
{
    const opms_trigger_report_t report = scene_report(scene, n);
    const opms_frame_t frame = scene_frame(scene, n);
    scene_push_report(scene, &report);
    scene_push_frame(scene, &frame);
}

void scene_steps(pair_scene_t *scene, int from, int to)
{
    for (int n = from; n <= to; ++n) {
        scene_step(scene, n);
    }
}

void scene_advance(pair_scene_t *scene, int64_t box_ns)
{
    TEST_ASSERT_EQUAL(OPMS_OK,
                      opms_pairer_advance(scene->pairer, box_ns + HOST_LESS_BOX_NS, NULL));
    poll(scene);
}

void scene_close(pair_scene_t *scene)
{
    opms_error_t err = {OPMS_OK, 0, "", ""};
    TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK, opms_pairer_close(scene->pairer, &err), err.message);
    poll(scene);
    const opms_pair_summary_t summary = scene_summary(scene);
    TEST_ASSERT_TRUE(summary.sums_hold);
    TEST_ASSERT_EQUAL_UINT64(0, summary.counters.triggers_pending);
    TEST_ASSERT_EQUAL_UINT64(0, summary.counters.frames_pending);
}

const opms_pair_result_t *scene_of_trigger(const pair_scene_t *scene, int n)
{
    const uint64_t number = (uint64_t)scene->first_number + (uint64_t)n - 1;
    const opms_pair_result_t *found = NULL;
    for (uint32_t i = 0; i < scene->count; ++i) {
        const opms_pair_result_t *result = &scene->results[i];
        if (result->trigger_state != OPMS_TRIGGER_NONE && number >= result->trigger_number &&
            number < result->trigger_number + result->trigger_count) {
            TEST_ASSERT_NULL_MESSAGE(found, "a trigger has two results");
            found = result;
        }
    }
    return found;
}

const opms_pair_result_t *scene_of_frame(const pair_scene_t *scene, uint64_t tag)
{
    const opms_pair_result_t *found = NULL;
    for (uint32_t i = 0; i < scene->count; ++i) {
        const opms_pair_result_t *result = &scene->results[i];
        if (result->frame_state != OPMS_FRAME_NONE && result->frame.tag == tag) {
            TEST_ASSERT_NULL_MESSAGE(found, "a frame has two results");
            found = result;
        }
    }
    return found;
}

opms_pair_summary_t scene_summary(const pair_scene_t *scene)
{
    opms_pair_summary_t summary;
    opms_pairer_summary(scene->pairer, &summary);
    return summary;
}

void scene_assert_paired(const pair_scene_t *scene, int from, int to)
{
    for (int n = from; n <= to; ++n) {
        const opms_pair_result_t *result = scene_of_trigger(scene, n);
        TEST_ASSERT_NOT_NULL(result);
        TEST_ASSERT_EQUAL_STRING("PAIRED", opms_trigger_state_name(result->trigger_state));
        TEST_ASSERT_EQUAL_UINT64((uint64_t)n, result->frame.tag);
    }
}

void scene_assert_no_wrong_pair(const pair_scene_t *scene)
{
    for (uint32_t i = 0; i < scene->count; ++i) {
        const opms_pair_result_t *result = &scene->results[i];
        if (result->frame_state == OPMS_FRAME_PAIRED) {
            TEST_ASSERT_EQUAL_UINT64(result->trigger_number - scene->first_number + 1,
                                     result->frame.tag);
        }
    }
}
