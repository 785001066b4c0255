/* SPDX-License-Identifier: Apache-2.0 */
/* Folders of pictures and recorded scans as devices, and the texts that name devices. */
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <unistd.h>
#include <unity.h>

#include "folder_source.hpp"
#include "open_devices.hpp"
#include "recorder.hpp"

using namespace opms_host;
namespace fs = std::filesystem;

constexpr std::int64_t MS = 1000000, BEGUN = 5000 * MS;
constexpr std::uint32_t SESSION = 77, BOOT = 99;
constexpr std::int32_t WIDTH = 40, HEIGHT = 30;

static fs::path folder;
static Devices devices;
static OpenError failure;
static std::string error;

void setUp(void)
{
    folder = fs::temp_directory_path() / ("opms_replay_" + std::to_string(getpid()));
    fs::remove_all(folder);
    fs::create_directories(folder);
    devices = Devices();
    failure = OpenError();
    error.clear();
}

void tearDown(void)
{
    devices = Devices();
    fs::remove_all(folder);
}

static bool open(const std::string &box, const std::string &source)
{
    OpenRequest request;
    request.box = box;
    request.source = source;
    return open_devices(request, devices, failure);
}

static void expect_failure(OpenFailure kind, const char *word)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(static_cast<int>(kind), static_cast<int>(failure.kind),
                                  failure.text.c_str());
    TEST_ASSERT_NOT_EQUAL_MESSAGE(std::string::npos, failure.text.find(word),
                                  failure.text.c_str());
    TEST_ASSERT_NULL(devices.source.get());
    TEST_ASSERT_NULL(devices.box.get());
}

static void write_picture(const std::string &name, int grey, int width = WIDTH)
{
    std::ofstream out(folder / name, std::ios::binary);
    out << "P5\n" << width << " " << HEIGHT << "\n255\n"
        << std::string(static_cast<std::size_t>(width * HEIGHT), static_cast<char>(grey));
}

static SourceItem next(SourceItemKind kind)
{
    SourceItem item;
    devices.source->wait(20000, item);
    TEST_ASSERT_EQUAL_INT_MESSAGE(static_cast<int>(kind), static_cast<int>(item.kind),
                                  item.text.c_str());
    return item;
}

static int grey_of(const FramePtr &frame)
{
    return static_cast<const std::uint8_t *>(frame->image.pixels)[0];
}

static void names_are_ordered_by_the_value_of_their_numbers(void)
{
    TEST_ASSERT_TRUE(name_is_before("a9", "a10"));
    TEST_ASSERT_FALSE(name_is_before("a10", "a9"));
    TEST_ASSERT_TRUE(name_is_before("a007", "a8"));
    TEST_ASSERT_TRUE(name_is_before("a7", "a7b"));
    TEST_ASSERT_TRUE(name_is_before("a07", "a7") != name_is_before("a7", "a07"));
    TEST_ASSERT_FALSE(name_is_before("a7", "a7"));
    TEST_ASSERT_TRUE(name_is_before("a99999999999999999999998", "a99999999999999999999999"));
}

static void a_folder_gives_its_pictures_in_order_and_then_ends(void)
{
    write_picture("p10.pgm", 10);
    write_picture("p9.pgm", 9);
    write_picture("p2.pgm", 2);
    std::ofstream(folder / "notes.txt") << "no picture";
    TEST_ASSERT_TRUE_MESSAGE(open("none", "replay:" + folder.string()), failure.text.c_str());
    TEST_ASSERT_FALSE(devices.source->traits().live);
    TEST_ASSERT_EQUAL_INT32(WIDTH, devices.source->traits().width_px);
    for (int round = 0; round < 2; ++round) { /* a new start begins anew */
        TEST_ASSERT_TRUE(devices.source->start(SourceStart(), error));
        for (const int grey : {2, 9, 10}) {
            const FramePtr frame = next(SourceItemKind::frame).frame;
            TEST_ASSERT_EQUAL_INT(grey, grey_of(frame));
            TEST_ASSERT_EQUAL_UINT32(OPMS_FRAME_NO_ID | OPMS_FRAME_NO_TIME, frame->flags);
        }
        next(SourceItemKind::end);
    }
}

