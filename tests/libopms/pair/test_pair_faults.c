/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the pairer tells when one thing goes wrong. All at once: sim/. */
#include <unity.h>

#include "pair_scene.h"

static pair_scene_t scene;

void setUp(void) {}

void tearDown(void)
{
    scene_end(&scene);
}

/** A frame whose id is off by this, as after ids were skipped or started anew. */
static void step_with_id(int n, int64_t id)
{
    const opms_trigger_report_t report = scene_report(&scene, n);
    opms_frame_t frame = scene_frame(&scene, n);
    frame.frame_id = (uint64_t)id;
    scene_push_report(&scene, &report);
    scene_push_frame(&scene, &frame);
}

static void a_lost_frame_leaves_its_trigger_missing(void)
{
    for (int kind = STAMP_AND_STROBE; kind <= ARRIVAL_ONLY; ++kind) {
        scene_start(&scene, (pair_kind_t)kind);
        scene_steps(&scene, 1, 30);
        scene_report_only(&scene, 31);
        scene_steps(&scene, 32, 150);
        TEST_ASSERT_EQUAL(OPMS_TRIGGER_MISSING, scene_of_trigger(&scene, 31)->trigger_state);
        scene_close(&scene);
        scene_assert_paired(&scene, 1, 30);
        scene_assert_paired(&scene, 32, 150);
        scene_end(&scene);
    }
}

static void two_lost_reports_are_filled_by_the_gaps_of_the_next(void)
{
    for (int kind = STAMP_AND_STROBE; kind <= ARRIVAL_ONLY; ++kind) {
        scene_start(&scene, (pair_kind_t)kind);
        scene_steps(&scene, 1, 30);
        scene_frame_only(&scene, 31);
        scene_frame_only(&scene, 32);
        scene_steps(&scene, 33, 60);
        scene_close(&scene);
        scene_assert_paired(&scene, 1, 60);
        TEST_ASSERT_BITS_HIGH(OPMS_PAIR_FROM_GAP, scene_of_trigger(&scene, 31)->known);
        scene_end(&scene);
    }
}

static opms_history_report_t history_of(int n)
{
    const opms_trigger_report_t report = scene_report(&scene, n);
    opms_history_report_t history = {.token = 1, .boot_id = BOOT, .session_id = SESSION};
    history.count = 1;
    history.entries[0].number = report.trigger_number;
    history.entries[0].flags = OPMS_TRIGGER_RUN;
    history.entries[0].time = report.time;
    return history;
}

static void longer_losses_are_told_as_gaps_and_filled_by_history(void)
{
    scene_start(&scene, STAMP_ONLY);
    scene_steps(&scene, 1, 30);
    for (int n = 31; n <= 36; ++n) {
        scene_frame_only(&scene, n);
    }
    scene_step(&scene, 37); /* tells 36 and 35 by its gaps */
    opms_pair_gap_t gaps[4];
    uint32_t count = 0;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pair_gaps(scene.pairer, gaps, 4, &count, NULL));
    TEST_ASSERT_EQUAL_UINT32(1, count);
    TEST_ASSERT_EQUAL_UINT32(31, gaps[0].first_number);
    TEST_ASSERT_EQUAL_UINT32(4, gaps[0].count);
    for (int n = 31; n <= 34; ++n) {
        const opms_history_report_t history = history_of(n);
        TEST_ASSERT_EQUAL(OPMS_OK, opms_pairer_push_history(scene.pairer, &history, NULL));
    }
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pair_gaps(scene.pairer, gaps, 4, &count, NULL));
    TEST_ASSERT_EQUAL_UINT32(0, count);
    scene_steps(&scene, 38, 60);
    scene_close(&scene);
    scene_assert_paired(&scene, 1, 60);
    TEST_ASSERT_BITS_HIGH(OPMS_PAIR_FROM_HISTORY, scene_of_trigger(&scene, 33)->known);
}

