/* SPDX-License-Identifier: Apache-2.0 */
/* The simulated camera: ids, times, exposure, buffers, restarts. */
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <unity.h>

#include "world_scene.hpp"

using namespace opms_host;

extern "C" void setUp(void) {}
extern "C" void tearDown(void) {}

static void start_run(WorldScene &scene)
{
    std::string error;
    TEST_ASSERT_TRUE_MESSAGE(scene.box().arm(5, error), error.c_str());
    scene.run_for(2);
    TEST_ASSERT_TRUE_MESSAGE(scene.box().press_start(error), error.c_str());
}

static void test_each_trigger_is_exposed_after_the_start_delay_and_stamped(void)
{
    WorldScene scene(scene_options("start_delay_us=50,exposure_us=2000,camera_drift_ppm=100"));
    scene.start_source();
    start_run(scene);
    scene.run_for(60.05);
    const auto triggers = scene.world().true_triggers();
    const auto truth = scene.world().true_frames();
    TEST_ASSERT_EQUAL(triggers.size(), truth.size());
    TEST_ASSERT_EQUAL(truth.size(), scene.frames.size());
    for (std::size_t i = 0; i < truth.size(); ++i) {
        TEST_ASSERT_EQUAL(i + 1, truth[i].trigger_number);
        TEST_ASSERT_INT64_WITHIN(1, triggers[i].host_ns + 1050000, truth[i].mid_host_ns);
        TEST_ASSERT_EQUAL_UINT64(truth[i].frame_id, scene.frames[i].frame_id);
        TEST_ASSERT_EQUAL_UINT64(truth[i].camera_time_ticks, scene.frames[i].camera_time_ticks);
        const std::int64_t arrival = scene.frames[i].arrival_host_ns - triggers[i].host_ns;
        TEST_ASSERT_TRUE(arrival > 14 * SCENE_MS && arrival < 17 * SCENE_MS);
    }
    const double ticks = static_cast<double>(truth.back().camera_time_ticks -
                                             truth.front().camera_time_ticks);
    const double host = static_cast<double>(truth.back().mid_host_ns - truth.front().mid_host_ns);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 100, (ticks / host - 1) * 1e6);
}

static void test_a_command_of_exposure_acts_after_some_frames_and_is_reported(void)
{
    WorldScene scene(scene_options("exposure_delay=3"));
    scene.start_source();
    start_run(scene);
    scene.run_for(1.05);
    const std::size_t before = scene.frames.size();
    std::string error;
    TEST_ASSERT_TRUE(scene.source().set_exposure(4000, 6, error));
    scene.run_for(1);
    for (std::size_t i = 0; i < scene.frames.size(); ++i) {
        const bool acts = i >= before + 3;
        TEST_ASSERT_EQUAL_DOUBLE(acts ? 4000 : 1000, scene.frames[i].exposure_us);
        TEST_ASSERT_EQUAL_DOUBLE(acts ? 6 : 0, scene.frames[i].gain_db);
    }
    TEST_ASSERT_FALSE(scene.source().set_exposure(-1, 0, error));
    TEST_ASSERT_FALSE(scene.source().set_exposure(NAN, 0, error));
}

static void test_time_stands_still_while_all_buffers_are_lent(void)
{
    WorldScene scene(scene_options());
    std::vector<FramePtr> kept;
    SceneListener listener;
    listener.on_source = [&](const SourceItem &item) { kept.push_back(item.frame); };
    scene.listen(listener);
    scene.start_source(3);
    std::string error;
    TEST_ASSERT_TRUE(scene.box().arm(5, error));
    const std::int64_t far = scene.now_ns() + 10 * SCENE_S;
    SourceItem item;
    while (scene.world().step(far)) {
        scene.source().wait(0, item);
        if (item.frame) {
            kept.push_back(item.frame);
        }
    }
    item.frame.reset();
    TEST_ASSERT_EQUAL(3, kept.size());
    TEST_ASSERT_TRUE(scene.now_ns() < far);
    TEST_ASSERT_EQUAL(3, scene.source().counters().lent);
    kept.clear();
    TEST_ASSERT_EQUAL(0, scene.source().counters().lent);
    TEST_ASSERT_TRUE(scene.world().step(far));
    TEST_ASSERT_EQUAL_UINT64(0, scene.source().counters().no_buffer);
}

