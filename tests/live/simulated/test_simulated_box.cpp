/* SPDX-License-Identifier: Apache-2.0 */
/* The simulated box keeps what docs/wire.md promises. */
#include <cmath>

#include <unity.h>

#include "world_scene.hpp"

using namespace opms_host;

extern "C" void setUp(void) {}
extern "C" void tearDown(void) {}

static void arm(WorldScene &scene, std::uint32_t session_id)
{
    std::string error;
    TEST_ASSERT_TRUE_MESSAGE(scene.box().arm(session_id, error), error.c_str());
}

static void press(WorldScene &scene)
{
    std::string error;
    TEST_ASSERT_TRUE_MESSAGE(scene.box().press_start(error), error.c_str());
}

static std::int64_t cycles_of(opms_box_time_t time)
{
    return static_cast<std::int64_t>(time.us) * OPMS_BOX_CYCLES_PER_US + time.cycles;
}

static std::vector<opms_trigger_report_t> triggers(const WorldScene &scene)
{
    std::vector<opms_trigger_report_t> found;
    for (const opms_box_item_t &item : scene.of_kind(OPMS_ITEM_TRIGGER)) {
        found.push_back(item.as.trigger);
    }
    return found;
}

static void test_preamble_has_the_coded_gaps_and_numbers_from_1(void)
{
    WorldScene scene(scene_options("strobe=0"));
    arm(scene, 5);
    scene.run_for(2);
    const auto sent = triggers(scene);
    const std::int64_t gaps_ms[] = {100, 200, 100, 300, 100};
    TEST_ASSERT_EQUAL(6, sent.size());
    for (std::size_t i = 0; i < sent.size(); ++i) {
        TEST_ASSERT_EQUAL(i + 1, sent[i].trigger_number);
        TEST_ASSERT_EQUAL(5, sent[i].session_id);
        TEST_ASSERT_EQUAL(OPMS_TRIGGER_PREAMBLE, sent[i].flags);
        TEST_ASSERT_EQUAL(0, sent[i].first_run_number);
        if (i > 0) {
            const std::int64_t gap = cycles_of(sent[i].time) - cycles_of(sent[i - 1].time);
            TEST_ASSERT_INT64_WITHIN(2, gaps_ms[i - 1] * 125000, gap);
            TEST_ASSERT_INT64_WITHIN(1, gaps_ms[i - 1] * 1000, sent[i].gap_us[0]);
        }
    }
    TEST_ASSERT_EQUAL(1, scene.events(OPMS_EVENT_ARMED).size());
    TEST_ASSERT_EQUAL(6, scene.events(OPMS_EVENT_WAITING).at(0).argument);
}

static void test_the_run_has_its_exact_period_after_edge_debounce_and_4_cycles(void)
{
    WorldScene scene(scene_options("box_drift_ppm=80"));
    arm(scene, 5);
    scene.run_for(2);
    press(scene);
    scene.run_for(60);
    const auto sent = triggers(scene);
    const auto start = scene.events(OPMS_EVENT_START);
    TEST_ASSERT_EQUAL(1, start.size());
    TEST_ASSERT_EQUAL(7, start[0].argument);
    TEST_ASSERT_GREATER_THAN(600, sent.size());
    for (std::size_t i = 6; i < sent.size(); ++i) {
        const std::int64_t after = cycles_of(sent[i].time) - cycles_of(start[0].time);
        TEST_ASSERT_EQUAL_INT64(125 + 4 + static_cast<std::int64_t>(i - 6) * 12500000, after);
        TEST_ASSERT_EQUAL(7, sent[i].first_run_number);
        TEST_ASSERT_EQUAL_INT64(cycles_of(start[0].time), cycles_of(sent[i].start_edge));
        TEST_ASSERT_TRUE(sent[i].flags & OPMS_TRIGGER_RUN);
    }
}

static void test_the_quartz_drifts_by_what_was_asked(void)
{
    WorldScene scene(scene_options("box_drift_ppm=80"));
    arm(scene, 5);
    scene.run_for(2);
    press(scene);
    scene.run_for(100);
    const auto truth = scene.world().true_triggers();
    const double box = static_cast<double>(truth.back().box_ns - truth.front().box_ns);
    const double host = static_cast<double>(truth.back().host_ns - truth.front().host_ns);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 80, (box / host - 1) * 1e6);
}