static void a_trigger_without_a_time_ends_uncertain_and_so_does_its_frame(void)
{
    scene_start(&scene, STAMP_ONLY);
    scene_steps(&scene, 1, 30);
    for (int n = 31; n <= 36; ++n) {
        scene_frame_only(&scene, n);
    }
    scene_steps(&scene, 37, 60);
    scene_close(&scene);
    scene_assert_paired(&scene, 35, 60);
    TEST_ASSERT_EQUAL(OPMS_TRIGGER_UNCERTAIN, scene_of_trigger(&scene, 32)->trigger_state);
    TEST_ASSERT_EQUAL(OPMS_FRAME_UNCERTAIN, scene_of_frame(&scene, 32)->frame_state);
}

static void a_repeated_frame_is_a_duplicate_in_every_profile(void)
{
    for (int kind = STAMP_AND_STROBE; kind <= ARRIVAL_ONLY; ++kind) {
        scene_start(&scene, (pair_kind_t)kind);
        scene_steps(&scene, 1, 40);
        opms_frame_t copy = scene_frame(&scene, 35);
        copy.arrival_host_ns = scene_frame(&scene, 40).arrival_host_ns + 5 * MS;
        copy.tag = 9999;
        scene_push_frame(&scene, &copy);
        scene_steps(&scene, 41, 60);
        scene_close(&scene);
        scene_assert_paired(&scene, 1, 60);
        TEST_ASSERT_EQUAL(OPMS_FRAME_DUPLICATE, scene_of_frame(&scene, 9999)->frame_state);
        scene_end(&scene);
    }
}

static void a_frame_between_two_triggers_is_an_orphan_once_the_clock_is_confirmed(void)
{
    scene_start(&scene, STAMP_ONLY);
    scene_steps(&scene, 1, 40);
    opms_frame_t extra = scene_frame(&scene, 40);
    extra.frame_id += 1;
    extra.camera_time_ticks += 45 * MS;
    extra.arrival_host_ns += 45 * MS;
    extra.tag = 9999;
    scene_push_frame(&scene, &extra);
    for (int n = 41; n <= 70; ++n) {
        step_with_id(n, n + ID_LESS_NUMBER + 1);
    }
    scene_close(&scene);
    TEST_ASSERT_EQUAL(OPMS_FRAME_ORPHAN, scene_of_frame(&scene, 9999)->frame_state);
    scene_assert_paired(&scene, 1, 70);
}

static void a_trigger_that_the_camera_ignored_shifts_no_stamped_pair(void)
{
    scene_start(&scene, STAMP_ONLY);
    scene_steps(&scene, 1, 40);
    scene_report_only(&scene, 41);
    for (int n = 42; n <= 150; ++n) {
        step_with_id(n, n + ID_LESS_NUMBER - 1);
    }
    scene_close(&scene);
    scene_assert_paired(&scene, 1, 40);
    scene_assert_paired(&scene, 42, 150);
    TEST_ASSERT_EQUAL(OPMS_TRIGGER_MISSING, scene_of_trigger(&scene, 41)->trigger_state);
}

static void ids_that_start_anew_are_locked_again_after_eight_frames_by_arrival_alone(void)
{
    scene_start(&scene, ARRIVAL_ONLY);
    scene_steps(&scene, 1, 100);
    for (int n = 101; n <= 108; ++n) {
        step_with_id(n, n - 100);
        TEST_ASSERT_EQUAL(n < 108 ? OPMS_PAIR_SUSPECT : OPMS_PAIR_LOCKED,
                          n < 104 ? OPMS_PAIR_SUSPECT : scene_summary(&scene).state);
    }
    for (int n = 109; n <= 150; ++n) {
        step_with_id(n, n - 100);
    }
    scene_close(&scene);
    scene_assert_no_wrong_pair(&scene);
    scene_assert_paired(&scene, 109, 150);
    for (int n = 101; n <= 108; ++n) { /* until then frames stay uncertain */
        TEST_ASSERT_EQUAL(OPMS_FRAME_UNCERTAIN, scene_of_frame(&scene, (uint64_t)n)->frame_state);
    }
}

