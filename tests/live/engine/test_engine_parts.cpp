/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of a session that have no threads, each alone. */
#include <cmath>
#include <cstring>
#include <thread>

#include "bar_motion.hpp"
#include "bounded_queue.hpp"
#include "engine_scene.hpp"
#include "event_gate.hpp"
#include "latency_histogram.hpp"
#include "pose_joiner.hpp"
#include "pose_times.hpp"
#include "run_tracker.hpp"
#include "sensor_time.hpp"

extern "C" {
#include "unity.h"
}

using namespace engine_scene;

void setUp(void) {}
void tearDown(void) {}

namespace {

std::unique_ptr<PoseRecord> pose_of(std::uint64_t number)
{
    auto pose = std::make_unique<PoseRecord>();
    pose->number = number;
    return pose;
}

opms_pair_result_t pair_of(std::uint64_t number)
{
    opms_pair_result_t result{};
    result.frame_state = OPMS_FRAME_PAIRED;
    result.trigger_state = OPMS_TRIGGER_PAIRED;
    result.known = OPMS_PAIR_HAS_TRIGGER_TIME | OPMS_PAIR_HAS_START_EDGE |
                   OPMS_PAIR_HAS_START_DELAY;
    result.trigger_number = 100 + number;
    result.trigger_box_ns = 5000;
    result.start_edge_box_ns = 1000;
    result.start_delay_ns = 10;
    result.mid_exposure_box_ns = 5010;
    result.frame.tag = number;
    return result;
}

void the_joiner_gives_poses_in_order_whatever_comes_first(void)
{
    PoseJoiner joiner(true);
    for (std::uint64_t number = 1; number <= 4; ++number) {
        joiner.expect(number, NOT_KNOWN);
    }
    TEST_ASSERT_TRUE(joiner.decided(pair_of(2)));
    TEST_ASSERT_TRUE(joiner.located(pose_of(2)));
    TEST_ASSERT_NULL(joiner.take(nullptr).get());
    TEST_ASSERT_TRUE(joiner.located(pose_of(1)));
    TEST_ASSERT_NULL(joiner.take(nullptr).get());
    TEST_ASSERT_TRUE(joiner.decided(pair_of(1)));
    TEST_ASSERT_EQUAL_UINT64(1, joiner.take(nullptr)->number);
    const std::unique_ptr<PoseRecord> second = joiner.take(nullptr);
    TEST_ASSERT_EQUAL_UINT64(2, second->number);
    TEST_ASSERT_EQUAL_UINT64(102, second->trigger_number);
    TEST_ASSERT_NULL(joiner.take(nullptr).get());
    TEST_ASSERT_EQUAL_UINT64(2, joiner.waiting());
}

void the_joiner_takes_nothing_twice_and_nothing_unexpected(void)
{
    PoseJoiner joiner(true);
    joiner.expect(1, NOT_KNOWN);
    TEST_ASSERT_FALSE(joiner.located(pose_of(2)));
    TEST_ASSERT_FALSE(joiner.decided(pair_of(0)));
    TEST_ASSERT_TRUE(joiner.located(pose_of(1)));
    TEST_ASSERT_FALSE(joiner.located(pose_of(1)));
    TEST_ASSERT_TRUE(joiner.decided(pair_of(1)));
    TEST_ASSERT_FALSE(joiner.decided(pair_of(1)));
    TEST_ASSERT_NOT_NULL(joiner.take(nullptr).get());
    TEST_ASSERT_FALSE(joiner.decided(pair_of(1)));
}

void a_time_needs_a_certain_pair_and_its_start_edge(void)
{
    PoseRecord pose;
    opms_pair_result_t result = pair_of(1);
    set_pose_times(result, NOT_KNOWN, nullptr, pose);
    TEST_ASSERT_TRUE(pose.has_time);
    TEST_ASSERT_FALSE(pose.is_mid_exposure);
    TEST_ASSERT_EQUAL_INT64(4010, pose.t_scan_ns);
    pose = PoseRecord();
    result.known &= ~static_cast<std::uint32_t>(OPMS_PAIR_HAS_START_EDGE);
    set_pose_times(result, NOT_KNOWN, nullptr, pose);
    TEST_ASSERT_FALSE(pose.has_time);
    result = pair_of(1);
    result.frame_state = OPMS_FRAME_UNCERTAIN;
    pose = PoseRecord();
    set_pose_times(result, NOT_KNOWN, nullptr, pose);
    TEST_ASSERT_FALSE(pose.has_time);
    TEST_ASSERT_EQUAL_UINT64(0, pose.trigger_number);
}

void the_exposure_is_the_strobes_then_the_frames_then_the_profiles(void)
{
    PoseRecord pose;
    opms_pair_result_t result = pair_of(1);
    result.known |= OPMS_PAIR_HAS_EXPOSURE | OPMS_PAIR_HAS_MID_EXPOSURE;
    result.exposure_ns = 2000;
    result.mid_exposure_box_ns = 6010;
    set_pose_times(result, NOT_KNOWN, nullptr, pose);
    TEST_ASSERT_EQUAL_INT64(5010, pose.t_scan_ns);
    set_pose_times(result, 4.0, nullptr, pose);
    TEST_ASSERT_EQUAL_INT64(6010, pose.t_scan_ns);
    TEST_ASSERT_TRUE(pose.is_mid_exposure);
    result.known |= OPMS_PAIR_EXPOSURE_SEEN;
    set_pose_times(result, 4.0, nullptr, pose);
    TEST_ASSERT_EQUAL_INT64(5010, pose.t_scan_ns);
}

void percentiles_of_delays_are_right_to_three_percent(void)
{
    LatencyHistogram histogram;
    for (int i = 1; i <= 1000; ++i) {
        histogram.add(MS * i, MS * i / 10, 90 * MS); /* 0.1 to 100 ms */
    }
    const LatencyFigures figures = histogram.figures(1000 * MS);
    TEST_ASSERT_EQUAL_UINT64(1000, figures.count);
    TEST_ASSERT_EQUAL_UINT64(100, figures.missed);
    TEST_ASSERT_DOUBLE_WITHIN(1.5, 50.0, figures.p50_ms);
    TEST_ASSERT_DOUBLE_WITHIN(3.0, 99.0, figures.p99_ms);
    TEST_ASSERT_DOUBLE_WITHIN(0.11, 99.9, figures.p999_ms);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 100.0, figures.most_ms);
}