static void test_reports_leave_within_2_ms_and_repeat_the_last_exposure(void)
{
    WorldScene scene(scene_options());
    scene.start_source();
    arm(scene, 5);
    scene.run_for(2);
    press(scene);
    scene.run_for(5.05);
    const auto items = scene.of_kind(OPMS_ITEM_TRIGGER);
    const auto truth = scene.world().true_triggers();
    TEST_ASSERT_EQUAL(truth.size(), items.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
        const opms_trigger_report_t &report = items[i].as.trigger;
        TEST_ASSERT_EQUAL_INT64(truth[i].box_ns, opms_box_time_ns(report.time));
        TEST_ASSERT_FALSE(report.flags & OPMS_TRIGGER_DELAYED);
        TEST_ASSERT_INT64_WITHIN(2 * SCENE_MS, 0, items[i].t_host_ns - truth[i].host_ns);
        if (i > 0) {
            TEST_ASSERT_TRUE(report.flags & OPMS_TRIGGER_STROBE);
            TEST_ASSERT_EQUAL(i, report.strobe_for_trigger);
            TEST_ASSERT_INT_WITHIN(3, 30 * 125, report.strobe_delay_cycles);
            TEST_ASSERT_INT_WITHIN(30, 1000 * 125, report.strobe_length_cycles);
        }
    }
}

static void test_start_in_the_preamble_cuts_it_and_begins_the_run_at_once(void)
{
    WorldScene scene(scene_options());
    arm(scene, 5);
    scene.run_for(0.35);
    press(scene);
    scene.run_for(2);
    const auto sent = triggers(scene);
    TEST_ASSERT_EQUAL(3, scene.events(OPMS_EVENT_PREAMBLE_CUT).at(0).argument);
    TEST_ASSERT_EQUAL(4, scene.events(OPMS_EVENT_START).at(0).argument);
    TEST_ASSERT_EQUAL(4, sent.at(3).first_run_number);
    TEST_ASSERT_TRUE(sent[3].flags & OPMS_TRIGGER_PREAMBLE_CUT);
    TEST_ASSERT_EQUAL(0, scene.events(OPMS_EVENT_WAITING).size());
}

static void test_start_in_idle_and_while_running_does_nothing_but_an_event(void)
{
    WorldScene scene(scene_options());
    scene.run_for(1);
    press(scene);
    scene.run_for(1);
    TEST_ASSERT_EQUAL(OPMS_BOX_IDLE, scene.events(OPMS_EVENT_START_REFUSED).at(0).argument);
    arm(scene, 9);
    scene.run_for(2);
    press(scene);
    scene.run_for(1.05);
    press(scene);
    scene.run_for(1);
    TEST_ASSERT_EQUAL(OPMS_BOX_RUNNING, scene.events(OPMS_EVENT_START_REFUSED).at(1).argument);
    const auto sent = triggers(scene);
    TEST_ASSERT_EQUAL_INT64(12500000,
                            cycles_of(sent.back().time) - cycles_of(sent[sent.size() - 2].time));
}

static void test_disarm_ends_the_pulses_and_a_new_arm_counts_from_1(void)
{
    WorldScene scene(scene_options());
    std::string error;
    arm(scene, 5);
    TEST_ASSERT_FALSE(scene.box().arm(6, error));
    TEST_ASSERT_EQUAL_STRING("the box refuses to be armed: not in this state", error.c_str());
    scene.run_for(0.35);
    TEST_ASSERT_TRUE(scene.box().disarm(error));
    scene.run_for(2);
    TEST_ASSERT_EQUAL(3, triggers(scene).size());
    TEST_ASSERT_EQUAL(3, scene.events(OPMS_EVENT_STOP).at(0).argument);
    TEST_ASSERT_EQUAL(1, scene.events(OPMS_EVENT_REFUSED).size());
    arm(scene, 6);
    scene.run_for(0.05);
    TEST_ASSERT_EQUAL(1, triggers(scene).back().trigger_number);
    TEST_ASSERT_EQUAL(6, triggers(scene).back().session_id);
}