static void a_camera_that_restarts_is_locked_again_and_its_frames_are_paired_in_hindsight(void)
{
    scene_start(&scene, STAMP_ONLY);
    scene_steps(&scene, 1, 100);
    for (int n = 101; n <= 115; ++n) {
        scene_report_only(&scene, n);
    }
    for (int n = 116; n <= 160; ++n) {
        const opms_trigger_report_t report = scene_report(&scene, n);
        opms_frame_t frame = scene_frame(&scene, n);
        frame.frame_id = (uint64_t)(n - 116);
        frame.camera_time_ticks = (uint64_t)(scene_trigger_ns(&scene, n) -
                                             scene_trigger_ns(&scene, 116) + 123456789);
        scene_push_report(&scene, &report);
        scene_push_frame(&scene, &frame);
        if (n == 126) {
            TEST_ASSERT_EQUAL(OPMS_PAIR_LOCKED, scene_summary(&scene).state);
        }
    }
    scene_close(&scene);
    scene_assert_no_wrong_pair(&scene);
    scene_assert_paired(&scene, 116, 160);
    TEST_ASSERT_EQUAL_UINT64(1, scene_summary(&scene).counters.camera_restarts);
}

/** The id has jumped by one and the frame is late by one period: it looks like the next trigger's
 * frame. What follows shows that it was not. */
static void a_late_frame_whose_id_jumped_is_not_taken_for_the_next_one(void)
{
    scene_start(&scene, ARRIVAL_ONLY);
    scene_steps(&scene, 1, 50);
    for (int n = 51; n <= 80; ++n) {
        const opms_trigger_report_t report = scene_report(&scene, n);
        opms_frame_t frame = scene_frame(&scene, n);
        frame.frame_id += 1;
        frame.arrival_host_ns += n == 51 ? 100 * MS - MS : 0;
        scene_push_report(&scene, &report);
        scene_push_frame(&scene, &frame);
    }
    scene_close(&scene);
    scene_assert_no_wrong_pair(&scene);
    TEST_ASSERT_EQUAL(OPMS_FRAME_UNCERTAIN, scene_of_frame(&scene, 51)->frame_state);
}

static void frames_of_a_stalled_host_are_paired_by_stamp_and_uncertain_by_arrival(void)
{
    for (int kind = STAMP_ONLY; kind <= ARRIVAL_ONLY; kind += ARRIVAL_ONLY - STAMP_ONLY) {
        scene_start(&scene, (pair_kind_t)kind);
        scene_steps(&scene, 1, 50);
        const int64_t end = scene_trigger_ns(&scene, 80) + HOST_LESS_BOX_NS + 90 * MS;
        for (int n = 51; n <= 80; ++n) {
            scene_report_only(&scene, n);
        }
        for (int n = 51; n <= 80; ++n) {
            opms_frame_t frame = scene_frame(&scene, n);
            frame.arrival_host_ns = end + n * 2000;
            scene_push_frame(&scene, &frame);
        }
        scene_steps(&scene, 81, 120);
        scene_close(&scene);
        scene_assert_no_wrong_pair(&scene);
        scene_assert_paired(&scene, 81, 119);
        const opms_frame_state_t state = scene_of_frame(&scene, 60)->frame_state;
        TEST_ASSERT_EQUAL(kind == STAMP_ONLY ? OPMS_FRAME_PAIRED : OPMS_FRAME_UNCERTAIN, state);
        scene_end(&scene);
    }
}

static void a_frame_that_comes_after_the_longest_wait_is_stale(void)
{
    scene_start(&scene, STAMP_ONLY);
    scene_steps(&scene, 1, 40);
    scene_report_only(&scene, 41);
    scene_steps(&scene, 42, 110);
    opms_frame_t late = scene_frame(&scene, 41);
    late.arrival_host_ns = scene_frame(&scene, 110).arrival_host_ns + 10 * MS;
    scene_push_frame(&scene, &late);
    scene_steps(&scene, 111, 200);
    scene_close(&scene);
    TEST_ASSERT_EQUAL(OPMS_FRAME_STALE, scene_of_frame(&scene, 41)->frame_state);
    TEST_ASSERT_NOT_EQUAL(OPMS_TRIGGER_PAIRED, scene_of_trigger(&scene, 41)->trigger_state);
}