void delays_older_than_a_minute_are_forgotten(void)
{
    LatencyHistogram histogram;
    histogram.add(5000 * MS, 500 * MS, 0);
    histogram.add(62'000 * MS, MS, 0);
    TEST_ASSERT_EQUAL_UINT64(1, histogram.figures(62'000 * MS).count);
    TEST_ASSERT_EQUAL_UINT64(0, histogram.figures(200'000 * MS).count);
    histogram.add(200'000 * MS, -MS, 0); /* a clock of a simulation may stand behind */
    TEST_ASSERT_EQUAL_UINT64(1, histogram.figures(200'000 * MS).count);
}

opms_box_item_t status_item(std::uint32_t number, opms_box_state_t state, std::uint32_t session,
                            std::uint32_t boot = 5)
{
    opms_box_item_t item{};
    item.kind = OPMS_ITEM_STATUS;
    item.t_host_ns = 1000;
    item.as.status.boot_id = boot;
    item.as.status.session_id = session;
    item.as.status.state = state;
    item.as.status.report_number = number;
    return item;
}

void a_run_follows_the_newest_word_of_its_own_session(void)
{
    RunTracker run;
    run.begin(5, 9, 500);
    run.take(status_item(10, OPMS_BOX_IDLE, 8)); /* of the session before */
    TEST_ASSERT_NULL(run.over());
    run.take(status_item(12, OPMS_BOX_WAITING, 9));
    TEST_ASSERT_TRUE(run.state() == SessionState::ready);
    run.take(status_item(11, OPMS_BOX_PREAMBLE, 9)); /* overtaken */
    TEST_ASSERT_TRUE(run.state() == SessionState::ready);
    run.take(status_item(13, OPMS_BOX_RUNNING, 9));
    TEST_ASSERT_TRUE(run.state() == SessionState::running);
    run.take(status_item(14, OPMS_BOX_IDLE, 9));
    TEST_ASSERT_EQUAL_STRING("box.stopped", run.over());
}

void report_numbers_may_wrap(void)
{
    RunTracker run;
    run.begin(5, 9, 500);
    run.take(status_item(0xFFFFFFFF, OPMS_BOX_PREAMBLE, 9));
    run.take(status_item(1, OPMS_BOX_WAITING, 9));
    TEST_ASSERT_TRUE(run.state() == SessionState::ready);
}

void another_boot_or_another_session_ends_a_run(void)
{
    RunTracker run;
    run.begin(5, 9, 500);
    opms_box_item_t old = status_item(1, OPMS_BOX_IDLE, 9, 4);
    old.t_host_ns = 499; /* of before the run */
    run.take(old);
    TEST_ASSERT_NULL(run.over());
    run.take(status_item(1, OPMS_BOX_IDLE, 9, 6));
    TEST_ASSERT_EQUAL_STRING("box.rebooted", run.over());
    run.begin(5, 9, 500);
    run.take(status_item(2, OPMS_BOX_RUNNING, 9));
    run.take(status_item(3, OPMS_BOX_RUNNING, 77));
    TEST_ASSERT_EQUAL_STRING("box.taken", run.over());
}

void a_sample_of_unknown_age_has_no_bound_and_none_without_a_start(void)
{
    opms_clock_t *box_clock = nullptr;
    TEST_ASSERT_EQUAL_INT(OPMS_OK, opms_clock_create(nullptr, &box_clock, nullptr));
    for (int i = 0; i < 10; ++i) {
        const std::int64_t t_ns = 1000 * MS + i * 200 * MS;
        const opms_round_trip_t trip = {t_ns, t_ns + MS / 2 - 300 * MS, t_ns + MS / 2 - 300 * MS,
                                        t_ns + MS};
        TEST_ASSERT_EQUAL_INT(OPMS_OK, opms_clock_push(box_clock, &trip, nullptr));
    }
    ScanAxis axis;
    axis.box_clock = box_clock;
    SensorRecord sample;
    sample.arrival_host_ns = 4000 * MS;
    place_sensor_sample(axis, sample);
    TEST_ASSERT_FALSE(sample.has_time);
    axis.has_start_edge = true;
    axis.start_edge_box_ns = 700 * MS;
    place_sensor_sample(axis, sample);
    TEST_ASSERT_TRUE(sample.has_time);
    TEST_ASSERT_INT64_WITHIN(MS / 10, 3000 * MS, sample.t_scan_ns);
    TEST_ASSERT_EQUAL_INT64(0, sample.t_bound_ns);
    sample.t_scan_ns = 42;
    place_sensor_sample(axis, sample); /* it has a time: that of the sensor */
    TEST_ASSERT_EQUAL_INT64(42, sample.t_scan_ns);
    opms_clock_destroy(box_clock);
}

void a_sample_that_cannot_be_is_refused(void)
{
    SensorRecord sample;
    sample.sensor = "gpr";
    sample.values = {1};
    TEST_ASSERT_EQUAL_STRING("", sensor_sample_problem(sample).c_str());
    sample.values = {NAN};
    TEST_ASSERT_FALSE(sensor_sample_problem(sample).empty());
    sample.values.clear();
    TEST_ASSERT_FALSE(sensor_sample_problem(sample).empty());
    sample.data_json = "{}";
    TEST_ASSERT_TRUE(sensor_sample_problem(sample).empty());
    sample.sensor = std::string(65, 'x');
    TEST_ASSERT_FALSE(sensor_sample_problem(sample).empty());
    sample.sensor = "gpr";
    sample.t_bound_ns = -1;
    TEST_ASSERT_FALSE(sensor_sample_problem(sample).empty());
}

void an_event_that_comes_often_is_told_once_a_second_with_the_number_left_out(void)
{
    EventGate gate;
    int told = 0;
    EventRecord last;
    for (int i = 0; i <= 25; ++i) {
        EventRecord event;
        event.code = "a";
        event.text = "it is so";
        event.t_host_ns = i * 100 * MS;
        if (gate.pass(event)) {
            ++told;
            last = event;
        }
    }
    TEST_ASSERT_EQUAL_INT(3, told);
    TEST_ASSERT_EQUAL_STRING("it is so (and 9 more before)", last.text.c_str());
    EventRecord other;
    other.code = "b";
    other.t_host_ns = 2501 * MS;
    TEST_ASSERT_TRUE(gate.pass(other));
}

void a_full_queue_makes_who_fills_it_wait_and_loses_nothing(void)
{
    BoundedQueue<int> queue(3);
    std::atomic<int> pushed{0};
    std::thread filler([&] {
        for (int i = 0; i < 100; ++i) {
            queue.push(i);
            ++pushed;
        }
        queue.close();
    });
    TEST_ASSERT_TRUE(eventually([&] { return pushed == 3; }));
    TEST_ASSERT_FALSE(queue.push_if_empty(7));
    int item = -1;
    for (int i = 0; i < 100; ++i) {
        TEST_ASSERT_TRUE(queue.pop(item));
        TEST_ASSERT_EQUAL_INT(i, item);
    }
    filler.join();
    TEST_ASSERT_FALSE(queue.pop(item));
    TEST_ASSERT_FALSE(queue.push(1));
}

std::vector<opms_square_t> square_at(int index, double u, double v)
{
    opms_square_t square{};
    square.index = index;
    for (auto &corner : square.corners_px) {
        corner[0] = u;
        corner[1] = v;
    }
    return {square};
}

void the_bars_speed_is_that_of_squares_seen_twice(void)
{
    BarMotion motion;
    motion.take(square_at(4, 100, 100), 1000 * MS);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, motion.speed_px_s(1000 * MS));
    motion.take(square_at(4, 130, 140), 1100 * MS);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 500, motion.speed_px_s(1100 * MS));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, motion.speed_px_s(1700 * MS));
    motion.take(square_at(5, 0, 0), 1200 * MS); /* another square */
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, motion.speed_px_s(1200 * MS));
}

}  // namespace

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_joiner_gives_poses_in_order_whatever_comes_first);
    RUN_TEST(the_joiner_takes_nothing_twice_and_nothing_unexpected);
    RUN_TEST(a_time_needs_a_certain_pair_and_its_start_edge);
    RUN_TEST(the_exposure_is_the_strobes_then_the_frames_then_the_profiles);
    RUN_TEST(percentiles_of_delays_are_right_to_three_percent);
    RUN_TEST(delays_older_than_a_minute_are_forgotten);
    RUN_TEST(a_run_follows_the_newest_word_of_its_own_session);
    RUN_TEST(report_numbers_may_wrap);
    RUN_TEST(another_boot_or_another_session_ends_a_run);
    RUN_TEST(a_sample_of_unknown_age_has_no_bound_and_none_without_a_start);
    RUN_TEST(a_sample_that_cannot_be_is_refused);
    RUN_TEST(an_event_that_comes_often_is_told_once_a_second_with_the_number_left_out);
    RUN_TEST(a_full_queue_makes_who_fills_it_wait_and_loses_nothing);
    RUN_TEST(the_bars_speed_is_that_of_squares_seen_twice);
    return UNITY_END();
}
