/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What a strobe that sees nothing may prevent, and what not. */
#include <unity.h>

#include "pair_scene.h"

#define LAST_SEEN 100 /* the strobe input sees no exposure after this trigger's */

static pair_scene_t scene;

void setUp(void) {}

void tearDown(void)
{
    scene_end(&scene);
}

static void report_without_strobe(int n)
{
    opms_trigger_report_t report = scene_report(&scene, n);
    report.strobe_for_trigger = scene.first_number + LAST_SEEN - 1;
    scene_push_report(&scene, &report);
}

/** Trigger n, of which the box sees no exposure; its frame's id is off and it comes late. */
static void silent_step(int n, int64_t id, int64_t late_ns)
{
    opms_frame_t frame = scene_frame(&scene, n);
    frame.frame_id = (uint64_t)id;
    frame.arrival_host_ns += late_ns;
    report_without_strobe(n);
    scene_push_frame(&scene, &frame);
}

static void assert_uncertain(int from, int to)
{
    for (int n = from; n <= to; ++n) {
        TEST_ASSERT_EQUAL(OPMS_FRAME_UNCERTAIN, scene_of_frame(&scene, (uint64_t)n)->frame_state);
    }
}

static void ids_that_start_anew_are_locked_again_though_the_strobe_sees_nothing(void)
{
    scene_start(&scene, STROBE_ONLY);
    scene_steps(&scene, 1, LAST_SEEN);
    int locked_at = 0;
    for (int n = 101; n <= 150; ++n) {
        silent_step(n, n - 101, 0);
        if (n > 104 && locked_at == 0 && scene_summary(&scene).state == OPMS_PAIR_LOCKED) {
            locked_at = n;
        }
    }
    TEST_ASSERT_EQUAL_INT(108, locked_at); /* as by arrival alone */
    scene_close(&scene);
    scene_assert_no_wrong_pair(&scene);
    scene_assert_paired(&scene, 109, 150);
    assert_uncertain(101, 108);
}

static void a_camera_that_restarts_is_locked_again_though_the_strobe_sees_nothing(void)
{
    scene_start(&scene, STAMP_AND_STROBE);
    scene_steps(&scene, 1, LAST_SEEN);
    for (int n = 101; n <= 115; ++n) {
        report_without_strobe(n);
    }
    for (int n = 116; n <= 160; ++n) {
        opms_frame_t frame = scene_frame(&scene, n);
        frame.frame_id = (uint64_t)(n - 116);
        frame.camera_time_ticks =
            (uint64_t)(scene_trigger_ns(&scene, n) - scene_trigger_ns(&scene, 116) + 123456789);
        report_without_strobe(n);
        scene_push_frame(&scene, &frame);
        if (n == 125) {
            TEST_ASSERT_EQUAL(OPMS_PAIR_LOCKED, scene_summary(&scene).state);
        }
    }
    scene_close(&scene);
    scene_assert_no_wrong_pair(&scene);
    scene_assert_paired(&scene, 116, 160);
}

static void late_frames_make_no_lock_against_the_strobe(void)
{
    scene_start(&scene, STROBE_ONLY);
    scene_steps(&scene, 1, LAST_SEEN);
    for (int n = 101; n <= 130; ++n) {
        silent_step(n, n - 101, n % 5 == 0 ? 40 * MS : 0);
    }
    TEST_ASSERT_EQUAL(OPMS_PAIR_SUSPECT, scene_summary(&scene).state);
    for (int n = 131; n <= 150; ++n) {
        silent_step(n, n - 101, 0);
        TEST_ASSERT_EQUAL(n < 138 ? OPMS_PAIR_SUSPECT : OPMS_PAIR_LOCKED,
                          scene_summary(&scene).state);
    }
    scene_close(&scene);
    scene_assert_no_wrong_pair(&scene);
    scene_assert_paired(&scene, 139, 150);
    assert_uncertain(101, 130);
}

static void late_frames_are_locked_where_the_strobe_agrees(void)
{
    scene_start(&scene, STROBE_ONLY);
    scene_steps(&scene, 1, LAST_SEEN);
    for (int n = 101; n <= 130; ++n) {
        const opms_trigger_report_t report = scene_report(&scene, n);
        opms_frame_t frame = scene_frame(&scene, n);
        frame.frame_id = (uint64_t)(n - 101);
        frame.arrival_host_ns += n % 5 == 0 ? 40 * MS : 0;
        scene_push_report(&scene, &report);
        scene_push_frame(&scene, &frame);
        if (n == 110) {
            TEST_ASSERT_EQUAL(OPMS_PAIR_LOCKED, scene_summary(&scene).state);
        }
    }
    scene_close(&scene);
    scene_assert_no_wrong_pair(&scene);
    TEST_ASSERT_EQUAL(OPMS_FRAME_PAIRED, scene_of_frame(&scene, 103)->frame_state);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(ids_that_start_anew_are_locked_again_though_the_strobe_sees_nothing);
    RUN_TEST(a_camera_that_restarts_is_locked_again_though_the_strobe_sees_nothing);
    RUN_TEST(late_frames_make_no_lock_against_the_strobe);
    RUN_TEST(late_frames_are_locked_where_the_strobe_agrees);
    return UNITY_END();
}
