/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the calls of the pair stage refuse, and how they use memory. */
#include <string.h>

#include <unity.h>

#include "../counting_allocator.h"
#include "pair_scene.h"

static pair_scene_t scene;

void setUp(void) {}

void tearDown(void)
{
    scene_end(&scene);
}

static void assert_refused(const opms_pair_options_t *options, const char *named)
{
    opms_pairer_t *none = NULL;
    opms_error_t err = {OPMS_OK, 0, "", ""};
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pairer_create(options, &none, &err));
    TEST_ASSERT_EQUAL_STRING("pair", err.stage);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(err.message, named), err.message);
    TEST_ASSERT_NULL(none);
}

static void wrong_options_are_refused_by_name(void)
{
    opms_pair_options_t options = scene_options(STAMP_ONLY);
    options.struct_size = 8;
    assert_refused(&options, "struct_size");
    options = scene_options(STAMP_ONLY);
    options.max_wait_ms = 99;
    assert_refused(&options, "max_wait_ms");
    options = scene_options(STAMP_ONLY);
    options.min_period_us = 9999;
    assert_refused(&options, "min_period_us");
    options = scene_options(STAMP_ONLY);
    options.camera.frame_id_bits = 65;
    assert_refused(&options, "frame_id_bits");
    options = scene_options(STAMP_ONLY);
    options.camera.camera_time_bits = 15;
    assert_refused(&options, "camera_time_bits");
    options = scene_options(STAMP_ONLY);
    options.camera.camera_tick_hz = 0;
    assert_refused(&options, "camera_tick_hz");
    options = scene_options(STAMP_ONLY);
    options.allocator.alloc = counting_alloc;
    assert_refused(&options, "allocator");
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pairer_create(NULL, NULL, NULL));
}

static void a_session_opens_once_with_ids_and_settings_that_can_be(void)
{
    opms_error_t err = {OPMS_OK, 0, "", ""};
    opms_settings_t settings = scene_settings();
    scene_start(&scene, STAMP_ONLY);
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pairer_open(scene.pairer, 1, 2, &settings, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "close it first"));
    scene_close(&scene);
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pairer_open(scene.pairer, 0, 2, &settings, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "boot_id"));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pairer_open(scene.pairer, 1, 0, &settings, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "session_id"));
    settings.period_us = 1;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pairer_open(scene.pairer, 1, 2, &settings, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "settings"));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pairer_open(scene.pairer, 1, 2, NULL, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pairer_close(scene.pairer, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "no session"));
}

static void a_period_shorter_than_the_memory_was_made_for_is_refused(void)
{
    opms_pair_options_t options = scene_options(STAMP_ONLY);
    options.min_period_us = 200000;
    opms_pairer_t *pairer = NULL;
    opms_error_t err = {OPMS_OK, 0, "", ""};
    const opms_settings_t settings = scene_settings();
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pairer_create(&options, &pairer, NULL));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pairer_open(pairer, 1, 2, &settings, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "min_period_us"));
    opms_pairer_destroy(pairer);
}

static void times_that_no_monotonic_clock_shows_are_refused(void)
{
    scene_start(&scene, STAMP_ONLY);
    opms_error_t err = {OPMS_OK, 0, "", ""};
    const opms_trigger_report_t report = scene_report(&scene, 1);
    opms_frame_t frame = scene_frame(&scene, 1);
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pairer_push_trigger(scene.pairer, &report, -1, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "arrival_host_ns"));
    frame.arrival_host_ns = 1700000000LL * 1000 * MS; /* wall time */
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pairer_push_frame(scene.pairer, &frame, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "monotonic"));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pairer_advance(scene.pairer, INT64_MIN, &err));
    TEST_ASSERT_EQUAL_UINT64(0, scene_summary(&scene).counters.frames);
}

