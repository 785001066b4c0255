/* SPDX-License-Identifier: Apache-2.0 */
/* The V4L2 camera against a driver that answers from a script. */
#include <cerrno>
#include <cmath>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <unity.h>

#include "scripted_v4l2.hpp"
#include "v4l2_source.hpp"

using namespace opms_host;

constexpr std::uint32_t PATIENCE_MS = 20000; /* only how long a broken test takes to fail */
constexpr std::uint32_t TRIGGER_ID = V4L2_CID_PRIVATE_BASE + 7;

static std::shared_ptr<ScriptedV4l2> driver;
static std::shared_ptr<HostClock> host_clock;
static std::string error;

void setUp(void)
{
    driver = std::make_shared<ScriptedV4l2>();
    host_clock = std::make_shared<SystemClock>();
    error.clear();
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_INT(0, driver->open_count());
    TEST_ASSERT_EQUAL_UINT32(0, driver->mapped());
    driver.reset();
}

static std::unique_ptr<FrameSource> open_camera(const char *text = "/dev/video0",
                                                bool wait_for_missing = false)
{
    V4l2Place place;
    TEST_ASSERT_TRUE_MESSAGE(v4l2_place_parse(text, place, error), error.c_str());
    return open_v4l2_source(place, wait_for_missing, host_clock, driver, error);
}

static std::unique_ptr<FrameSource> started(std::uint32_t buffers = 4,
                                            const char *text = "/dev/video0")
{
    auto camera = open_camera(text);
    TEST_ASSERT_NOT_NULL_MESSAGE(camera.get(), error.c_str());
    SourceStart start;
    start.hardware_trigger = false;
    start.buffers = buffers;
    TEST_ASSERT_TRUE_MESSAGE(camera->start(start, error), error.c_str());
    return camera;
}

static SourceItem next(FrameSource &camera, SourceItemKind kind)
{
    SourceItem item;
    camera.wait(PATIENCE_MS, item);
    TEST_ASSERT_EQUAL_INT_MESSAGE(static_cast<int>(kind), static_cast<int>(item.kind),
                                  item.text.c_str());
    return item;
}

static std::vector<ScriptedPicture> pictures(std::uint32_t first, std::uint32_t count)
{
    std::vector<ScriptedPicture> all(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        all[i].sequence = first + i;
        all[i].t_us = 1000000 + 100000 * static_cast<std::int64_t>(first + i);
    }
    return all;
}

/* Unity has its own idea of isnan(). */
static bool is_unknown(double value)
{
    return !(value == value);
}

static ScriptedControl control(const char *name, std::int32_t least, std::int32_t most,
                               std::int32_t value)
{
    ScriptedControl made;
    made.name = name;
    made.least = least;
    made.most = most;
    made.value = value;
    return made;
}

static void frames_carry_sequence_and_stamp_and_the_driver_s_own_memory(void)
{
    auto camera = started();
    driver->play(pictures(0, 3));
    const FramePtr first = next(*camera, SourceItemKind::frame).frame;
    const FramePtr second = next(*camera, SourceItemKind::frame).frame;
    const opms_camera_profile_t profile = camera->traits().profile;

    TEST_ASSERT_EQUAL_UINT64(0, first->frame_id);
    TEST_ASSERT_EQUAL_UINT64(1, second->frame_id);
    TEST_ASSERT_EQUAL_UINT64(1100000, second->camera_time_ticks);
    TEST_ASSERT_EQUAL_UINT32(0, first->flags);
    TEST_ASSERT_EQUAL_UINT32(32, profile.frame_id_bits);
    TEST_ASSERT_EQUAL_UINT64(1000000, profile.camera_tick_hz);
    TEST_ASSERT_EQUAL_INT(OPMS_PIXEL_GREY8, first->image.format);
    TEST_ASSERT_EQUAL_INT(64 + 16, first->image.stride_bytes);
    TEST_ASSERT_EQUAL_UINT32(2, driver->queued()); /* two of four are lent */
    TEST_ASSERT_EQUAL_UINT32(2, camera->counters().lent);
}

static void gaps_in_the_sequence_stay_as_they_are(void)
{
    auto camera = started();
    driver->play({pictures(3, 1)[0], pictures(7, 1)[0]});
    TEST_ASSERT_EQUAL_UINT64(3, next(*camera, SourceItemKind::frame).frame->frame_id);
    TEST_ASSERT_EQUAL_UINT64(7, next(*camera, SourceItemKind::frame).frame->frame_id);
    TEST_ASSERT_EQUAL_UINT64(0, camera->counters().no_buffer); /* there was one all the time */
}

