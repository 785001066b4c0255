/* SPDX-License-Identifier: Apache-2.0 */
/* The GenICam camera against Aravis's own fake of a GigE camera, over the loopback network. */
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <unity.h>

#include <arv.h>

#include "aravis_source.hpp"

using namespace opms_host;

constexpr std::uint32_t PATIENCE_MS = 30000; /* only how long a broken test takes to fail */
constexpr std::uint64_t LAST_ID = 65535;

static ArvGvFakeCamera *fake;
static std::string error;

/* A whole picture fits into the socket's buffer, so that a busy machine loses none of it. */
constexpr std::uint32_t SIDE_PX = 128;

static void plug(const char *serial)
{
    fake = arv_gv_fake_camera_new("127.0.0.1", serial);
    TEST_ASSERT_TRUE(arv_gv_fake_camera_is_running(fake));
    ArvFakeCamera *const inner = arv_gv_fake_camera_get_fake_camera(fake);
    arv_fake_camera_write_register(inner, ARV_FAKE_CAMERA_REGISTER_WIDTH, SIDE_PX);
    arv_fake_camera_write_register(inner, ARV_FAKE_CAMERA_REGISTER_HEIGHT, SIDE_PX);
}

static void unplug(void)
{
    if (fake) {
        g_object_unref(fake);
        fake = nullptr;
    }
}

void setUp(void)
{
    plug("OPMS1");
    error.clear();
}

void tearDown(void)
{
    unplug();
}

static std::unique_ptr<FrameSource> open_camera(const std::string &name = "Aravis-Fake-OPMS1",
                                                bool wait_for_missing = false)
{
    AravisPlace place;
    TEST_ASSERT_TRUE(aravis_place_parse(name, place, error));
    return open_aravis_source(place, wait_for_missing, std::make_shared<SystemClock>(), error);
}

/** The fake camera answers within half a second or not at all, which a busy machine may miss. */
static bool some_time(const std::function<bool()> &succeeds)
{
    for (int attempt = 0; attempt < 10; ++attempt) {
        if (succeeds()) {
            return true;
        }
    }
    return false;
}

static std::unique_ptr<FrameSource> started_with(const SourceStart &start,
                                                 const std::string &name = "Aravis-Fake-OPMS1")
{
    std::unique_ptr<FrameSource> camera;
    const bool has_started = some_time([&] {
        camera = open_camera(name);
        return camera && camera->start(start, error);
    });
    TEST_ASSERT_TRUE_MESSAGE(has_started, error.c_str());
    return camera;
}

static std::unique_ptr<FrameSource> started(std::uint32_t buffers, double frame_rate_hz,
                                            const std::string &name = "Aravis-Fake-OPMS1")
{
    SourceStart start;
    start.hardware_trigger = false;
    start.buffers = buffers;
    start.frame_rate_hz = frame_rate_hz;
    return started_with(start, name);
}

static std::uint32_t trigger_mode(void)
{
    std::uint32_t value = 0;
    arv_fake_camera_read_register(arv_gv_fake_camera_get_fake_camera(fake),
                                  ARV_FAKE_CAMERA_REGISTER_TRIGGER_MODE, &value);
    return value;
}

/** The next item that is no empty wait. */
static SourceItem next(FrameSource &camera)
{
    SourceItem item;
    for (int i = 0; i < 3 && item.kind == SourceItemKind::none; ++i) {
        camera.wait(PATIENCE_MS, item);
    }
    TEST_ASSERT_NOT_EQUAL_MESSAGE(static_cast<int>(SourceItemKind::none),
                                  static_cast<int>(item.kind), "nothing came");
    return item;
}

static FramePtr next_frame(FrameSource &camera)
{
    const SourceItem item = next(camera);
    TEST_ASSERT_EQUAL_INT_MESSAGE(static_cast<int>(SourceItemKind::frame),
                                  static_cast<int>(item.kind), item.text.c_str());
    return item.frame;
}