static void test_settings_are_taken_in_idle_and_checked(void)
{
    WorldScene scene(scene_options());
    std::string error;
    opms_settings_report_t report = {};
    TEST_ASSERT_TRUE(scene.box().settings(report, error));
    TEST_ASSERT_TRUE(report.settings.strobe_enabled);
    opms_settings_t settings = report.settings;
    settings.period_us = 20000;
    for (std::uint16_t &gap_ms : settings.preamble_gap_ms) {
        gap_ms = 0;
    }
    TEST_ASSERT_TRUE_MESSAGE(scene.box().set_settings(settings, error), error.c_str());
    settings.period_us = 5;
    TEST_ASSERT_FALSE(scene.box().set_settings(settings, error));
    TEST_ASSERT_TRUE(scene.box().settings(report, error));
    TEST_ASSERT_EQUAL(20000, report.settings.period_us);
    TEST_ASSERT_TRUE(report.stored);
    arm(scene, 3);
    TEST_ASSERT_FALSE(scene.box().set_settings(report.settings, error));
    scene.run_for(0.1);
    press(scene);
    scene.run_for(1);
    TEST_ASSERT_INT_WITHIN(1, 50, triggers(scene).size());
    TEST_ASSERT_EQUAL(1, triggers(scene)[0].first_run_number);
}

static void test_status_comes_each_second_and_pongs_tell_the_boxs_time(void)
{
    WorldScene scene(scene_options("ping_ms=500"));
    scene.run_for(20.2);
    const auto statuses = scene.of_kind(OPMS_ITEM_STATUS);
    TEST_ASSERT_INT_WITHIN(1, 20, statuses.size());
    for (const opms_box_item_t &item : scene.of_kind(OPMS_ITEM_PONG)) {
        const opms_pong_report_t &pong = item.as.pong.report;
        const std::int64_t trip = item.t_host_ns - item.as.pong.t_sent_host_ns;
        const std::int64_t in_box = opms_box_time_ns(pong.sent) - opms_box_time_ns(pong.received);
        TEST_ASSERT_TRUE(item.as.pong.t_sent_host_ns > 0);
        TEST_ASSERT_TRUE(in_box >= 0 && in_box <= trip && trip < 5 * SCENE_MS);
    }
    TEST_ASSERT_INT_WITHIN(1, 40, scene.of_kind(OPMS_ITEM_PONG).size());
}

static void test_an_unplugged_box_goes_on_and_tells_all_when_it_is_back(void)
{
    WorldScene scene(scene_options("box_unplug=2+3"));
    std::string error;
    arm(scene, 5);
    scene.run_for(2);
    press(scene);
    scene.run_for(3);
    opms_identity_report_t identity = {};
    TEST_ASSERT_FALSE(scene.box().identity(identity));
    TEST_ASSERT_FALSE(scene.box().disarm(error));
    TEST_ASSERT_EQUAL_STRING("the simulated box is unplugged", error.c_str());
    scene.run_for(5.05);
    const auto links = scene.of_kind(OPMS_ITEM_LINK);
    TEST_ASSERT_EQUAL(3, links.size());
    TEST_ASSERT_EQUAL(OPMS_LINK_DISCONNECTED, links[1].as.link.change);
    TEST_ASSERT_EQUAL(OPMS_LINK_CONNECTED, links[2].as.link.change);
    TEST_ASSERT_EQUAL(links[0].as.link.boot_id, links[2].as.link.boot_id);
    TEST_ASSERT_EQUAL(scene.world().true_triggers().size(), triggers(scene).size());
}

static void test_a_rebooted_box_is_idle_has_another_boot_id_and_counts_anew(void)
{
    WorldScene scene(scene_options("box_reboot=2+1"));
    arm(scene, 5);
    scene.run_for(2);
    press(scene);
    scene.run_for(6);
    const auto links = scene.of_kind(OPMS_ITEM_LINK);
    TEST_ASSERT_EQUAL(4, links.size());
    TEST_ASSERT_EQUAL(OPMS_LINK_REBOOTED, links[3].as.link.change);
    TEST_ASSERT_TRUE(links[0].as.link.boot_id != links[3].as.link.boot_id);
    const opms_status_report_t status = scene.of_kind(OPMS_ITEM_STATUS).back().as.status;
    TEST_ASSERT_EQUAL(OPMS_BOX_IDLE, status.state);
    TEST_ASSERT_EQUAL(links[3].as.link.boot_id, status.boot_id);
    TEST_ASSERT_TRUE(status.report_number < 20 && status.uptime_us < 6000000);
}

