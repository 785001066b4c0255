/* SPDX-License-Identifier: Apache-2.0 */
/* Sessions without a box, with devices that come later, and the modes beside positions. */
#include <thread>

#include "engine_scene.hpp"

extern "C" {
#include "unity.h"
}

using namespace engine_scene;

void setUp(void) {}
void tearDown(void) {}

namespace {

bool becomes_idle(const Scene &scene)
{
    return eventually(
        [&scene] { return scene.session->status().state == SessionState::idle; });
}

void without_a_box_pictures_come_at_once_and_have_no_time(void)
{
    Scene scene(SessionMode::capture, false);
    scene.connect();
    TEST_ASSERT_FALSE(scene.camera->started.hardware_trigger);
    scene.begin();
    for (int i = 0; i < 20; ++i) {
        scene.free_frame();
    }
    TEST_ASSERT_TRUE(eventually([&] { return scene.notes.pose_count() == 20; }));
    for (const auto &pose : scene.notes.poses()) {
        TEST_ASSERT_EQUAL_INT(OPMS_FRAME_NONE, pose->frame_state);
        TEST_ASSERT_FALSE(pose->has_time);
    }
    TEST_ASSERT_TRUE(scene.session->status().state == SessionState::running);
    ScanEnd end;
    TEST_ASSERT_TRUE(scene.stop(&end));
    TEST_ASSERT_FALSE(end.has_summary);
}

void pictures_of_no_scan_are_shown_and_not_counted(void)
{
    Scene scene(SessionMode::capture, false);
    scene.connect();
    scene.free_frame();
    TEST_ASSERT_TRUE(eventually([&] { return scene.notes.pictures == 1; }));
    FramePtr picture;
    std::shared_ptr<const PoseRecord> pose;
    scene.session->newest(picture, pose);
    TEST_ASSERT_NOT_NULL(picture.get());
    TEST_ASSERT_EQUAL_UINT64(0, pose->number);
    TEST_ASSERT_EQUAL_UINT64(0, scene.notes.pose_count());
    TEST_ASSERT_EQUAL_UINT64(0, scene.session->status().frames);
}

void a_number_of_pictures_ends_the_scan_by_itself(void)
{
    Scene scene(SessionMode::capture, false);
    scene.options.picture_count = 5;
    scene.connect();
    scene.begin(true);
    for (int i = 0; i < 9; ++i) {
        scene.free_frame();
    }
    TEST_ASSERT_TRUE(becomes_idle(scene));
    TEST_ASSERT_EQUAL_UINT64(5, scene.tape->frames.size());
    TEST_ASSERT_EQUAL_STRING("picture_count", scene.tape->end.reason.c_str());
}

void single_pictures_are_taken_when_they_are_asked_for(void)
{
    Scene scene(SessionMode::capture, false);
    scene.connect();
    ScanRequest request;
    request.recording = RecorderOptions();
    request.single_pictures = true;
    std::string error;
    TEST_ASSERT_TRUE(scene.session->software_start(request, error));
    scene.free_frame();
    scene.free_frame();
    scene.taken();
    std::atomic<bool> done{false};
    std::thread frames([&] {
        while (!done) {
            scene.free_frame();
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
    });
    const bool first = scene.session->single_picture(error);
    const bool second = scene.session->single_picture(error);
    done = true;
    frames.join();
    TEST_ASSERT_TRUE(first && second);
    TEST_ASSERT_TRUE(scene.stop());
    TEST_ASSERT_EQUAL_UINT64(2, scene.tape->frames.size());
}

void a_preview_is_never_paired_whatever_it_says(void)
{
    Scene scene;
    scene.camera->given.preview_only = true;
    scene.connect();
    scene.begin();
    scene.pulses(30);
    TEST_ASSERT_TRUE(scene.stop());
    TEST_ASSERT_TRUE(eventually([&] { return scene.notes.pose_count() == 36; }));
    for (const auto &pose : scene.notes.poses()) {
        TEST_ASSERT_NOT_EQUAL_INT(OPMS_FRAME_PAIRED, pose->frame_state);
        TEST_ASSERT_FALSE(pose->has_time);
    }
}

void box_and_camera_may_come_after_the_session(void)
{
    Scene scene;
    scene.box->is_there = false;
    scene.camera->starts_refused = 1;
    scene.connect(); /* waits for the camera */
    TEST_ASSERT_TRUE(scene.notes.hears("camera.waiting", 1));
    TEST_ASSERT_TRUE(scene.notes.hears("box.waiting", 1));
    std::string error;
    TEST_ASSERT_FALSE(scene.session->software_start(ScanRequest(), error));
    scene.link(OPMS_LINK_CONNECTED);
    scene.taken();
    scene.go(2000);
    scene.begin();
    scene.pulses(10);
    TEST_ASSERT_TRUE(scene.stop());
    TEST_ASSERT_TRUE(eventually([&] { return scene.notes.pose_count() == 16; }));
    for (const auto &pose : scene.notes.poses()) {
        TEST_ASSERT_EQUAL_INT(OPMS_FRAME_PAIRED, pose->frame_state);
    }
}

void a_replay_waits_for_the_scan_and_ends_it(void)
{
    Scene scene(SessionMode::capture, false);
    scene.camera->given.live = false;
    for (int i = 0; i < 5; ++i) {
        scene.free_frame();
    }
    scene.camera_news(SourceItemKind::end);
    scene.connect();
    scene.begin(true);
    TEST_ASSERT_TRUE(becomes_idle(scene));
    TEST_ASSERT_EQUAL_UINT64(5, scene.tape->frames.size());
    TEST_ASSERT_EQUAL_STRING("camera.ended", scene.tape->end.reason.c_str());
}

void in_mode_calibration_a_picture_without_a_grid_says_so(void)
{
    struct Grids : ScanListener {
        void on_grid(const std::shared_ptr<const GridRecord> &grid) override
        {
            state = grid->summary.state;
            ++count;
        }
        std::atomic<int> state{-1}, count{0};
    } grids;
    Scene scene(SessionMode::calibration, false);
    std::string error;
    scene.session = LiveSession::create(std::move(scene.devices), scene.options,
                                        tape_maker(scene.tape), error);
    scene.session->add_listener(&grids);
    TEST_ASSERT_TRUE(scene.session->connect(error));
    const auto pixels = std::make_shared<std::vector<std::uint8_t>>(128 * 96, 90);
    auto frame = std::make_shared<Frame>();
    frame->image = {pixels->data(), 128, 96, 128, OPMS_PIXEL_GREY8, 0};
    frame->memory = pixels;
    SourceItem item;
    item.kind = SourceItemKind::frame;
    item.frame = frame;
    scene.camera->put(item);
    TEST_ASSERT_TRUE(eventually([&] { return grids.count == 1; }));
    TEST_ASSERT_EQUAL_INT(OPMS_GRID_ABSENT, grids.state);
    scene.session.reset();
}

void the_start_waits_for_the_clock_of_this_boot_and_tells_where_it_stays_unknown(void)
{
    Scene scene;
    scene.connect();
    scene.reboot();
    scene.taken();
    std::atomic<bool> done{false};
    std::thread time([&] {
        while (!done) { /* nobody pings */
            scene.clock->add(10 * MS);
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    });
    std::string error;
    const std::int64_t asked_ns = scene.clock->now_ns();
    const bool has_begun = scene.session->software_start(ScanRequest(), error);
    const std::int64_t waited_ns = scene.clock->now_ns() - asked_ns;
    done = true;
    time.join();
    TEST_ASSERT_TRUE_MESSAGE(has_begun, error.c_str());
    TEST_ASSERT_TRUE(waited_ns > 3000 * MS);
    TEST_ASSERT_TRUE(scene.notes.hears("box.clock_unknown", 1));
    TEST_ASSERT_TRUE(scene.stop());
    scene.go(2000);
    scene.begin();
    scene.pulses(3);
    TEST_ASSERT_TRUE(scene.stop());
    TEST_ASSERT_EQUAL_INT(1, scene.notes.events("box.clock_unknown"));
}

void pictures_of_another_size_than_the_lens_are_told_and_not_located(void)
{
    Scene scene(SessionMode::position, false);
    opms_camera_t camera{};
    camera.lens = {640, 480, 500, 500, 320, 240, 0, 0, 0, 0};
    scene.options.camera = camera;
    scene.connect();
    scene.begin();
    scene.free_frame();
    TEST_ASSERT_TRUE(eventually([&] { return scene.notes.pose_count() == 1; }));
    TEST_ASSERT_EQUAL_INT(OPMS_BAR_ABSENT, scene.notes.poses()[0]->location.state);
    TEST_ASSERT_TRUE(scene.notes.hears("camera.wrong_size", 1));
    TEST_ASSERT_TRUE(scene.stop());
}

void options_that_cannot_be_are_refused_in_words(void)
{
    const auto refused = [](const std::function<void(Scene &)> &spoil) {
        Scene scene;
        spoil(scene);
        std::string error;
        scene.session = LiveSession::create(std::move(scene.devices), scene.options, error);
        return !scene.session && !error.empty();
    };
    TEST_ASSERT_FALSE(refused([](Scene &) {}));
    TEST_ASSERT_TRUE(refused([](Scene &s) { s.options.mode = SessionMode::position; }));
    TEST_ASSERT_TRUE(refused([](Scene &s) { s.options.frame_queue = 0; }));
    TEST_ASSERT_TRUE(refused([](Scene &s) { s.options.source.buffers = 1; }));
    TEST_ASSERT_TRUE(refused([](Scene &s) { s.options.source.frame_rate_hz = 0; }));
    TEST_ASSERT_TRUE(refused([](Scene &s) { s.options.max_wait_ms = 99; }));
    TEST_ASSERT_TRUE(refused([](Scene &s) { s.devices.clock = nullptr; }));
    TEST_ASSERT_TRUE(refused([](Scene &s) {
        opms_settings_t settings;
        opms_wire_default_settings(&settings);
        settings.period_us = 1;
        s.options.box_settings = settings;
    }));
    TEST_ASSERT_TRUE(refused([](Scene &s) {
        s.options.mode = SessionMode::position;
        opms_camera_t camera{};
        camera.lens = {640, 480, 500, 500, 320, 240, 0, 0, 0, 0};
        s.options.camera = camera;
        s.camera->given.width_px = 320;
        s.camera->given.height_px = 240;
    }));
}

}  // namespace

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(without_a_box_pictures_come_at_once_and_have_no_time);
    RUN_TEST(pictures_of_no_scan_are_shown_and_not_counted);
    RUN_TEST(a_number_of_pictures_ends_the_scan_by_itself);
    RUN_TEST(single_pictures_are_taken_when_they_are_asked_for);
    RUN_TEST(a_preview_is_never_paired_whatever_it_says);
    RUN_TEST(box_and_camera_may_come_after_the_session);
    RUN_TEST(a_replay_waits_for_the_scan_and_ends_it);
    RUN_TEST(in_mode_calibration_a_picture_without_a_grid_says_so);
    RUN_TEST(the_start_waits_for_the_clock_of_this_boot_and_tells_where_it_stays_unknown);
    RUN_TEST(pictures_of_another_size_than_the_lens_are_told_and_not_located);
    RUN_TEST(options_that_cannot_be_are_refused_in_words);
    return UNITY_END();
}