static void the_camera_is_listed_and_tells_what_it_is(void)
{
    TEST_ASSERT_TRUE(some_time([] {
        std::string problem;
        const std::vector<AravisEntry> entries = list_aravis(problem);
        return std::any_of(entries.begin(), entries.end(), [](const AravisEntry &entry) {
            return entry.id == "Aravis-Fake-OPMS1" && entry.address == "127.0.0.1";
        });
    }));
    std::unique_ptr<FrameSource> camera;
    TEST_ASSERT_TRUE_MESSAGE(some_time([&] { return (camera = open_camera()) != nullptr; }),
                             error.c_str());
    const SourceTraits traits = camera->traits();

    TEST_ASSERT_EQUAL_STRING("aravis:Aravis-Fake-OPMS1", traits.name.c_str());
    TEST_ASSERT_EQUAL_INT32(SIDE_PX, traits.width_px);
    TEST_ASSERT_TRUE(traits.can_trigger);
    TEST_ASSERT_TRUE(traits.exposure_max_us > traits.exposure_min_us);
    TEST_ASSERT_EQUAL_DOUBLE(0, traits.gain_max_db); /* its gain has no unit */
    TEST_ASSERT_EQUAL_UINT32(16, traits.profile.frame_id_bits);
    TEST_ASSERT_EQUAL_UINT32(1, traits.profile.frame_id_skips_0);
    TEST_ASSERT_EQUAL_UINT64(1000000000, traits.profile.camera_tick_hz);
}

static void a_camera_that_is_not_there_is_a_clear_error(void)
{
    TEST_ASSERT_NULL(open_camera("Aravis-Fake-Nobody").get());
    TEST_ASSERT_NOT_EQUAL(std::string::npos, error.find("Nobody"));
    const bool told = some_time([] {
        TEST_ASSERT_NULL(open_camera("Aravis-Fake-OPMS1,trigger=Line7").get());
        return error.find("Line7") != std::string::npos;
    });
    TEST_ASSERT_TRUE_MESSAGE(told, error.c_str());
}

static void sixteen_bits_a_pixel_come_as_they_are(void)
{
    auto camera = started(8, 20, "Aravis-Fake-OPMS1,format=Mono16");
    const FramePtr frame = next_frame(*camera);
    TEST_ASSERT_EQUAL_INT(OPMS_PIXEL_GREY16, frame->image.format);
    TEST_ASSERT_EQUAL_UINT16(65535, frame->image.white_level);
    TEST_ASSERT_EQUAL_INT(2 * SIDE_PX, frame->image.stride_bytes);
}

/** Ids of a pairer that takes these frames: unwrapped. */
static std::vector<std::uint64_t> unwrapped(const std::vector<FramePtr> &frames,
                                            const opms_camera_profile_t &profile)
{
    opms_pair_options_t options;
    opms_pair_options_init(&options);
    options.camera = profile;
    opms_pairer_t *pairer = nullptr;
    opms_settings_t settings = {};
    settings.period_us = 100000;
    settings.width_us = 1000;
    settings.debounce_cycles = 125;
    opms_error_t why = {};
    TEST_ASSERT_EQUAL_INT(OPMS_OK, opms_pairer_create(&options, &pairer, nullptr));
    TEST_ASSERT_EQUAL_INT_MESSAGE(OPMS_OK, opms_pairer_open(pairer, 1, 1, &settings, &why),
                                  why.message);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        opms_frame_t header = {};
        header.frame_id = frames[i]->frame_id;
        header.camera_time_ticks = frames[i]->camera_time_ticks;
        header.arrival_host_ns = frames[i]->arrival_host_ns;
        header.flags = frames[i]->flags;
        header.tag = i;
        TEST_ASSERT_EQUAL_INT(OPMS_OK, opms_pairer_push_frame(pairer, &header, nullptr));
    }
    TEST_ASSERT_EQUAL_INT(OPMS_OK, opms_pairer_close(pairer, nullptr));
    std::vector<std::uint64_t> ids(frames.size());
    opms_pair_result_t result;
    std::uint32_t count = 0, total = 0;
    while (opms_pairer_poll(pairer, &result, 1, &count, nullptr) == OPMS_OK && count == 1) {
        if (result.frame_state != OPMS_FRAME_NONE) {
            ids[result.frame.tag] = result.frame_number;
            ++total;
        }
    }
    opms_pairer_destroy(pairer);
    TEST_ASSERT_EQUAL_UINT32(frames.size(), total);
    return ids;
}