static void a_folder_waits_for_pictures_to_be_given_back(void)
{
    for (int i = 0; i < 4; ++i) {
        write_picture("p" + std::to_string(i) + ".pgm", i);
    }
    TEST_ASSERT_TRUE(open("", "replay:" + folder.string()));
    SourceStart start;
    start.buffers = 2;
    TEST_ASSERT_TRUE(devices.source->start(start, error));
    FramePtr first = next(SourceItemKind::frame).frame;
    const FramePtr second = next(SourceItemKind::frame).frame;
    SourceItem item;
    devices.source->wait(20, item);
    TEST_ASSERT_EQUAL_INT(static_cast<int>(SourceItemKind::none), static_cast<int>(item.kind));
    TEST_ASSERT_EQUAL_UINT32(2, devices.source->counters().lent);
    std::thread giver([&first] { first.reset(); });
    TEST_ASSERT_EQUAL_INT(2, grey_of(next(SourceItemKind::frame).frame));
    giver.join();
    devices = Devices();
    TEST_ASSERT_EQUAL_INT(1, grey_of(second)); /* outlives its source */
}

static void a_broken_picture_is_told_by_name_and_passed_over(void)
{
    write_picture("p1.pgm", 1);
    std::ofstream(folder / "p2.pgm") << "P5\n40 30\n255\nshort";
    write_picture("p3.pgm", 3, WIDTH + 1);
    write_picture("p4.pgm", 4);
    TEST_ASSERT_TRUE(open("", "replay:" + folder.string()));
    TEST_ASSERT_TRUE(devices.source->start(SourceStart(), error));
    next(SourceItemKind::frame);
    TEST_ASSERT_NOT_EQUAL(std::string::npos, next(SourceItemKind::failed).text.find("p2.pgm"));
    TEST_ASSERT_NOT_EQUAL(std::string::npos, next(SourceItemKind::failed).text.find("41 x 30"));
    TEST_ASSERT_EQUAL_INT(4, grey_of(next(SourceItemKind::frame).frame));
    TEST_ASSERT_EQUAL_UINT64(2, devices.source->counters().failed);
}

static void folders_that_are_none_are_input_errors(void)
{
    TEST_ASSERT_FALSE(open("none", "replay:" + folder.string()));
    expect_failure(OpenFailure::input, "no pictures");
    TEST_ASSERT_FALSE(open("none", "replay:" + (folder / "missing").string()));
    expect_failure(OpenFailure::input, "missing");
    TEST_ASSERT_FALSE(open("replay:" + folder.string(), "none"));
    expect_failure(OpenFailure::input, "scan.sqlite");
}

static void texts_that_name_nothing_are_usage_errors(void)
{
    const char *const sources[] = {"camera", "v4l2:", "v4l2:video0", "v4l2:/dev/video0,size=9",
                                   "v4l2:/dev/video0,gain_step_db=-1", "preview:x", "replay:",
                                   "aravis:A,format=RGB8", "aravis:A,trigger="};
    for (const char *const source : sources) {
        TEST_ASSERT_FALSE_MESSAGE(open("none", source), source);
        expect_failure(OpenFailure::usage, "");
        TEST_ASSERT_TRUE(!source_text_problem(source).empty());
    }
    const char *const boxes[] = {"usb", "hid:12", "emulated:0", "emulated:99999", "replay:"};
    for (const char *const box : boxes) {
        TEST_ASSERT_FALSE_MESSAGE(open(box, "none"), box);
        expect_failure(OpenFailure::usage, "replay:PATH");
    }
    TEST_ASSERT_FALSE(open("none", "simulated"));
    expect_failure(OpenFailure::usage, "simulated");
    for (const char *const good : {"aravis:", "aravis:Cam,trigger=Line1", "preview:0", "none", "",
                                   "v4l2:/dev/video2,size=640x480,trigger=wired",
                                   "simulated:a=b"}) {
        TEST_ASSERT_EQUAL_STRING("", source_text_problem(good).c_str());
    }
}

static void a_simulated_camera_is_given_the_real_box_s_place(void)
{
    OpenRequest request;
    request.box = "none";
    request.source = "simulated:path=arc";
    SimulatedRequest seen;
    request.simulated = [&seen](const SimulatedRequest &wanted, Devices &, OpenError &why) {
        seen = wanted;
        why = {OpenFailure::device, "as the world says"};
        return false;
    };
    TEST_ASSERT_FALSE(open_devices(request, devices, failure));
    expect_failure(OpenFailure::device, "as the world says");
    TEST_ASSERT_EQUAL_STRING("path=arc", seen.source_options->c_str());
    TEST_ASSERT_FALSE(seen.box_options.has_value());
}

/* --- recorded scans ------------------------------------------------------------------------- */