static void pictures_lost_while_all_buffers_were_lent_are_counted(void)
{
    auto camera = started(2);
    driver->play(pictures(0, 2));
    std::vector<FramePtr> kept = {next(*camera, SourceItemKind::frame).frame,
                                  next(*camera, SourceItemKind::frame).frame};
    driver->play(pictures(9, 1));
    SourceItem item;
    camera->wait(50, item);
    TEST_ASSERT_EQUAL_INT(static_cast<int>(SourceItemKind::none), static_cast<int>(item.kind));

    kept.clear();
    TEST_ASSERT_EQUAL_UINT64(9, next(*camera, SourceItemKind::frame).frame->frame_id);
    TEST_ASSERT_EQUAL_UINT64(7, camera->counters().no_buffer);
}

static void a_broken_buffer_is_a_damaged_frame_whose_missing_rows_are_black(void)
{
    auto camera = started();
    driver->play(pictures(0, 1));
    next(*camera, SourceItemKind::frame);
    ScriptedPicture broken = pictures(1, 1)[0];
    broken.bad = true;
    broken.bytes_used = 80 * 10;
    for (int i = 0; i < 4; ++i) { /* in whichever buffer: an old picture stood in it */
        driver->play({broken});
        const FramePtr frame = next(*camera, SourceItemKind::frame).frame;
        const auto *pixels = static_cast<const std::uint8_t *>(frame->image.pixels);
        TEST_ASSERT_EQUAL_UINT32(OPMS_FRAME_DAMAGED, frame->flags);
        TEST_ASSERT_EQUAL_UINT8(100, pixels[80 * 9]);
        TEST_ASSERT_EQUAL_UINT8(0, pixels[80 * 10]);
        TEST_ASSERT_EQUAL_UINT8(0, pixels[80 * 47 + 63]);
    }
    TEST_ASSERT_EQUAL_UINT64(4, camera->counters().damaged);
}

static void an_error_of_one_picture_is_told_and_the_next_one_comes(void)
{
    auto camera = started();
    ScriptedPicture failing;
    failing.error = EIO;
    driver->play({failing});
    driver->play(pictures(5, 1));
    const SourceItem failed = next(*camera, SourceItemKind::failed);
    TEST_ASSERT_NOT_EQUAL(std::string::npos, failed.text.find("/dev/video0"));
    TEST_ASSERT_EQUAL_UINT64(5, next(*camera, SourceItemKind::frame).frame->frame_id);
    TEST_ASSERT_EQUAL_UINT64(1, camera->counters().failed);
}

static void nothing_to_take_is_no_error(void)
{
    auto camera = started();
    ScriptedPicture again;
    again.error = EAGAIN;
    driver->play({again, again});
    driver->play(pictures(2, 1));
    TEST_ASSERT_EQUAL_UINT64(2, next(*camera, SourceItemKind::frame).frame->frame_id);
    TEST_ASSERT_EQUAL_UINT64(0, camera->counters().failed);
}

static void an_unplugged_camera_is_lost_and_comes_back_by_its_name(void)
{
    auto camera = started();
    driver->play(pictures(0, 1));
    const FramePtr kept = next(*camera, SourceItemKind::frame).frame;
    ScriptedPicture unplugged;
    unplugged.error = ENODEV;
    driver->play({unplugged});
    next(*camera, SourceItemKind::lost);
    TEST_ASSERT_FALSE(camera->set_exposure(1000, 0, error));
    TEST_ASSERT_EQUAL_UINT8(100, *static_cast<const std::uint8_t *>(kept->image.pixels));

    /* The system gave it another number, because the old one is still in use. */
    driver->replug("/dev/video3");
    next(*camera, SourceItemKind::back);
    driver->play(pictures(0, 1));
    TEST_ASSERT_EQUAL_UINT64(0, next(*camera, SourceItemKind::frame).frame->frame_id);
}

static void another_camera_is_not_taken_for_the_one_that_was_lost(void)
{
    auto camera = started();
    ScriptedPicture unplugged;
    unplugged.error = ENODEV;
    driver->play({unplugged});
    next(*camera, SourceItemKind::lost);
    driver->card = "Another";
    driver->replug("/dev/video0");
    SourceItem item;
    camera->wait(1200, item); /* two searches */
    TEST_ASSERT_EQUAL_INT(static_cast<int>(SourceItemKind::none), static_cast<int>(item.kind));
}

static void a_camera_that_is_missing_at_first_may_come_later(void)
{
    driver->gone = true;
    TEST_ASSERT_NULL(open_camera().get());
    auto camera = open_camera("/dev/video0", true);
    TEST_ASSERT_NOT_NULL(camera.get());
    SourceStart start;
    start.hardware_trigger = false;
    TEST_ASSERT_TRUE(camera->start(start, error));
    next(*camera, SourceItemKind::lost);
    driver->gone = false;
    next(*camera, SourceItemKind::back);
    driver->play(pictures(0, 1));
    next(*camera, SourceItemKind::frame);
}

