/* SPDX-License-Identifier: Apache-2.0 */
/* A session against a box and a camera that are told what to do: order, times, losses, ends. */
#include <thread>

#include "engine_scene.hpp"

extern "C" {
#include "unity.h"
}

using namespace engine_scene;

void setUp(void) {}
void tearDown(void) {}

namespace {

/** Each picture once and in order; the right trigger and time wherever one is given.
 * @return How many have a time. */
std::size_t check_poses(Scene &scene)
{
    std::size_t with_time = 0;
    std::uint64_t number = 0;
    for (const auto &pose : scene.notes.poses()) {
        TEST_ASSERT_EQUAL_UINT64(++number, pose->number);
        if (pose->frame_state == OPMS_FRAME_PAIRED) {
            TEST_ASSERT_EQUAL_UINT64(scene.trigger_of_number[number], pose->trigger_number);
        } else {
            TEST_ASSERT_EQUAL_UINT64(0, pose->trigger_number);
            TEST_ASSERT_FALSE(pose->has_time);
        }
        if (pose->has_time) {
            ++with_time;
            TEST_ASSERT_TRUE(pose->is_mid_exposure);
            TEST_ASSERT_INT64_WITHIN(8, scene.scan_time_of_number[number], pose->t_scan_ns);
        }
    }
    TEST_ASSERT_EQUAL_UINT64(scene.frame_number, number);
    return with_time;
}

void a_scan_gives_each_picture_once_in_order_with_its_true_time(void)
{
    Scene scene;
    scene.connect();
    scene.begin(true);
    scene.pulses(30);
    ScanEnd end;
    TEST_ASSERT_TRUE(scene.stop(&end));
    TEST_ASSERT_TRUE(eventually([&] { return scene.notes.pose_count() == 36; }));
    TEST_ASSERT_EQUAL_UINT64(30, check_poses(scene));
    TEST_ASSERT_EQUAL_STRING("stop", end.reason.c_str());
    TEST_ASSERT_TRUE(end.has_summary);
    TEST_ASSERT_TRUE(end.summary.sums_hold);
    TEST_ASSERT_EQUAL_UINT64(36, end.summary.counters.triggers_paired);
    const std::vector<SessionState> wanted = {SessionState::arming,   SessionState::preamble,
                                              SessionState::ready,    SessionState::running,
                                              SessionState::stopping, SessionState::idle};
    TEST_ASSERT_TRUE(eventually([&] { return scene.notes.states().back() == wanted.back(); }));
    std::vector<SessionState> states = scene.notes.states();
    if (states.front() == SessionState::idle) {
        states.erase(states.begin());
    }
    TEST_ASSERT_EQUAL_UINT64(wanted.size(), states.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        TEST_ASSERT_EQUAL_INT(static_cast<int>(wanted[i]), static_cast<int>(states[i]));
    }
}

void the_recording_gets_all_of_it_and_nothing_after_its_end(void)
{
    Scene scene;
    scene.connect();
    scene.begin(true);
    Pulse from_memory;
    from_memory.report = false;
    from_memory.history = true;
    scene.pulses(5);
    scene.pulse(from_memory);
    scene.pulses(5);
    TEST_ASSERT_TRUE(scene.stop());
    scene.go(500);
    scene.taken();
    Tape &tape = *scene.tape;
    TEST_ASSERT_EQUAL_INT(1, tape.begun);
    TEST_ASSERT_EQUAL_INT(1, tape.ended);
    TEST_ASSERT_EQUAL_INT(0, tape.after_end);
    TEST_ASSERT_EQUAL_UINT64(17, tape.frames.size());
    TEST_ASSERT_EQUAL_UINT64(17, tape.poses.size());
    TEST_ASSERT_EQUAL_INT(16, tape.triggers);
    TEST_ASSERT_EQUAL_INT(1, tape.from_history);
    TEST_ASSERT_EQUAL_INT(17, tape.pairs);
    TEST_ASSERT_TRUE(tape.clocks > 10);
    TEST_ASSERT_TRUE(tape.reports >= 4);
    TEST_ASSERT_EQUAL_STRING("one", tape.header.name.c_str());
    TEST_ASSERT_TRUE(tape.header.has_box);
    TEST_ASSERT_EQUAL_UINT32(BOOT, tape.header.boot_id);
    TEST_ASSERT_NOT_EQUAL_UINT32(0, tape.header.session_id);
    TEST_ASSERT_EQUAL_UINT64(11, check_poses(scene));
}

/** A scan in which every sixth pulse is like @p how, four of them. */
void scan_with_losses(Scene &scene, const Pulse &how, ScanEnd &end)
{
    scene.connect();
    scene.begin();
    scene.pulses(10);
    for (int round = 0; round < 4; ++round) {
        scene.pulse(how);
        scene.pulses(5);
    }
    TEST_ASSERT_TRUE(scene.stop(&end));
    TEST_ASSERT_TRUE(eventually([&] { return scene.notes.pose_count() == scene.frame_number; }));
    TEST_ASSERT_TRUE(end.summary.sums_hold);
}

void lost_pictures_end_as_missing_and_the_others_keep_their_times(void)
{
    Scene scene;
    Pulse how;
    how.frame = false;
    ScanEnd end;
    scan_with_losses(scene, how, end);
    TEST_ASSERT_EQUAL_UINT64(30, check_poses(scene));
    TEST_ASSERT_EQUAL_UINT64(4, end.summary.counters.triggers_missing);
    TEST_ASSERT_TRUE(eventually([&] { return scene.notes.events("pair.missing") > 0; }));
}

void lost_reports_leave_pictures_without_a_time_and_none_with_a_wrong_one(void)
{
    Scene scene;
    Pulse how;
    how.report = false;
    ScanEnd end;
    scan_with_losses(scene, how, end);
    TEST_ASSERT_EQUAL_UINT64(30, check_poses(scene));
    TEST_ASSERT_EQUAL_UINT64(4, end.summary.counters.triggers_uncertain);
    TEST_ASSERT_EQUAL_UINT64(4, end.summary.counters.frames_uncertain);
}

void damaged_pictures_are_paired_but_not_located(void)
{
    Scene scene;
    Pulse how;
    how.damaged = true;
    ScanEnd end;
    scan_with_losses(scene, how, end);
    TEST_ASSERT_EQUAL_UINT64(34, check_poses(scene));
    for (const auto &pose : scene.notes.poses()) {
        const bool is_damaged = scene.trigger_of_number[pose->number] >= 17 &&
                                (scene.trigger_of_number[pose->number] - 17) % 6 == 0;
        TEST_ASSERT_EQUAL_INT(is_damaged, pose->light.picture_white == 0);
    }
}

void a_box_that_is_unplugged_and_comes_back_goes_on(void)
{
    Scene scene;
    scene.connect();
    scene.begin();
    scene.pulses(10);
    scene.link(OPMS_LINK_DISCONNECTED);
    Pulse unseen;
    unseen.report = false;
    unseen.history = true; /* what the box fills in when it is back */
    for (int i = 0; i < 10; ++i) {
        scene.pulse(unseen);
    }
    TEST_ASSERT_FALSE(scene.session->status().box_connected);
    TEST_ASSERT_TRUE(scene.session->status().state == SessionState::running);
    scene.link(OPMS_LINK_CONNECTED);
    scene.pulses(10);
    ScanEnd end;
    TEST_ASSERT_TRUE(scene.stop(&end));
    TEST_ASSERT_TRUE(eventually([&] { return scene.notes.pose_count() == 36; }));
    TEST_ASSERT_TRUE(check_poses(scene) >= 28);
    TEST_ASSERT_EQUAL_STRING("stop", end.reason.c_str());
    TEST_ASSERT_TRUE(scene.notes.hears("box.lost", 1));
    TEST_ASSERT_TRUE(scene.notes.hears("box.connected", 1));
}

void a_reboot_of_the_box_ends_the_run_and_the_next_one_begins_afresh(void)
{
    Scene scene;
    scene.connect();
    scene.begin(true);
    scene.pulses(10);
    scene.reboot();
    TEST_ASSERT_TRUE(eventually([&] {
        scene.go(20);
        return scene.session->status().state == SessionState::interrupted;
    }));
    TEST_ASSERT_EQUAL_STRING("box.rebooted", scene.tape->end.reason.c_str());
    TEST_ASSERT_TRUE(scene.notes.hears("box.rebooted", 1));
    std::string error;
    TEST_ASSERT_FALSE(scene.session->software_stop(nullptr, error));
    const std::size_t before = 16;
    TEST_ASSERT_TRUE(eventually([&] { return scene.notes.pose_count() == before; }));
    scene.go(2000); /* the clock of this boot is to be learnt */
    scene.begin(true);
    scene.pulses(10);
    ScanEnd end;
    TEST_ASSERT_TRUE(scene.stop(&end));
    TEST_ASSERT_TRUE(eventually([&] { return scene.notes.pose_count() == before + 16; }));
    const auto poses = scene.notes.poses();
    for (std::size_t i = before; i < poses.size(); ++i) {
        TEST_ASSERT_EQUAL_UINT64(i - before + 1, poses[i]->number);
        TEST_ASSERT_EQUAL_INT(OPMS_FRAME_PAIRED, poses[i]->frame_state);
        TEST_ASSERT_EQUAL_UINT64(i - before + 1, poses[i]->trigger_number);
    }
    TEST_ASSERT_EQUAL_UINT64(16, end.summary.counters.triggers);
}

void a_camera_that_comes_back_counts_anew_and_gets_its_exposure_again(void)
{
    Scene scene;
    scene.camera->given.exposure_min_us = 20;
    scene.camera->given.exposure_max_us = 10000;
    scene.connect();
    scene.begin();
    scene.pulses(10);
    scene.taken();
    TEST_ASSERT_TRUE(eventually([&] {
        const std::lock_guard<std::mutex> lock(scene.camera->mutex);
        return !scene.camera->exposures_set.empty();
    }));
    scene.camera_news(SourceItemKind::lost);
    Pulse unseen;
    unseen.frame = false;
    for (int i = 0; i < 5; ++i) {
        scene.pulse(unseen);
    }
    TEST_ASSERT_FALSE(scene.session->status().camera_connected);
    std::size_t set_before = 0;
    {
        const std::lock_guard<std::mutex> lock(scene.camera->mutex);
        set_before = scene.camera->exposures_set.size();
    }
    TEST_ASSERT_TRUE(set_before > 0);
    scene.ids_start_anew = true;
    scene.camera_news(SourceItemKind::back);
    scene.taken();
    TEST_ASSERT_TRUE(scene.session->status().camera_connected);
    {
        const std::lock_guard<std::mutex> lock(scene.camera->mutex);
        TEST_ASSERT_TRUE(scene.camera->exposures_set.size() > set_before);
    }
    scene.pulses(30);
    TEST_ASSERT_TRUE(scene.stop());
    TEST_ASSERT_TRUE(eventually([&] { return scene.notes.pose_count() == scene.frame_number; }));
    TEST_ASSERT_TRUE(check_poses(scene) >= 30);
    TEST_ASSERT_TRUE(scene.notes.hears("camera.lost", 1));
    TEST_ASSERT_TRUE(scene.notes.hears("camera.back", 1));
}

void a_box_that_was_away_at_the_stop_is_disarmed_when_it_is_back(void)
{
    Scene scene;
    scene.connect();
    scene.begin();
    scene.pulses(3);
    scene.link(OPMS_LINK_DISCONNECTED);
    scene.taken();
    TEST_ASSERT_TRUE(scene.stop());
    TEST_ASSERT_TRUE(scene.notes.hears("box.not_disarmed", 1));
    std::atomic<int> disarmed{0};
    scene.box->on_disarm = [&] { ++disarmed; };
    scene.link(OPMS_LINK_CONNECTED);
    TEST_ASSERT_TRUE(eventually([&] { return disarmed == 1; }));
}

void a_box_that_was_stopped_by_another_hand_ends_the_run(void)
{
    Scene scene;
    scene.connect();
    scene.begin(true);
    scene.pulses(3);
    scene.status(OPMS_BOX_IDLE);
    TEST_ASSERT_TRUE(eventually([&] {
        scene.go(20);
        return scene.session->status().state == SessionState::interrupted;
    }));
    TEST_ASSERT_EQUAL_STRING("box.stopped", scene.tape->end.reason.c_str());
}

void a_slow_listener_loses_no_pose(void)
{
    Scene scene;
    scene.options.frame_queue = 2;
    scene.connect();
    scene.begin();
    scene.notes.pose_delay_ms = 2;
    scene.pulses(400);
    TEST_ASSERT_TRUE(scene.stop());
    TEST_ASSERT_TRUE(eventually([&] { return scene.notes.pose_count() == scene.frame_number; }));
    TEST_ASSERT_EQUAL_UINT64(400, check_poses(scene));
}

void a_display_gets_no_pictures_while_the_camera_needs_its_buffers(void)
{
    Scene scene;
    scene.connect();
    scene.camera->lent = 15; /* of 16 */
    scene.begin();
    scene.pulses(20);
    TEST_ASSERT_TRUE(eventually([&] { return scene.notes.pose_count() == 26; }));
    TEST_ASSERT_EQUAL_INT(0, scene.notes.pictures);
    TEST_ASSERT_TRUE(eventually([&] { return scene.session->status().display_dropped == 26; }));
    scene.camera->lent = 1;
    scene.pulses(1);
    TEST_ASSERT_TRUE(eventually([&] { return scene.notes.pictures == 1; }));
    TEST_ASSERT_TRUE(scene.stop());
}

void a_session_may_end_in_any_state(void)
{
    for (int after = 0; after < 6; ++after) {
        Scene scene;
        scene.connect();
        ScanRequest request;
        request.recording = RecorderOptions();
        std::string error;
        if (after > 0) {
            TEST_ASSERT_TRUE(scene.session->software_start(request, error));
        }
        if (after > 1) {
            scene.preamble();
        }
        if (after > 2) {
            scene.press();
        }
        if (after > 3) {
            scene.pulses(3);
        }
        if (after > 4) {
            scene.camera_news(SourceItemKind::lost);
            scene.link(OPMS_LINK_DISCONNECTED);
        }
        scene.session.reset();
        TEST_ASSERT_EQUAL_INT(after > 0, scene.tape->begun);
        TEST_ASSERT_EQUAL_INT(after > 0, scene.tape->ended);
        TEST_ASSERT_EQUAL_UINT64(scene.tape->frames.size(), scene.tape->poses.size());
    }
}

void starts_that_cannot_be_are_refused_in_words(void)
{
    Scene scene;
    scene.connect();
    std::string error;
    TEST_ASSERT_FALSE(scene.session->software_stop(nullptr, error));
    TEST_ASSERT_FALSE(error.empty());
    ScanRequest request;
    request.recording = RecorderOptions();
    scene.box->refuses = true;
    TEST_ASSERT_FALSE(scene.session->software_start(request, error));
    TEST_ASSERT_EQUAL_STRING("it refuses", error.c_str());
    TEST_ASSERT_TRUE(scene.session->status().state == SessionState::idle);
    TEST_ASSERT_EQUAL_STRING("session.not_armed", scene.tape->end.reason.c_str());
    scene.box->refuses = false;
    scene.tape->refuse_begin = "no room";
    TEST_ASSERT_FALSE(scene.session->software_start(request, error));
    TEST_ASSERT_EQUAL_STRING("recording: no room", error.c_str());
    scene.tape->refuse_begin.clear();
    scene.link(OPMS_LINK_DISCONNECTED);
    scene.taken();
    TEST_ASSERT_FALSE(scene.session->software_start(request, error));
    TEST_ASSERT_EQUAL_STRING("no trigger box is connected", error.c_str());
    scene.link(OPMS_LINK_CONNECTED);
    scene.taken();
    scene.begin(true);
    TEST_ASSERT_FALSE(scene.session->software_start(request, error));
    TEST_ASSERT_EQUAL_STRING("a scan is going on already", error.c_str());
    TEST_ASSERT_TRUE(scene.stop());
}

void a_sensors_sample_is_placed_by_its_arrival(void)
{
    Scene scene;
    scene.connect();
    std::string error;
    SensorRecord sample;
    sample.sensor = "metal";
    sample.values = {1.5};
    TEST_ASSERT_FALSE(scene.session->add_sensor_sample(sample, error));
    scene.begin(true);
    scene.pulses(3);
    sample.t_bound_ns = 20 * MS;
    TEST_ASSERT_TRUE(scene.session->add_sensor_sample(sample, error));
    const std::int64_t arrival_scan_ns =
        scene.clock->now_ns() - BOX_BEHIND_NS - scene.start_edge_box_ns;
    TEST_ASSERT_TRUE(scene.stop());
    TEST_ASSERT_EQUAL_UINT64(1, scene.tape->samples.size());
    const SensorRecord &placed = scene.tape->samples[0];
    TEST_ASSERT_TRUE(placed.has_time);
    TEST_ASSERT_INT64_WITHIN(MS, arrival_scan_ns - 10 * MS, placed.t_scan_ns);
    TEST_ASSERT_TRUE(placed.t_bound_ns >= 10 * MS && placed.t_bound_ns < 11 * MS);
}

}  // namespace

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_scan_gives_each_picture_once_in_order_with_its_true_time);
    RUN_TEST(the_recording_gets_all_of_it_and_nothing_after_its_end);
    RUN_TEST(lost_pictures_end_as_missing_and_the_others_keep_their_times);
    RUN_TEST(lost_reports_leave_pictures_without_a_time_and_none_with_a_wrong_one);
    RUN_TEST(damaged_pictures_are_paired_but_not_located);
    RUN_TEST(a_box_that_is_unplugged_and_comes_back_goes_on);
    RUN_TEST(a_reboot_of_the_box_ends_the_run_and_the_next_one_begins_afresh);
    RUN_TEST(a_camera_that_comes_back_counts_anew_and_gets_its_exposure_again);
    RUN_TEST(a_box_that_was_away_at_the_stop_is_disarmed_when_it_is_back);
    RUN_TEST(a_box_that_was_stopped_by_another_hand_ends_the_run);
    RUN_TEST(a_slow_listener_loses_no_pose);
    RUN_TEST(a_display_gets_no_pictures_while_the_camera_needs_its_buffers);
    RUN_TEST(a_session_may_end_in_any_state);
    RUN_TEST(starts_that_cannot_be_are_refused_in_words);
    RUN_TEST(a_sensors_sample_is_placed_by_its_arrival);
    return UNITY_END();
}
