/* SPDX-License-Identifier: Apache-2.0 */
/* The simulated world with threads that wait for it, and how it is opened. */
#include <atomic>
#include <cstdio>
#include <fstream>
#include <cstring>
#include <thread>

#include <nlohmann/json.hpp>
#include <unity.h>

#include "world_scene.hpp"

using namespace opms_host;

extern "C" void setUp(void) {}
extern "C" void tearDown(void) {}

/** What one thread for the box and one for the camera got, until so many frames were there. */
struct Got {
    std::vector<std::uint32_t> numbers;
    std::vector<std::int64_t> box_ns, arrivals_ns;
};

static Got run_with_threads(const std::string &text, std::size_t frames, std::uint32_t buffers)
{
    WorldScene scene(scene_options(text));
    scene.start_source(buffers);
    std::string error;
    TEST_ASSERT_TRUE(scene.box().arm(5, error));
    Got got;
    std::atomic<bool> is_over{false};
    std::thread box([&] {
        opms_box_item_t item;
        while (!is_over && scene.box().poll(100, item)) {
            if (item.kind == OPMS_ITEM_TRIGGER) {
                got.numbers.push_back(item.as.trigger.trigger_number);
                got.box_ns.push_back(opms_box_time_ns(item.as.trigger.time));
            }
        }
    });
    std::thread camera([&] {
        SourceItem item;
        while (got.arrivals_ns.size() < frames) {
            scene.source().wait(100, item);
            if (item.frame) {
                got.arrivals_ns.push_back(item.frame->arrival_host_ns);
            }
        }
        item.frame.reset();
        is_over = true;
        scene.box().wake();
    });
    camera.join();
    box.join();
    return got;
}

static void test_free_time_brings_two_threads_the_same_each_time(void)
{
    const std::string text = "start_after=0.2,seed=9,faults=some";
    const Got one = run_with_threads(text, 400, 4), other = run_with_threads(text, 400, 4);
    TEST_ASSERT_EQUAL(400, one.arrivals_ns.size());
    for (std::size_t i = 0; i < 400; ++i) {
        TEST_ASSERT_EQUAL_INT64(one.arrivals_ns[i], other.arrivals_ns[i]);
    }
    const std::size_t reports = std::min(one.numbers.size(), other.numbers.size());
    TEST_ASSERT_GREATER_THAN(380, reports);
    for (std::size_t i = 0; i < reports; ++i) {
        TEST_ASSERT_EQUAL(one.numbers[i], other.numbers[i]);
        TEST_ASSERT_EQUAL_INT64(one.box_ns[i], other.box_ns[i]);
    }
}