static void test_frames_outlive_their_source_and_their_world(void)
{
    FramePtr kept;
    {
        WorldScene scene(scene_options());
        SceneListener listener;
        listener.on_source = [&](const SourceItem &item) { kept = item.frame; };
        scene.listen(listener);
        scene.start_source();
        start_run(scene);
        scene.run_for(1);
        scene.source().stop();
    }
    TEST_ASSERT_NOT_NULL(kept.get());
    const auto *const pixels = static_cast<const std::uint8_t *>(kept->image.pixels);
    TEST_ASSERT_EQUAL(128, pixels[kept->image.stride_bytes * (kept->image.height_px - 1)]);
}

static void test_a_camera_that_restarts_says_so_and_begins_anew(void)
{
    WorldScene scene(scene_options("camera_restart=3.05+1"));
    scene.start_source();
    start_run(scene);
    scene.run_for(8);
    std::vector<SourceItemKind> news;
    std::size_t first_after = 0;
    for (std::size_t i = 0, frames = 0; i < scene.source_items.size(); ++i) {
        if (scene.source_items[i].kind == SourceItemKind::frame) {
            ++frames;
        } else {
            news.push_back(scene.source_items[i].kind);
            first_after = frames;
        }
    }
    TEST_ASSERT_EQUAL(2, news.size());
    TEST_ASSERT_TRUE(news[0] == SourceItemKind::lost && news[1] == SourceItemKind::back);
    TEST_ASSERT_EQUAL_UINT64(1, scene.frames.at(first_after).frame_id);
    TEST_ASSERT_TRUE(scene.frames[first_after].camera_time_ticks < 200000000);
    TEST_ASSERT_TRUE(scene.frames[first_after - 1].frame_id > 30);
}

static void test_without_hardware_trigger_it_runs_by_its_own_clock(void)
{
    WorldScene scene(scene_options());
    SourceStart start;
    start.hardware_trigger = false;
    start.frame_rate_hz = 25;
    std::string error;
    TEST_ASSERT_TRUE_MESSAGE(scene.source().start(start, error), error.c_str());
    TEST_ASSERT_FALSE(scene.source().start(start, error));
    scene.run_for(4);
    TEST_ASSERT_INT_WITHIN(1, 100, scene.frames.size());
    TEST_ASSERT_EQUAL(0, scene.world().true_frames().back().trigger_number);
    scene.source().stop();
    scene.run_for(1);
    TEST_ASSERT_INT_WITHIN(1, 100, scene.frames.size());
    start.buffers = 1;
    TEST_ASSERT_FALSE(scene.source().start(start, error));
}

static void test_damaged_and_stale_frames_are_what_the_truth_says(void)
{
    WorldScene scene(
        scene_options("frame_damaged=0.05,frame_repeated=0.05,frame_extra=0.05,seed=6"));
    scene.start_source();
    start_run(scene);
    scene.run_for(60);
    std::uint64_t damaged = 0, copies = 0, without_trigger = 0;
    for (std::size_t i = 0; i < scene.frames.size(); ++i) {
        const TrueFrame truth = scene.world().true_frame(i);
        TEST_ASSERT_EQUAL(truth.is_damaged ? OPMS_FRAME_DAMAGED : 0, scene.frames[i].flags);
        damaged += truth.is_damaged ? 1 : 0;
        copies += truth.is_copy ? 1 : 0;
        without_trigger += truth.trigger_number == 0 ? 1 : 0;
    }
    TEST_ASSERT_EQUAL_UINT64(damaged, scene.source().counters().damaged);
    TEST_ASSERT_EQUAL_UINT64(scene.frames.size(), scene.source().counters().delivered);
    TEST_ASSERT_TRUE(damaged > 5 && copies > 5 && without_trigger > 5);
}

