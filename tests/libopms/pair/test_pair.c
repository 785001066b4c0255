/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the pairer tells when nothing goes wrong, and what its results hold. */
#include <string.h>

#include <unity.h>

#include "pair_scene.h"

static pair_scene_t scene;

void setUp(void) {}

void tearDown(void)
{
    scene_end(&scene);
}

static void every_frame_of_a_clean_run_is_paired_in_every_profile(void)
{
    for (int kind = STAMP_AND_STROBE; kind <= ARRIVAL_ONLY; ++kind) {
        scene_start(&scene, (pair_kind_t)kind);
        scene_steps(&scene, 1, 300);
        scene_close(&scene);
        scene_assert_paired(&scene, 1, 300);
        TEST_ASSERT_EQUAL_UINT32(300, scene.count);
        scene_end(&scene);
    }
}

static void the_preamble_makes_the_lock_before_the_run_begins(void)
{
    for (int kind = STAMP_AND_STROBE; kind <= ARRIVAL_ONLY; ++kind) {
        scene_start(&scene, (pair_kind_t)kind);
        TEST_ASSERT_EQUAL(OPMS_PAIR_SEARCHING, scene_summary(&scene).state);
        scene_steps(&scene, 1, PREAMBLE);
        const opms_pair_summary_t summary = scene_summary(&scene);
        TEST_ASSERT_EQUAL(OPMS_PAIR_LOCKED, summary.state);
        TEST_ASSERT_BITS_HIGH(OPMS_WITNESS_PREAMBLE | OPMS_WITNESS_FRAME_ID,
                              summary.lock_witnesses);
        TEST_ASSERT_INT64_WITHIN(MS, FRAME_DELAY_NS, summary.arrival_floor_ns);
        scene_end(&scene);
    }
}

static void each_pair_names_at_least_two_witnesses(void)
{
    const uint32_t expected[] = {
        OPMS_WITNESS_FRAME_ID | OPMS_WITNESS_CAMERA_TIME | OPMS_WITNESS_ARRIVAL |
            OPMS_WITNESS_STROBE,
        OPMS_WITNESS_FRAME_ID | OPMS_WITNESS_CAMERA_TIME | OPMS_WITNESS_ARRIVAL,
        OPMS_WITNESS_FRAME_ID | OPMS_WITNESS_ARRIVAL | OPMS_WITNESS_STROBE,
        OPMS_WITNESS_FRAME_ID | OPMS_WITNESS_ARRIVAL,
    };
    for (int kind = STAMP_AND_STROBE; kind <= ARRIVAL_ONLY; ++kind) {
        scene_start(&scene, (pair_kind_t)kind);
        scene_steps(&scene, 1, 60);
        scene_close(&scene);
        for (int n = 10; n < 50; ++n) {
            const opms_pair_result_t *pair = scene_of_trigger(&scene, n);
            TEST_ASSERT_EQUAL_HEX32(expected[kind] | OPMS_WITNESS_PREAMBLE, pair->witnesses);
            TEST_ASSERT_EQUAL_HEX32(0, pair->against);
        }
        scene_end(&scene);
    }
}

static void a_pair_tells_times_that_the_box_told(void)
{
    scene_start(&scene, STAMP_AND_STROBE);
    scene_steps(&scene, 1, 40);
    scene_close(&scene);
    const opms_pair_result_t *pair = scene_of_trigger(&scene, 20);
    const int64_t at = scene_trigger_ns(&scene, 20);
    TEST_ASSERT_EQUAL_INT64(at, pair->trigger_box_ns);
    TEST_ASSERT_INT64_WITHIN(8, scene_trigger_ns(&scene, 7) - 1032, pair->start_edge_box_ns);
    TEST_ASSERT_EQUAL_INT64(10000, pair->start_delay_ns);
    TEST_ASSERT_EQUAL_INT64(4 * MS, pair->exposure_ns);
    TEST_ASSERT_EQUAL_INT64(at + 10000 + 2 * MS, pair->mid_exposure_box_ns);
    TEST_ASSERT_BITS_HIGH(OPMS_PAIR_HAS_MID_EXPOSURE | OPMS_PAIR_EXPOSURE_SEEN |
                              OPMS_PAIR_START_DELAY_SEEN | OPMS_PAIR_HAS_TRIGGER_TIME,
                          pair->known);
    TEST_ASSERT_INT64_WITHIN(20000, 0, pair->camera_residual_ns);
    TEST_ASSERT_INT64_WITHIN(500000, FRAME_DELAY_NS, pair->arrival_delay_ns);
    TEST_ASSERT_EQUAL_UINT32(BOOT, pair->boot_id);
    TEST_ASSERT_EQUAL_UINT32(SESSION, pair->session_id);
}