static void ids_wrap_from_65535_to_1_and_the_pairer_counts_on(void)
{
    auto camera = started(256, 100);
    std::vector<FramePtr> frames;
    std::size_t wrapped_at = 0;
    while (frames.size() < 400 && (wrapped_at == 0 || frames.size() < wrapped_at + 20)) {
        FramePtr frame = next_frame(*camera);
        if (!frames.empty() && frame->frame_id < frames.back()->frame_id) {
            wrapped_at = frames.size();
        }
        /* Only the header is of interest: the buffer goes back. */
        auto header = std::make_shared<Frame>(*frame);
        header->memory.reset();
        frames.push_back(header);
    }
    TEST_ASSERT_NOT_EQUAL_MESSAGE(0, wrapped_at, "the fake camera's ids did not wrap");
    TEST_ASSERT_TRUE(frames[wrapped_at - 1]->frame_id <= LAST_ID);
    TEST_ASSERT_TRUE(frames[wrapped_at]->frame_id >= 1);

    const auto ids = unwrapped(frames, camera->traits().profile);
    for (std::size_t i = 1; i < frames.size(); ++i) {
        const std::uint64_t before = frames[i - 1]->frame_id, now = frames[i]->frame_id;
        const std::uint64_t step = now > before ? now - before : now + LAST_ID - before;
        TEST_ASSERT_EQUAL_UINT64(step, ids[i] - ids[i - 1]);
        const bool both_timed =
            ((frames[i]->flags | frames[i - 1]->flags) & OPMS_FRAME_NO_TIME) == 0;
        TEST_ASSERT_TRUE(!both_timed ||
                         frames[i]->camera_time_ticks > frames[i - 1]->camera_time_ticks);
    }
}

static void lost_packets_make_damaged_frames_and_are_never_silent(void)
{
    /* One packet in 20 is lost; a picture has some 12 of 1500 bytes. */
    g_object_set(fake, "gvsp-lost-ratio", 0.05, nullptr);
    auto camera = started(32, 20);
    std::uint64_t whole = 0, damaged = 0;
    for (int i = 0; i < 400 && (whole < 5 || damaged < 5); ++i) {
        const FramePtr frame = next_frame(*camera);
        const bool is_damaged = (frame->flags & OPMS_FRAME_DAMAGED) != 0;
        ++(is_damaged ? damaged : whole);
        const bool has_id = (frame->flags & OPMS_FRAME_NO_ID) == 0;
        TEST_ASSERT_TRUE(is_damaged || has_id);
        TEST_ASSERT_TRUE(!has_id || (frame->frame_id >= 1 && frame->frame_id <= LAST_ID));
        TEST_ASSERT_EQUAL_INT(SIDE_PX, frame->image.width_px);
    }
    char counts[64];
    std::snprintf(counts, sizeof counts, "%d whole, %d damaged", static_cast<int>(whole),
                  static_cast<int>(damaged));
    TEST_ASSERT_TRUE_MESSAGE(whole >= 5, counts);
    TEST_ASSERT_TRUE_MESSAGE(damaged >= 5, counts);
    TEST_ASSERT_EQUAL_UINT64(damaged, camera->counters().damaged);
    TEST_ASSERT_EQUAL_UINT64(damaged + whole, camera->counters().delivered);
}