static FramePtr picture(std::uint64_t number, std::int64_t arrival_ns)
{
    auto bytes = std::make_shared<std::vector<std::uint8_t>>(
        static_cast<std::size_t>(WIDTH * HEIGHT), static_cast<std::uint8_t>(10 * number));
    auto frame = std::make_shared<Frame>();
    frame->image = {bytes->data(), WIDTH, HEIGHT, WIDTH, OPMS_PIXEL_GREY8, 200};
    frame->frame_id = 500 + number;
    frame->arrival_host_ns = arrival_ns;
    frame->memory = bytes;
    return frame;
}

static TriggerRecord trigger(std::uint32_t number, std::int64_t arrival_ns)
{
    TriggerRecord record;
    record.report.boot_id = BOOT;
    record.report.session_id = SESSION;
    record.report.trigger_number = number;
    record.report.time.us = 1000 * number;
    record.arrival_host_ns = arrival_ns;
    return record;
}

/** Three pulses, each reported 2 ms after it and its picture 30 ms later; pings before the start.
 * @param every  As RecorderOptions. */
static std::string record_scan(std::uint32_t every = 1)
{
    ScanHeader header;
    header.name = "scan";
    header.begun_host_ns = BEGUN;
    header.begun_wall_ns = 1000 * BEGUN;
    header.has_box = true;
    header.boot_id = BOOT;
    header.session_id = SESSION;
    header.width_px = WIDTH;
    header.height_px = HEIGHT;
    header.camera_profile.has_frame_id = 1;
    header.camera_profile.frame_id_bits = 16;
    opms_wire_default_settings(&header.box_settings);
    header.source_name = "v4l2:/dev/video0";
    RecorderOptions options;
    options.folder = folder.string();
    options.picture_every = every;
    auto recorder = Recorder::begin(options, header, std::make_shared<SystemClock>(), error);
    TEST_ASSERT_NOT_NULL_MESSAGE(recorder.get(), error.c_str());
    ClockRecord ping;
    ping.trip = {BEGUN - 200 * MS, 7000, 8000, BEGUN - 199 * MS};
    recorder->add(ping);
    BoxReportRecord status;
    opms_status_report_t report = {};
    report.state = OPMS_BOX_RUNNING;
    report.boot_id = BOOT;
    report.session_id = SESSION;
    opms_wire_write_status(&report, status.bytes.data());
    status.arrival_host_ns = BEGUN + 150 * MS;
    recorder->add(status);
    for (std::uint32_t i = 1; i <= 3; ++i) {
        const std::int64_t t_ns = BEGUN + 100 * MS * i;
        recorder->add(trigger(i, t_ns + 2 * MS));
        const FramePtr frame = picture(i, t_ns + 30 * MS);
        FrameRecord record;
        record.number = i;
        record.frame_id = frame->frame_id;
        record.arrival_host_ns = frame->arrival_host_ns;
        record.exposure_us = 1000.0 + i;
        record.white_level = 200;
        recorder->add(record, frame);
    }
    ScanEnd end;
    end.reason = "stop";
    TEST_ASSERT_TRUE_MESSAGE(recorder->end(end, error), error.c_str());
    return recorder->folder();
}

static opms_box_item_t next_item(opms_item_kind_t kind)
{
    opms_box_item_t item;
    TEST_ASSERT_TRUE(devices.box->poll(20000, item));
    TEST_ASSERT_EQUAL_INT(kind, item.kind);
    return item;
}

static void expect_nothing_from_the_box(void)
{
    opms_box_item_t item;
    TEST_ASSERT_TRUE(devices.box->poll(20, item));
    TEST_ASSERT_EQUAL_INT(OPMS_ITEM_NONE, item.kind);
}