static void without_a_strobe_the_profile_states_the_exposure_or_it_is_unknown(void)
{
    scene_start(&scene, STAMP_ONLY);
    scene_steps(&scene, 1, 20);
    const opms_pair_result_t *unknown = scene_of_trigger(&scene, 15);
    TEST_ASSERT_BITS_LOW(OPMS_PAIR_HAS_MID_EXPOSURE | OPMS_PAIR_HAS_EXPOSURE, unknown->known);
    TEST_ASSERT_EQUAL_INT64(unknown->trigger_box_ns, unknown->mid_exposure_box_ns);
    scene_end(&scene);

    opms_pair_options_t options = scene_options(STAMP_ONLY);
    options.camera.has_start_delay = options.camera.has_exposure = 1;
    options.camera.start_delay_ns = 25000;
    options.camera.exposure_ns = 8 * MS;
    scene_start_with(&scene, STAMP_ONLY, &options);
    scene_steps(&scene, 1, 20);
    const opms_pair_result_t *stated = scene_of_trigger(&scene, 15);
    TEST_ASSERT_BITS_HIGH(OPMS_PAIR_HAS_MID_EXPOSURE, stated->known);
    TEST_ASSERT_BITS_LOW(OPMS_PAIR_EXPOSURE_SEEN | OPMS_PAIR_START_DELAY_SEEN, stated->known);
    TEST_ASSERT_EQUAL_INT64(stated->trigger_box_ns + 25000 + 4 * MS,
                            stated->mid_exposure_box_ns);
}

static void a_stamped_frame_is_paired_at_once(void)
{
    scene_start(&scene, STAMP_ONLY);
    scene_steps(&scene, 1, 40);
    scene_assert_paired(&scene, 1, 40); /* nothing was advanced or closed */
}

static void an_unstamped_frame_is_paired_when_the_next_one_agrees(void)
{
    scene_start(&scene, ARRIVAL_ONLY);
    scene_steps(&scene, 1, 40);
    scene_assert_paired(&scene, 1, 39);
    TEST_ASSERT_NULL(scene_of_trigger(&scene, 40));
    scene_step(&scene, 41);
    scene_assert_paired(&scene, 40, 40);
}

static void results_are_numbered_in_the_order_of_decision(void)
{
    scene_start(&scene, STROBE_ONLY);
    scene_steps(&scene, 1, 50);
    scene_close(&scene);
    for (uint32_t i = 0; i < scene.count; ++i) {
        TEST_ASSERT_EQUAL_UINT64(i, scene.results[i].sequence);
    }
}

static void the_line_for_people_tells_state_and_sums(void)
{
    scene_start(&scene, STAMP_ONLY);
    scene_steps(&scene, 1, 30);
    const opms_pair_summary_t summary = scene_summary(&scene);
    TEST_ASSERT_NOT_NULL(strstr(summary.line, "LOCKED: 30 of 30 triggers paired"));
    TEST_ASSERT_TRUE(summary.sums_hold);
    TEST_ASSERT_EQUAL(OPMS_CLOCK_FITTED, summary.clock.state);
}

static void counters_may_wrap_within_a_session(void)
{
    const uint32_t firsts[] = {65536 - 20, 0xFFFFFFFFU - 20};
    for (int i = 0; i < 2; ++i) {
        opms_pair_options_t options = scene_options(ARRIVAL_ONLY);
        options.first_number = firsts[i];
        scene_start_with(&scene, ARRIVAL_ONLY, &options);
        scene_steps(&scene, 1, 60);
        scene_close(&scene);
        scene_assert_paired(&scene, 1, 60);
        scene_end(&scene);
    }
}

static void frame_ids_of_16_bits_that_skip_0_wrap_without_a_hole(void)
{
    opms_pair_options_t options = scene_options(ARRIVAL_ONLY);
    options.camera.frame_id_bits = 16;
    options.camera.frame_id_skips_0 = 1;
    scene_start_with(&scene, ARRIVAL_ONLY, &options);
    for (int n = 1; n <= 60; ++n) {
        const opms_trigger_report_t report = scene_report(&scene, n);
        opms_frame_t frame = scene_frame(&scene, n);
        frame.frame_id = (uint64_t)(65510 + n <= 65535 ? 65510 + n : 65510 + n - 65535);
        scene_push_report(&scene, &report);
        scene_push_frame(&scene, &frame);
    }
    scene_close(&scene);
    scene_assert_paired(&scene, 1, 60);
    TEST_ASSERT_EQUAL_UINT64(1, scene_summary(&scene).counters.locks);
}

static void camera_time_of_few_bits_wraps(void)
{
    opms_pair_options_t options = scene_options(STAMP_ONLY);
    options.camera.camera_time_bits = 32;
    options.camera.camera_tick_hz = 1000000000; /* wraps every 4.3 s */
    scene_start_with(&scene, STAMP_ONLY, &options);
    for (int n = 1; n <= 120; ++n) {
        const opms_trigger_report_t report = scene_report(&scene, n);
        opms_frame_t frame = scene_frame(&scene, n);
        frame.camera_time_ticks &= 0xFFFFFFFFU;
        scene_push_report(&scene, &report);
        scene_push_frame(&scene, &frame);
    }
    scene_assert_paired(&scene, 1, 120);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_frame_of_a_clean_run_is_paired_in_every_profile);
    RUN_TEST(the_preamble_makes_the_lock_before_the_run_begins);
    RUN_TEST(each_pair_names_at_least_two_witnesses);
    RUN_TEST(a_pair_tells_times_that_the_box_told);
    RUN_TEST(without_a_strobe_the_profile_states_the_exposure_or_it_is_unknown);
    RUN_TEST(a_stamped_frame_is_paired_at_once);
    RUN_TEST(an_unstamped_frame_is_paired_when_the_next_one_agrees);
    RUN_TEST(results_are_numbered_in_the_order_of_decision);
    RUN_TEST(the_line_for_people_tells_state_and_sums);
    RUN_TEST(counters_may_wrap_within_a_session);
    RUN_TEST(frame_ids_of_16_bits_that_skip_0_wrap_without_a_hole);
    RUN_TEST(camera_time_of_few_bits_wraps);
    return UNITY_END();
}