static void test_lost_reports_are_told_and_fetched_from_history(void)
{
    WorldScene scene(scene_options("report_lost=0.1,seed=3"));
    scene.start_source();
    arm(scene, 5);
    scene.run_for(2);
    press(scene);
    scene.run_for(60);
    std::vector<bool> known(scene.world().true_triggers().size() + 1, false);
    for (const opms_box_item_t &item : scene.items) {
        if (item.kind == OPMS_ITEM_TRIGGER) {
            known[item.as.trigger.trigger_number] = true;
        } else if (item.kind == OPMS_ITEM_HISTORY) {
            const opms_history_entry_t &entry = item.as.history.entry;
            const TrueTrigger truth = scene.world().true_triggers().at(entry.number - 1);
            TEST_ASSERT_FALSE(entry.flags & OPMS_TRIGGER_NOT_HELD);
            TEST_ASSERT_EQUAL_INT64(truth.box_ns, opms_box_time_ns(entry.time));
            known[entry.number] = true;
        }
    }
    TEST_ASSERT_GREATER_THAN(10, scene.of_kind(OPMS_ITEM_HISTORY).size());
    TEST_ASSERT_GREATER_THAN(5, scene.of_kind(OPMS_ITEM_LOST).size());
    for (std::size_t number = 1; number + 20 < known.size(); ++number) {
        TEST_ASSERT_TRUE(known[number]);
    }
}

static void test_a_glitch_makes_an_event_and_no_pulse(void)
{
    WorldScene scene(scene_options("glitch=1.03"));
    arm(scene, 5);
    scene.run_for(2);
    press(scene);
    scene.run_for(3);
    const auto glitches = scene.events(OPMS_EVENT_GLITCH);
    TEST_ASSERT_EQUAL(1, glitches.size());
    TEST_ASSERT_EQUAL(50, glitches[0].argument);
    TEST_ASSERT_EQUAL(6 + 30, triggers(scene).size());
}

static void test_waiting_times_out_where_that_is_set(void)
{
    WorldScene scene(scene_options());
    std::string error;
    opms_settings_report_t report = {};
    TEST_ASSERT_TRUE(scene.box().settings(report, error));
    report.settings.wait_timeout_s = 3;
    TEST_ASSERT_TRUE(scene.box().set_settings(report.settings, error));
    arm(scene, 5);
    scene.run_for(6);
    TEST_ASSERT_EQUAL(6, scene.events(OPMS_EVENT_WAIT_TIMEOUT).at(0).argument);
    press(scene);
    scene.run_for(1);
    TEST_ASSERT_EQUAL(6, triggers(scene).size());
}

static void test_an_exposure_that_is_not_seen_is_told_missing(void)
{
    WorldScene scene(scene_options("trigger_ignored=0.05,seed=8"));
    scene.start_source();
    arm(scene, 5);
    scene.run_for(2);
    press(scene);
    scene.run_for(60);
    std::vector<bool> exposed(scene.world().true_triggers().size() + 1, false);
    for (const TrueFrame &frame : scene.world().true_frames()) {
        exposed[frame.trigger_number] = true;
    }
    const auto missing = scene.events(OPMS_EVENT_STROBE_MISSING);
    TEST_ASSERT_GREATER_THAN(5, missing.size());
    for (const opms_event_report_t &event : missing) {
        TEST_ASSERT_FALSE(exposed[event.argument]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_preamble_has_the_coded_gaps_and_numbers_from_1);
    RUN_TEST(test_the_run_has_its_exact_period_after_edge_debounce_and_4_cycles);
    RUN_TEST(test_the_quartz_drifts_by_what_was_asked);
    RUN_TEST(test_reports_leave_within_2_ms_and_repeat_the_last_exposure);
    RUN_TEST(test_start_in_the_preamble_cuts_it_and_begins_the_run_at_once);
    RUN_TEST(test_start_in_idle_and_while_running_does_nothing_but_an_event);
    RUN_TEST(test_disarm_ends_the_pulses_and_a_new_arm_counts_from_1);
    RUN_TEST(test_settings_are_taken_in_idle_and_checked);
    RUN_TEST(test_status_comes_each_second_and_pongs_tell_the_boxs_time);
    RUN_TEST(test_an_unplugged_box_goes_on_and_tells_all_when_it_is_back);
    RUN_TEST(test_a_rebooted_box_is_idle_has_another_boot_id_and_counts_anew);
    RUN_TEST(test_lost_reports_are_told_and_fetched_from_history);
    RUN_TEST(test_a_glitch_makes_an_event_and_no_pulse);
    RUN_TEST(test_waiting_times_out_where_that_is_set);
    RUN_TEST(test_an_exposure_that_is_not_seen_is_told_missing);
    return UNITY_END();
}