static void missing_arguments_are_refused(void)
{
    scene_start(&scene, STAMP_ONLY);
    uint32_t count = 0;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pairer_push_trigger(scene.pairer, NULL, 1, NULL));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pairer_push_history(scene.pairer, NULL, NULL));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pairer_push_event(scene.pairer, NULL, NULL));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pairer_push_status(scene.pairer, NULL, NULL));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pairer_push_pong(scene.pairer, 1, NULL, 2, NULL));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pairer_push_frame(scene.pairer, NULL, NULL));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pairer_poll(scene.pairer, NULL, 1, &count, NULL));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pair_gaps(scene.pairer, NULL, 1, &count, NULL));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pairer_advance(NULL, 1, NULL));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pairer_close(NULL, NULL));
    TEST_ASSERT_NULL(opms_pairer_clock(NULL));
    opms_pairer_summary(NULL, NULL);
    opms_pairer_destroy(NULL);
}

static void results_that_nobody_polls_stop_the_input_and_none_is_lost(void)
{
    scene_start(&scene, STAMP_ONLY);
    opms_error_t err = {OPMS_OK, 0, "", ""};
    opms_status_t status = OPMS_OK;
    int pushed = 0;
    while (status == OPMS_OK && pushed < 100000) {
        const opms_trigger_report_t report = scene_report(&scene, pushed + 1);
        status = opms_pairer_push_trigger(scene.pairer, &report,
                                          opms_box_time_ns(report.time) + HOST_LESS_BOX_NS, &err);
        if (status == OPMS_OK) {
            ++pushed;
            const opms_frame_t frame = scene_frame(&scene, pushed);
            status = opms_pairer_push_frame(scene.pairer, &frame, &err);
        }
    }
    TEST_ASSERT_EQUAL(OPMS_ERR_CAPACITY, status);
    TEST_ASSERT_NOT_NULL(strstr(err.message, "poll"));
    const uint64_t frames = scene_summary(&scene).counters.frames;
    scene_close(&scene);
    TEST_ASSERT_EQUAL_UINT64(frames, scene_summary(&scene).counters.frames_paired);
    TEST_ASSERT_GREATER_OR_EQUAL_UINT32((uint32_t)frames, scene.count);
}

static void memory_comes_from_the_given_allocator_only_on_create(void)
{
    count_t count = {0, 0, 0};
    opms_pair_options_t options = scene_options(STAMP_AND_STROBE);
    options.allocator = (opms_allocator_t){counting_alloc, counting_free, &count};
    scene_start_with(&scene, STAMP_AND_STROBE, &options);
    const int calls = count.calls;
    scene_steps(&scene, 1, 100);
    scene_close(&scene);
    TEST_ASSERT_EQUAL(calls, count.calls);
    scene_end(&scene);
    TEST_ASSERT_EQUAL(0, count.live);
    for (int fail_at = 1; fail_at <= calls; ++fail_at) {
        count = (count_t){0, 0, fail_at};
        opms_pairer_t *none = NULL;
        TEST_ASSERT_EQUAL(OPMS_ERR_MEMORY, opms_pairer_create(&options, &none, NULL));
        TEST_ASSERT_EQUAL(0, count.live);
        TEST_ASSERT_NULL(none);
    }
}

static void names_exist_for_all_states_and_no_others(void)
{
    TEST_ASSERT_EQUAL_STRING("SUSPECT", opms_pair_state_name(OPMS_PAIR_SUSPECT));
    TEST_ASSERT_EQUAL_STRING("MISSING", opms_trigger_state_name(OPMS_TRIGGER_MISSING));
    TEST_ASSERT_EQUAL_STRING("ORPHAN", opms_frame_state_name(OPMS_FRAME_ORPHAN));
    TEST_ASSERT_EQUAL_STRING("?", opms_pair_state_name((opms_pair_state_t)17));
    TEST_ASSERT_EQUAL_STRING("?", opms_trigger_state_name((opms_trigger_state_t)17));
    TEST_ASSERT_EQUAL_STRING("?", opms_frame_state_name((opms_frame_state_t)17));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(wrong_options_are_refused_by_name);
    RUN_TEST(a_session_opens_once_with_ids_and_settings_that_can_be);
    RUN_TEST(a_period_shorter_than_the_memory_was_made_for_is_refused);
    RUN_TEST(times_that_no_monotonic_clock_shows_are_refused);
    RUN_TEST(missing_arguments_are_refused);
    RUN_TEST(results_that_nobody_polls_stop_the_input_and_none_is_lost);
    RUN_TEST(memory_comes_from_the_given_allocator_only_on_create);
    RUN_TEST(names_exist_for_all_states_and_no_others);
    return UNITY_END();
}