static void exposure_counts_from_the_third_picture_after_the_change(void)
{
    driver->controls[V4L2_CID_EXPOSURE_ABSOLUTE] = control("Exposure Time", 1, 300, 50);
    driver->controls[V4L2_CID_EXPOSURE_AUTO] = control("Auto Exposure", 0, 3, 3);
    driver->stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN; /* so that arrival decides */
    auto camera = started();
    driver->play(pictures(0, 1));
    const FramePtr before = next(*camera, SourceItemKind::frame).frame;
    TEST_ASSERT_EQUAL_DOUBLE(5000, before->exposure_us);
    TEST_ASSERT_EQUAL_UINT32(OPMS_FRAME_NO_TIME, before->flags);
    TEST_ASSERT_EQUAL_INT32(V4L2_EXPOSURE_MANUAL, driver->accepted[V4L2_CID_EXPOSURE_AUTO]);

    TEST_ASSERT_TRUE(camera->set_exposure(2040, 0, error));
    TEST_ASSERT_EQUAL_INT32(20, driver->accepted[V4L2_CID_EXPOSURE_ABSOLUTE]);
    driver->play(pictures(1, 3));
    TEST_ASSERT_TRUE(is_unknown(next(*camera, SourceItemKind::frame).frame->exposure_us));
    TEST_ASSERT_TRUE(is_unknown(next(*camera, SourceItemKind::frame).frame->exposure_us));
    TEST_ASSERT_EQUAL_DOUBLE(2000, next(*camera, SourceItemKind::frame).frame->exposure_us);
    TEST_ASSERT_EQUAL_DOUBLE(100, camera->traits().exposure_min_us);
    TEST_ASSERT_EQUAL_DOUBLE(30000, camera->traits().exposure_max_us);
}

static void gain_has_decibels_only_where_its_step_is_stated(void)
{
    driver->controls[V4L2_CID_GAIN] = control("Gain", 16, 255, 16);
    {
        auto camera = started();
        TEST_ASSERT_EQUAL_DOUBLE(0, camera->traits().gain_max_db);
        TEST_ASSERT_TRUE(camera->set_exposure(NAN, 6, error));
        TEST_ASSERT_EQUAL_UINT32(0, static_cast<std::uint32_t>(driver->accepted.count(
                                        V4L2_CID_GAIN)));
    }
    auto camera = started(4, "/dev/video0,gain_step_db=0.1");
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 23.9, camera->traits().gain_max_db);
    TEST_ASSERT_TRUE(camera->set_exposure(NAN, 6, error));
    TEST_ASSERT_EQUAL_INT32(76, driver->accepted[V4L2_CID_GAIN]);
}

static void a_trigger_mode_is_found_by_its_name_and_switched(void)
{
    SourceStart start;
    {
        auto camera = open_camera();
        TEST_ASSERT_FALSE(camera->traits().can_trigger);
        TEST_ASSERT_FALSE(camera->start(start, error));
        TEST_ASSERT_NOT_EQUAL(std::string::npos, error.find("trigger"));
    }
    ScriptedControl mode = control("Trigger Mode", 0, 2, 0);
    mode.type = V4L2_CTRL_TYPE_MENU;
    mode.menu = {{0, "Disabled"}, {1, "Software"}, {2, "External"}};
    driver->controls[TRIGGER_ID] = mode;
    auto camera = open_camera();
    TEST_ASSERT_TRUE(camera->traits().can_trigger);
    TEST_ASSERT_TRUE_MESSAGE(camera->start(start, error), error.c_str());
    TEST_ASSERT_EQUAL_INT32(2, driver->accepted[TRIGGER_ID]);
    camera->stop();
    start.hardware_trigger = false;
    TEST_ASSERT_TRUE_MESSAGE(camera->start(start, error), error.c_str());
    TEST_ASSERT_EQUAL_INT32(0, driver->accepted[TRIGGER_ID]);
}

static void a_driver_that_refuses_the_trigger_does_not_start(void)
{
    ScriptedControl mode = control("Trigger enable", 0, 1, 0);
    mode.refuses = true;
    driver->controls[TRIGGER_ID] = mode;
    auto camera = open_camera();
    TEST_ASSERT_FALSE(camera->start(SourceStart(), error));
}