/** The frame of trigger 41 comes this long after it; what becomes of the two? */
static void come_after(pair_kind_t kind, int64_t delay_ns, opms_frame_state_t frame_state,
                       opms_trigger_state_t trigger_state)
{
    scene_start(&scene, kind);
    scene_steps(&scene, 1, 40);
    scene_report_only(&scene, 41);
    scene_steps(&scene, 42, 100);
    opms_frame_t late = scene_frame(&scene, 41);
    late.arrival_host_ns = scene_trigger_ns(&scene, 41) + HOST_LESS_BOX_NS + delay_ns;
    scene_push_frame(&scene, &late);
    scene_steps(&scene, 101, 200);
    scene_close(&scene);
    scene_assert_no_wrong_pair(&scene);
    TEST_ASSERT_EQUAL(frame_state, scene_of_frame(&scene, 41)->frame_state);
    TEST_ASSERT_EQUAL(trigger_state, scene_of_trigger(&scene, 41)->trigger_state);
    scene_end(&scene);
}

/** The clocks are known to a millisecond, so the end of the wait is, too. */
static void a_trigger_is_not_missing_whose_frame_comes_right_at_the_end_of_the_wait(void)
{
    come_after(STROBE_ONLY, 6001 * MS, OPMS_FRAME_UNCERTAIN, OPMS_TRIGGER_UNCERTAIN);
    come_after(ARRIVAL_ONLY, 6001 * MS, OPMS_FRAME_UNCERTAIN, OPMS_TRIGGER_UNCERTAIN);
    come_after(STAMP_ONLY, 6001 * MS, OPMS_FRAME_PAIRED, OPMS_TRIGGER_PAIRED);
    come_after(STROBE_ONLY, 6003 * MS, OPMS_FRAME_STALE, OPMS_TRIGGER_MISSING);
    come_after(STAMP_ONLY, 6003 * MS, OPMS_FRAME_STALE, OPMS_TRIGGER_MISSING);
}

static void nothing_is_paired_across_two_boots_of_the_box(void)
{
    scene_start(&scene, STAMP_ONLY);
    scene_steps(&scene, 1, 40);
    opms_trigger_report_t other = scene_report(&scene, 41);
    other.boot_id = BOOT + 1;
    scene_push_report(&scene, &other);
    scene_frame_only(&scene, 41);
    const opms_pair_summary_t summary = scene_summary(&scene);
    TEST_ASSERT_TRUE(summary.ended);
    TEST_ASSERT_EQUAL_UINT64(1, summary.counters.boots_seen);
    scene_close(&scene);
    TEST_ASSERT_NOT_EQUAL(OPMS_FRAME_PAIRED, scene_of_frame(&scene, 41)->frame_state);
    TEST_ASSERT_NULL(scene_of_trigger(&scene, 41));
}

static void nothing_is_paired_across_two_sessions(void)
{
    scene_start(&scene, STAMP_ONLY);
    scene_steps(&scene, 1, 40);
    scene_report_only(&scene, 41);
    scene_close(&scene);
    scene_frame_only(&scene, 41); /* between the sessions */
    scene_open(&scene, BOOT, SESSION + 1);
    opms_frame_t frame = scene_frame(&scene, 41);
    frame.tag = 9999;
    scene_push_frame(&scene, &frame); /* and in the next one */
    scene_close(&scene);
    TEST_ASSERT_EQUAL(OPMS_FRAME_STALE, scene_of_frame(&scene, 41)->frame_state);
    TEST_ASSERT_EQUAL(OPMS_TRIGGER_MISSING, scene_of_trigger(&scene, 41)->trigger_state);
    TEST_ASSERT_NOT_EQUAL(OPMS_FRAME_PAIRED, scene_of_frame(&scene, 9999)->frame_state);
}