static void a_recording_gives_box_and_camera_in_the_order_of_its_time(void)
{
    const std::string scan = record_scan();
    TEST_ASSERT_TRUE_MESSAGE(open("replay:" + scan, "replay:" + scan), failure.text.c_str());
    TEST_ASSERT_TRUE(devices.source->start(SourceStart(), error));
    SourceItem none;
    devices.source->wait(20, none); /* the box is not armed */
    TEST_ASSERT_EQUAL_INT(static_cast<int>(SourceItemKind::none), static_cast<int>(none.kind));
    TEST_ASSERT_EQUAL_UINT32(BOOT, next_item(OPMS_ITEM_LINK).as.link.boot_id);
    TEST_ASSERT_EQUAL_INT64(BEGUN - 200 * MS, next_item(OPMS_ITEM_PONG).as.pong.t_sent_host_ns);
    expect_nothing_from_the_box();

    TEST_ASSERT_TRUE(devices.box->arm(5, error));
    const opms_box_item_t first = next_item(OPMS_ITEM_TRIGGER);
    TEST_ASSERT_EQUAL_UINT32(5, first.as.trigger.session_id); /* the one that armed */
    TEST_ASSERT_EQUAL_INT64(BEGUN + 102 * MS, first.t_host_ns);
    TEST_ASSERT_EQUAL_INT64(BEGUN + 102 * MS, devices.clock->now_ns());
    expect_nothing_from_the_box(); /* the first picture came before the status */
    const FramePtr frame = next(SourceItemKind::frame).frame;
    TEST_ASSERT_EQUAL_UINT64(501, frame->frame_id);
    TEST_ASSERT_EQUAL_INT64(BEGUN + 130 * MS, frame->arrival_host_ns);
    TEST_ASSERT_EQUAL_DOUBLE(1001, frame->exposure_us);
    TEST_ASSERT_EQUAL_UINT16(200, frame->image.white_level);
    TEST_ASSERT_EQUAL_INT(10, grey_of(frame));
    TEST_ASSERT_EQUAL_UINT32(5, next_item(OPMS_ITEM_STATUS).as.status.session_id);
    TEST_ASSERT_EQUAL_UINT32(2, next_item(OPMS_ITEM_TRIGGER).as.trigger.trigger_number);
    next(SourceItemKind::frame);
    next_item(OPMS_ITEM_TRIGGER);
    next(SourceItemKind::frame);
    next(SourceItemKind::end);
    opms_box_item_t item;
    TEST_ASSERT_FALSE(devices.box->poll(20, item));
    TEST_ASSERT_EQUAL_INT64(1000 * BEGUN + 330 * MS, devices.clock->wall_ns());
}

static void a_recorded_box_keeps_its_settings_and_is_armed_once(void)
{
    const std::string scan = record_scan();
    TEST_ASSERT_TRUE(open("replay:" + scan, "none"));
    opms_settings_report_t report;
    TEST_ASSERT_TRUE(devices.box->settings(report, error));
    TEST_ASSERT_EQUAL_UINT32(100000, report.settings.period_us);
    TEST_ASSERT_TRUE(devices.box->set_settings(report.settings, error));
    report.settings.period_us = 50000;
    TEST_ASSERT_FALSE(devices.box->set_settings(report.settings, error));
    TEST_ASSERT_TRUE(devices.box->arm(5, error));
    TEST_ASSERT_FALSE(devices.box->arm(6, error));
    TEST_ASSERT_FALSE(devices.box->press_start(error));
}

static void pictures_that_were_not_stored_are_counted(void)
{
    const std::string scan = record_scan(2);
    TEST_ASSERT_TRUE(open("none", "replay:" + scan));
    TEST_ASSERT_TRUE(devices.source->start(SourceStart(), error));
    next(SourceItemKind::failed);
    const std::uint64_t lost = devices.source->counters().failed;
    std::uint64_t came = 0;
    SourceItem item;
    for (devices.source->wait(20000, item); item.kind == SourceItemKind::frame; ++came) {
        devices.source->wait(20000, item);
    }
    TEST_ASSERT_EQUAL_INT(static_cast<int>(SourceItemKind::end), static_cast<int>(item.kind));
    TEST_ASSERT_EQUAL_UINT64(3, came + lost);
    TEST_ASSERT_TRUE(came > 0 && lost > 0);
}

static void box_and_camera_of_two_recordings_are_refused(void)
{
    const std::string scan = record_scan();
    TEST_ASSERT_FALSE(open("replay:" + scan, "replay:" + folder.string()));
    expect_failure(OpenFailure::input, "same recording");
    std::ofstream(fs::path(scan) / "scan.sqlite", std::ios::trunc) << "this is no database";
    TEST_ASSERT_FALSE(open("replay:" + scan, "none"));
    expect_failure(OpenFailure::input, "");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(names_are_ordered_by_the_value_of_their_numbers);
    RUN_TEST(a_folder_gives_its_pictures_in_order_and_then_ends);
    RUN_TEST(a_folder_waits_for_pictures_to_be_given_back);
    RUN_TEST(a_broken_picture_is_told_by_name_and_passed_over);
    RUN_TEST(folders_that_are_none_are_input_errors);
    RUN_TEST(texts_that_name_nothing_are_usage_errors);
    RUN_TEST(a_simulated_camera_is_given_the_real_box_s_place);
    RUN_TEST(a_recording_gives_box_and_camera_in_the_order_of_its_time);
    RUN_TEST(a_recorded_box_keeps_its_settings_and_is_armed_once);
    RUN_TEST(pictures_that_were_not_stored_are_counted);
    RUN_TEST(box_and_camera_of_two_recordings_are_refused);
    return UNITY_END();
}