static void sixteen_bit_formats_have_their_own_white(void)
{
    const std::uint32_t fourcc[] = {V4L2_PIX_FMT_Y10, V4L2_PIX_FMT_Y12, V4L2_PIX_FMT_Y16};
    const std::uint16_t white[] = {1023, 4095, 65535};
    for (int i = 0; i < 3; ++i) {
        driver->formats = {fourcc[i]};
        driver->row_padding = 0;
        auto camera = started();
        driver->play(pictures(0, 1));
        const FramePtr frame = next(*camera, SourceItemKind::frame).frame;
        TEST_ASSERT_EQUAL_INT(OPMS_PIXEL_GREY16, frame->image.format);
        TEST_ASSERT_EQUAL_UINT16(white[i], frame->image.white_level);
        TEST_ASSERT_EQUAL_INT(128, frame->image.stride_bytes);
    }
}

static void the_grey_of_yuyv_is_copied_out_and_still_bounded_by_the_buffers(void)
{
    driver->formats = {V4L2_PIX_FMT_YUYV};
    auto camera = started(2);
    driver->play(pictures(0, 2));
    std::vector<FramePtr> kept = {next(*camera, SourceItemKind::frame).frame,
                                  next(*camera, SourceItemKind::frame).frame};
    TEST_ASSERT_EQUAL_INT(64, kept[0]->image.stride_bytes);
    TEST_ASSERT_EQUAL_UINT16(235, kept[0]->image.white_level);
    TEST_ASSERT_EQUAL_UINT8(100, static_cast<const std::uint8_t *>(
                                     kept[0]->image.pixels)[64 * 48 - 1]);
    TEST_ASSERT_EQUAL_UINT32(0, driver->queued());
    kept.clear();
    TEST_ASSERT_EQUAL_UINT32(2, driver->queued());
}

static void a_colour_only_camera_is_refused_with_what_is_needed(void)
{
    driver->formats = {V4L2_PIX_FMT_MJPEG};
    TEST_ASSERT_NULL(open_camera().get());
    TEST_ASSERT_NOT_EQUAL(std::string::npos, error.find("MJPG"));
    TEST_ASSERT_NOT_EQUAL(std::string::npos, error.find("GREY"));
}

static void frames_outlive_the_camera(void)
{
    FramePtr frame;
    {
        auto camera = started();
        driver->play(pictures(0, 1));
        frame = next(*camera, SourceItemKind::frame).frame;
        camera->stop();
        camera->stop();
    }
    TEST_ASSERT_EQUAL_UINT8(100, *static_cast<const std::uint8_t *>(frame->image.pixels));
    TEST_ASSERT_EQUAL_INT(1, driver->open_count());
    frame.reset();
    TEST_ASSERT_EQUAL_INT(0, driver->open_count());
}

static void starting_again_while_pictures_are_in_use_keeps_them(void)
{
    auto camera = started(3);
    driver->play(pictures(0, 1));
    FramePtr kept = next(*camera, SourceItemKind::frame).frame;
    camera->stop();
    SourceStart start;
    start.hardware_trigger = false;
    start.buffers = 8;
    TEST_ASSERT_TRUE_MESSAGE(camera->start(start, error), error.c_str());
    TEST_ASSERT_EQUAL_UINT32(2, driver->queued());
    kept.reset();
    TEST_ASSERT_EQUAL_UINT32(3, driver->queued());
}

static void a_wait_ends_when_it_is_woken(void)
{
    auto camera = started();
    std::thread waker([&camera] { camera->wake(); });
    next(*camera, SourceItemKind::none);
    waker.join();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(frames_carry_sequence_and_stamp_and_the_driver_s_own_memory);
    RUN_TEST(gaps_in_the_sequence_stay_as_they_are);
    RUN_TEST(pictures_lost_while_all_buffers_were_lent_are_counted);
    RUN_TEST(a_broken_buffer_is_a_damaged_frame_whose_missing_rows_are_black);
    RUN_TEST(an_error_of_one_picture_is_told_and_the_next_one_comes);
    RUN_TEST(nothing_to_take_is_no_error);
    RUN_TEST(an_unplugged_camera_is_lost_and_comes_back_by_its_name);
    RUN_TEST(another_camera_is_not_taken_for_the_one_that_was_lost);
    RUN_TEST(a_camera_that_is_missing_at_first_may_come_later);
    RUN_TEST(exposure_counts_from_the_third_picture_after_the_change);
    RUN_TEST(gain_has_decibels_only_where_its_step_is_stated);
    RUN_TEST(a_trigger_mode_is_found_by_its_name_and_switched);
    RUN_TEST(a_driver_that_refuses_the_trigger_does_not_start);
    RUN_TEST(sixteen_bit_formats_have_their_own_white);
    RUN_TEST(the_grey_of_yuyv_is_copied_out_and_still_bounded_by_the_buffers);
    RUN_TEST(a_colour_only_camera_is_refused_with_what_is_needed);
    RUN_TEST(frames_outlive_the_camera);
    RUN_TEST(starting_again_while_pictures_are_in_use_keeps_them);
    RUN_TEST(a_wait_ends_when_it_is_woken);
    return UNITY_END();
}