static void test_a_slow_taker_loses_nothing_with_free_time(void)
{
    WorldScene scene(scene_options("start_after=0.2,seed=9"));
    scene.start_source(2);
    std::string error;
    TEST_ASSERT_TRUE(scene.box().arm(5, error));
    std::thread box([&] {
        opms_box_item_t item;
        do {
            scene.box().poll(50, item);
        } while (item.kind != OPMS_ITEM_EVENT || item.as.event.kind != OPMS_EVENT_STOP);
    });
    std::vector<std::uint64_t> ids;
    SourceItem item;
    while (ids.size() < 60) {
        scene.source().wait(50, item);
        if (item.frame) {
            ids.push_back(item.frame->frame_id);
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
    }
    item.frame.reset();
    TEST_ASSERT_TRUE(scene.box().disarm(error));
    // Time goes on only while both wait.
    std::atomic<bool> is_over{false};
    std::thread camera([&] {
        SourceItem last;
        while (!is_over) {
            scene.source().wait(20, last);
            last = SourceItem();
        }
    });
    box.join();
    is_over = true;
    scene.source().wake();
    camera.join();
    for (std::size_t i = 1; i < ids.size(); ++i) {
        TEST_ASSERT_EQUAL_UINT64(ids[i - 1] + 1, ids[i]);
    }
    TEST_ASSERT_EQUAL_UINT64(0, scene.source().counters().no_buffer);
}

static void test_fast_time_follows_the_wall_clock_and_drops_what_finds_no_buffer(void)
{
    WorldOptions options = scene_options("speed=50,start_after=0.2,readout_ms=2");
    WorldScene scene(options);
    scene.start_source(2);
    std::string error;
    TEST_ASSERT_TRUE(scene.box().arm(5, error));
    FramePtr one, two;
    SourceItem item;
    while (!two) {
        scene.source().wait(100, item);
        if (item.frame) {
            (one ? two : one) = item.frame;
            item.frame.reset();
        }
    }
    while (scene.source().counters().no_buffer < 5) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    one.reset();
    two.reset();
    do {
        scene.source().wait(100, item);
    } while (!item.frame);
    TEST_ASSERT_TRUE(item.frame->frame_id > 6);
}

static void test_wake_ends_a_wait_and_the_next_one(void)
{
    WorldScene scene(scene_options("speed=1"));
    SourceItem item;
    opms_box_item_t box_item;
    do {
        scene.box().poll(0, box_item);
    } while (box_item.kind != OPMS_ITEM_NONE);
    scene.box().wake();
    scene.source().wake();
    TEST_ASSERT_TRUE(scene.box().poll(600000, box_item));
    scene.source().wait(600000, item);
    TEST_ASSERT_TRUE(item.kind == SourceItemKind::none);
    std::thread waker([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        scene.source().wake();
    });
    scene.source().wait(600000, item);
    waker.join();
}

static void test_texts_open_devices_of_one_world(void)
{
    SimulatedRequest request;
    request.box_options = "pictures=blank,speed=0";
    request.source_options = "seed=3";
    Devices devices;
    OpenError error;
    TEST_ASSERT_TRUE_MESSAGE(simulated_devices(request, devices, error), error.text.c_str());
    TEST_ASSERT_NOT_NULL(devices.box.get());
    TEST_ASSERT_NOT_NULL(devices.source.get());
    TEST_ASSERT_EQUAL_STRING("OPMS simulated camera, seed 3",
                             devices.source->traits().model.c_str());
    TEST_ASSERT_TRUE(devices.source->traits().can_trigger);
    TEST_ASSERT_EQUAL_INT64(1000 * SCENE_S, devices.clock->now_ns());
}

static void test_wrong_texts_are_told_with_their_key(void)
{
    const char *const wrong[][2] = {
        {"frames=none", "frames=none is no whole number of at least 0"},
        {"frames=0", "frames must be 1"},
        {"nosuchkey=1", "there is no key nosuchkey"},
        {"speed", "\"speed\" is not of the form key=value"},
        {"report_lost=0.9", "report_lost must be 0 to 0.5"},
        {"hidden=x", "hidden=x must be AT[+LENGTH]"},
        {"light=1", "light=1 must be SECONDS:EV"},
        {"buried=1:2", "buried=1:2 must be X:Y:Z"},
        {"hz=1000", "hz=1000 must be 0.1 to 100"},
        {"first_id=70000", "first_id must be 1 to 65535"},
        {"bar=other", "bar must be hope33 or apriltag33"}};
    for (const auto &pair : wrong) {
        SimulatedRequest request;
        request.source_options = pair[0];
        Devices devices;
        OpenError error;
        TEST_ASSERT_FALSE(simulated_devices(request, devices, error));
        TEST_ASSERT_NOT_NULL_MESSAGE(std::strstr(error.text.c_str(), pair[1]), error.text.c_str());
        TEST_ASSERT_TRUE(error.kind == OpenFailure::usage);
        TEST_ASSERT_NULL(devices.source.get());
    }
    SimulatedRequest request;
    request.source_options = "camera=/no/such/file.yaml";
    Devices devices;
    OpenError error;
    TEST_ASSERT_FALSE(simulated_devices(request, devices, error));
    TEST_ASSERT_TRUE(error.kind == OpenFailure::input);
    TEST_ASSERT_NOT_NULL(std::strstr(error.text.c_str(), "/no/such/file.yaml"));
}

static void test_the_truth_file_tells_what_the_world_tells(void)
{
    const std::string path = "test_simulated_truth.jsonl";
    PairedScene paired(scene_options("faults=some,seed=4,truth=" + path));
    paired.session(3, 30);
    std::ifstream file(path);
    std::size_t frames = 0, triggers = 0, runs = 0;
    for (std::string line; std::getline(file, line);) {
        const nlohmann::json j = nlohmann::json::parse(line);
        const std::string kind = j.at("kind");
        triggers += kind == "trigger" ? 1 : 0;
        runs += kind == "run" ? 1 : 0;
        if (kind == "frame") {
            const TrueFrame truth = paired.scene().world().true_frame(frames++);
            const std::int64_t arrival_ns = j.at("arrival_host_ns");
            TEST_ASSERT_EQUAL_INT64(truth.arrival_host_ns, arrival_ns);
            TEST_ASSERT_EQUAL(truth.trigger_number == 0, j.at("trigger").is_null());
            if (truth.trigger_number != 0) {
                TEST_ASSERT_EQUAL(truth.trigger_number, j.at("trigger").get<std::uint32_t>());
            }
            TEST_ASSERT_EQUAL(9, j.at("ground_detector").at("R").size());
        }
    }
    TEST_ASSERT_EQUAL(paired.scene().world().true_frames().size(), frames);
    TEST_ASSERT_EQUAL(paired.scene().world().true_triggers().size(), triggers);
    TEST_ASSERT_EQUAL(1, runs);
    std::remove(path.c_str());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_free_time_brings_two_threads_the_same_each_time);
    RUN_TEST(test_a_slow_taker_loses_nothing_with_free_time);
    RUN_TEST(test_fast_time_follows_the_wall_clock_and_drops_what_finds_no_buffer);
    RUN_TEST(test_wake_ends_a_wait_and_the_next_one);
    RUN_TEST(test_texts_open_devices_of_one_world);
    RUN_TEST(test_wrong_texts_are_told_with_their_key);
    RUN_TEST(test_the_truth_file_tells_what_the_world_tells);
    return UNITY_END();
}
