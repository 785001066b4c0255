/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * MISSING and ORPHAN are certain: what may still be otherwise is neither. */
#include <unity.h>

#include "pair_scene.h"

#define ODD_TAG 9999

static pair_scene_t scene;

void setUp(void) {}

void tearDown(void)
{
    scene_end(&scene);
}

/** Reports are late, so that the newest pair is older than the newest frame. A frame of before the
 * camera's last start comes; by chance its id and stamp lie in between, and off the triggers. */
static void an_old_frame_is_no_orphan_though_no_pair_is_newer_yet(void)
{
    scene_start(&scene, STAMP_ONLY);
    scene_steps(&scene, 1, 40);
    for (int n = 41; n <= 45; ++n) {
        scene_frame_only(&scene, n);
    }
    opms_frame_t old = scene_frame(&scene, 43);
    old.camera_time_ticks += 40 * MS;
    old.arrival_host_ns = scene_frame(&scene, 45).arrival_host_ns + MS;
    old.tag = ODD_TAG;
    scene_push_frame(&scene, &old);
    for (int n = 41; n <= 45; ++n) {
        scene_report_only(&scene, n);
    }
    scene_steps(&scene, 46, 70);
    scene_close(&scene);
    TEST_ASSERT_NOT_EQUAL(OPMS_FRAME_ORPHAN, scene_of_frame(&scene, ODD_TAG)->frame_state);
    scene_assert_no_wrong_pair(&scene);
    scene_assert_paired(&scene, 1, 70);
}

/** The box has started anew; what it reported before is still on its way. */
static void the_last_frames_before_a_reboot_are_no_orphans_while_reports_may_come(void)
{
    scene_start(&scene, STAMP_ONLY);
    scene_steps(&scene, 1, 40);
    opms_trigger_report_t other = scene_report(&scene, 41);
    other.boot_id = BOOT + 1;
    scene_push_report(&scene, &other);
    scene_frame_only(&scene, 41);
    scene_frame_only(&scene, 42);
    scene_report_only(&scene, 43); /* tells 42 and 41 by its gaps */
    scene_frame_only(&scene, 43);
    scene_close(&scene);
    scene_assert_paired(&scene, 1, 43);
}

static void a_frame_behind_the_last_trigger_stays_uncertain(void)
{
    scene_start(&scene, STAMP_ONLY);
    scene_steps(&scene, 1, 40);
    const opms_event_report_t stop = {.kind = OPMS_EVENT_STOP,
                                      .boot_id = BOOT,
                                      .session_id = SESSION,
                                      .argument = 41};
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pairer_push_event(scene.pairer, &stop, NULL));
    scene_report_only(&scene, 41);
    opms_frame_t extra = scene_frame(&scene, 41);
    extra.camera_time_ticks += 45 * MS;
    extra.arrival_host_ns += 45 * MS;
    extra.frame_id += 1;
    extra.tag = ODD_TAG;
    scene_frame_only(&scene, 41);
    scene_push_frame(&scene, &extra);
    scene_close(&scene);
    scene_assert_paired(&scene, 1, 41);
    TEST_ASSERT_EQUAL(OPMS_FRAME_UNCERTAIN, scene_of_frame(&scene, ODD_TAG)->frame_state);
}

/** The camera restarts in the preamble. The id of the frame before it is that of a later one, too,
 * and so it names a trigger that came after it. */
static void a_trigger_is_not_missing_whose_frame_has_an_id_of_before_the_cameras_start(void)
{
    scene_start(&scene, ARRIVAL_ONLY);
    scene_steps(&scene, 1, 100);
    scene_close(&scene); /* the delay is known */
    scene_end(&scene);
    scene_start(&scene, ARRIVAL_ONLY);
    for (int n = 1; n <= 150; ++n) {
        opms_frame_t frame = scene_frame(&scene, n);
        frame.frame_id = n == 1 ? 10 : (uint64_t)(n - 5);
        scene_report_only(&scene, n);
        if (n == 1 || n >= 5) {
            scene_push_frame(&scene, &frame);
        }
    }
    scene_close(&scene);
    scene_assert_no_wrong_pair(&scene);
    scene_assert_paired(&scene, 6, 149);
    TEST_ASSERT_EQUAL(OPMS_TRIGGER_UNCERTAIN, scene_of_trigger(&scene, 1)->trigger_state);
    TEST_ASSERT_EQUAL(OPMS_TRIGGER_MISSING, scene_of_trigger(&scene, 3)->trigger_state);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(an_old_frame_is_no_orphan_though_no_pair_is_newer_yet);
    RUN_TEST(the_last_frames_before_a_reboot_are_no_orphans_while_reports_may_come);
    RUN_TEST(a_frame_behind_the_last_trigger_stays_uncertain);
    RUN_TEST(a_trigger_is_not_missing_whose_frame_has_an_id_of_before_the_cameras_start);
    return UNITY_END();
}