static void reports_that_contradict_each_other_are_both_not_believed(void)
{
    scene_start(&scene, STAMP_ONLY);
    scene_steps(&scene, 1, 40);
    opms_trigger_report_t lie = scene_report(&scene, 41);
    lie.time.us += 40000;
    scene_push_report(&scene, &lie);
    scene_steps(&scene, 41, 60);
    scene_close(&scene);
    TEST_ASSERT_EQUAL(OPMS_TRIGGER_UNCERTAIN, scene_of_trigger(&scene, 41)->trigger_state);
    TEST_ASSERT_GREATER_THAN_UINT64(0, scene_summary(&scene).counters.reports_contradicting);
    scene_assert_paired(&scene, 42, 60);
}

static void numbers_lost_in_one_long_gap_are_told_in_one_result(void)
{
    scene_start(&scene, STAMP_ONLY);
    scene_steps(&scene, 1, 20);
    scene_step(&scene, 50000);
    scene_close(&scene);
    const opms_pair_result_t *lost = scene_of_trigger(&scene, 1000);
    TEST_ASSERT_EQUAL(OPMS_TRIGGER_UNCERTAIN, lost->trigger_state);
    TEST_ASSERT_GREATER_THAN_UINT32(40000, lost->trigger_count);
    TEST_ASSERT_EQUAL_UINT64(50000, scene_summary(&scene).counters.triggers);
}

static void without_pings_there_is_no_lock_and_no_pair(void)
{
    const opms_pair_options_t options = scene_options(STAMP_ONLY);
    scene_start_with(&scene, STAMP_ONLY, &options);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pairer_close(scene.pairer, NULL));
    scene_open(&scene, BOOT + 5, SESSION); /* another boot: its clock is not known */
    for (int n = 1; n <= 40; ++n) {
        opms_trigger_report_t report = scene_report(&scene, n);
        report.boot_id = BOOT + 5;
        scene_push_report(&scene, &report);
        scene_frame_only(&scene, n);
    }
    TEST_ASSERT_EQUAL(OPMS_PAIR_SEARCHING, scene_summary(&scene).state);
    scene_close(&scene);
    TEST_ASSERT_EQUAL_UINT64(0, scene_summary(&scene).counters.frames_paired);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_lost_frame_leaves_its_trigger_missing);
    RUN_TEST(two_lost_reports_are_filled_by_the_gaps_of_the_next);
    RUN_TEST(longer_losses_are_told_as_gaps_and_filled_by_history);
    RUN_TEST(a_trigger_without_a_time_ends_uncertain_and_so_does_its_frame);
    RUN_TEST(a_repeated_frame_is_a_duplicate_in_every_profile);
    RUN_TEST(a_frame_between_two_triggers_is_an_orphan_once_the_clock_is_confirmed);
    RUN_TEST(a_trigger_that_the_camera_ignored_shifts_no_stamped_pair);
    RUN_TEST(ids_that_start_anew_are_locked_again_after_eight_frames_by_arrival_alone);
    RUN_TEST(a_camera_that_restarts_is_locked_again_and_its_frames_are_paired_in_hindsight);
    RUN_TEST(a_late_frame_whose_id_jumped_is_not_taken_for_the_next_one);
    RUN_TEST(frames_of_a_stalled_host_are_paired_by_stamp_and_uncertain_by_arrival);
    RUN_TEST(a_frame_that_comes_after_the_longest_wait_is_stale);
    RUN_TEST(a_trigger_is_not_missing_whose_frame_comes_right_at_the_end_of_the_wait);
    RUN_TEST(nothing_is_paired_across_two_boots_of_the_box);
    RUN_TEST(nothing_is_paired_across_two_sessions);
    RUN_TEST(reports_that_contradict_each_other_are_both_not_believed);
    RUN_TEST(numbers_lost_in_one_long_gap_are_told_in_one_result);
    RUN_TEST(without_pings_there_is_no_lock_and_no_pair);
    return UNITY_END();
}