static void pictures_are_never_more_than_the_buffers(void)
{
    auto camera = started(3, 100);
    std::vector<FramePtr> kept;
    for (int i = 0; i < 3; ++i) {
        kept.push_back(next_frame(*camera));
    }
    const auto *first = static_cast<const std::uint8_t *>(kept[0]->image.pixels);
    const std::vector<std::uint8_t> before(first, first + SIDE_PX);
    const bool one_was_missed = some_time([&] {
        SourceItem item;
        camera->wait(300, item);
        TEST_ASSERT_EQUAL_INT(static_cast<int>(SourceItemKind::none),
                              static_cast<int>(item.kind));
        return camera->counters().no_buffer > 0;
    });
    TEST_ASSERT_TRUE(one_was_missed);
    TEST_ASSERT_EQUAL_UINT32(3, camera->counters().lent);
    TEST_ASSERT_EQUAL_MEMORY(before.data(), first, before.size());
    kept.clear();
    next_frame(*camera);
}

static void exposure_is_confirmed_and_then_told_with_each_picture(void)
{
    auto camera = started(8, 20);
    const double first_us = next_frame(*camera)->exposure_us;
    TEST_ASSERT_TRUE(first_us > 0);
    TEST_ASSERT_TRUE_MESSAGE(some_time([&] { return camera->set_exposure(7000, 0, error); }),
                             error.c_str());
    bool unknown = false;
    FramePtr frame = next_frame(*camera);
    for (int i = 0; i < 20 && !(frame->exposure_us == 7000); ++i) {
        unknown = unknown || !(frame->exposure_us == frame->exposure_us);
        TEST_ASSERT_TRUE(unknown || frame->exposure_us == first_us);
        frame = next_frame(*camera);
    }
    TEST_ASSERT_EQUAL_DOUBLE(7000, frame->exposure_us);
    TEST_ASSERT_TRUE(unknown); /* one was on its way */
}

static void the_hardware_trigger_is_set_and_ended(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, trigger_mode());
    {
        auto camera = started_with(SourceStart());
        TEST_ASSERT_NOT_EQUAL(0, trigger_mode());
        camera->stop();
        camera->stop();
    }
    auto camera = started(8, 20);
    TEST_ASSERT_EQUAL_UINT32(0, trigger_mode());
    next_frame(*camera);
}

static void a_camera_that_vanishes_is_told_of_and_taken_up_again(void)
{
    auto camera = started(8, 20);
    const FramePtr kept = next_frame(*camera);
    unplug();
    SourceItem item = next(*camera);
    while (item.kind == SourceItemKind::frame) {
        item = next(*camera);
    }
    TEST_ASSERT_EQUAL_INT(static_cast<int>(SourceItemKind::lost), static_cast<int>(item.kind));
    plug("OPMS1");
    do {
        item = next(*camera); /* a start that a busy machine missed is told of, and tried again */
    } while (item.kind == SourceItemKind::failed);
    TEST_ASSERT_EQUAL_INT(static_cast<int>(SourceItemKind::back), static_cast<int>(item.kind));
    next_frame(*camera);
}

static void frames_outlive_the_camera(void)
{
    std::vector<FramePtr> kept;
    {
        auto camera = started(8, 50);
        kept = {next_frame(*camera), next_frame(*camera)};
    }
    unplug();
    TEST_ASSERT_NOT_EQUAL(0, kept[0]->arrival_host_ns);
    TEST_ASSERT_EQUAL_INT(SIDE_PX, kept[1]->image.height_px);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_camera_is_listed_and_tells_what_it_is);
    RUN_TEST(a_camera_that_is_not_there_is_a_clear_error);
    RUN_TEST(sixteen_bits_a_pixel_come_as_they_are);
    RUN_TEST(ids_wrap_from_65535_to_1_and_the_pairer_counts_on);
    RUN_TEST(lost_packets_make_damaged_frames_and_are_never_silent);
    RUN_TEST(pictures_are_never_more_than_the_buffers);
    RUN_TEST(exposure_is_confirmed_and_then_told_with_each_picture);
    RUN_TEST(the_hardware_trigger_is_set_and_ended);
    RUN_TEST(a_camera_that_vanishes_is_told_of_and_taken_up_again);
    RUN_TEST(frames_outlive_the_camera);
    const int failures = UNITY_END();
    arv_shutdown();
    return failures;
}