static void test_the_bar_is_hidden_and_the_light_steps_when_asked(void)
{
    WorldScene scene(scene_options("hidden=1.95+1,light=3.95:-3/5.95:1,clouds=0"));
    scene.start_source();
    start_run(scene);
    scene.run_for(8);
    for (const TrueFrame &frame : scene.world().true_frames()) {
        std::int64_t scan_ns = 0;
        if (!scene.world().true_scan_time(frame, scan_ns) || scan_ns < 0) {
            continue;
        }
        const double t_s = static_cast<double>(scan_ns) * 1e-9;
        TEST_ASSERT_EQUAL(t_s > 1.95 && t_s < 2.95, frame.is_hidden);
        const double light = t_s < 3.95 ? 1 : t_s < 5.95 ? 0.125 : 2;
        TEST_ASSERT_EQUAL_DOUBLE(light, frame.light);
    }
}

/** Rows of the table of a simulated metal detector: time and response. */
static std::vector<std::pair<double, double>> read_table(const std::string &path)
{
    std::ifstream file(path);
    std::string line;
    TEST_ASSERT_TRUE(std::getline(file, line));
    TEST_ASSERT_EQUAL_STRING("t_scan_s,t_bound_s,number,response", line.c_str());
    std::vector<std::pair<double, double>> rows;
    while (std::getline(file, line)) {
        double t_s = 0, bound_s = 0, response = 0;
        unsigned long long number = 0;
        TEST_ASSERT_EQUAL(4, std::sscanf(line.c_str(), "%lf,%lf,%llu,%lf", &t_s, &bound_s, &number,
                                         &response));
        TEST_ASSERT_EQUAL_UINT64(rows.size() + 1, number);
        rows.emplace_back(t_s, response);
    }
    return rows;
}

static void test_the_metal_detector_answers_loudest_over_what_is_buried(void)
{
    const std::string path = "test_simulated_sensor.csv";
    WorldScene scene(scene_options("buried=0.35:0.1:-0.04:2,sensor_noise=0.001,sensor=" + path));
    scene.start_source();
    start_run(scene);
    scene.run_for(10.5);
    const auto rows = read_table(path);
    std::remove(path.c_str());
    TEST_ASSERT_INT_WITHIN(10, 520, static_cast<int>(rows.size()));
    // Loudest at the pulse that was nearest to it, to a pulse.
    double loudest = 0, loudest_s = 0, nearest_m = 10, nearest_s = 0;
    for (const auto &row : rows) {
        if (row.second > loudest) {
            loudest = row.second;
            loudest_s = row.first;
        }
    }
    for (const TrueFrame &frame : scene.world().true_frames()) {
        std::int64_t scan_ns = 0;
        const cv::Vec3d at = scene.world().true_pose(frame.picture).ground_detector.t;
        const double distance_m = cv::norm(at - cv::Vec3d(0.35, 0.1, -0.04));
        if (scene.world().true_scan_time(frame, scan_ns) && distance_m < nearest_m) {
            nearest_m = distance_m;
            nearest_s = static_cast<double>(scan_ns) * 1e-9;
        }
    }
    TEST_ASSERT_TRUE(nearest_m < 0.2 && loudest > 0.5 && loudest < 4);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, nearest_s, loudest_s);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_each_trigger_is_exposed_after_the_start_delay_and_stamped);
    RUN_TEST(test_a_command_of_exposure_acts_after_some_frames_and_is_reported);
    RUN_TEST(test_time_stands_still_while_all_buffers_are_lent);
    RUN_TEST(test_frames_outlive_their_source_and_their_world);
    RUN_TEST(test_a_camera_that_restarts_says_so_and_begins_anew);
    RUN_TEST(test_without_hardware_trigger_it_runs_by_its_own_clock);
    RUN_TEST(test_damaged_and_stale_frames_are_what_the_truth_says);
    RUN_TEST(test_the_bar_is_hidden_and_the_light_steps_when_asked);
    RUN_TEST(test_the_metal_detector_answers_loudest_over_what_is_buried);
    return UNITY_END();
}
