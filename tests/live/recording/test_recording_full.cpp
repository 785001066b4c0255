/* SPDX-License-Identifier: Apache-2.0 */
/* A disk that is full, or broken, after so many bytes. */
#include <atomic>
#include <cerrno>
#include <chrono>
#include <thread>

#include <unity.h>

#include "disk_tap.h"
#include "made_records.hpp"
#include "made_scan.hpp"
#include "temporary_folder.hpp"

using namespace opms_host;
namespace fs = std::filesystem;

void setUp(void) {}
void tearDown(void)
{
    disk_tap_free();
}

namespace {

struct Told {
    std::atomic<int> full{0}, failed{0};
};

RecorderOptions options_of(Told &told, bool with_pictures)
{
    RecorderOptions options;
    options.commit_ms = 20;
    options.picture_every = with_pictures ? 1 : 0;
    options.on_event = [&told](const EventRecord &event) {
        told.full += event.code == "recording.full";
        told.failed += event.code == "recording.failed";
    };
    return options;
}

/** Hand over until the recording has ended, or for too long. @return Frames handed over. */
std::uint64_t hand_over_until_it_ends(Recorder &recorder)
{
    std::uint64_t n = 0;
    while (recorder.figures().state == RecordingState::on && n < 20000) {
        n++;
        hand_over(recorder, n, n, 30);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return n;
}

/** What is there is a beginning of what was handed over, and right. */
void assert_rows_are_right(const std::string &path)
{
    std::string error;
    AllRows rows;
    const auto reader = ScanReader::open(path, error);
    TEST_ASSERT_TRUE_MESSAGE(reader != nullptr, error.c_str());
    TEST_ASSERT_TRUE_MESSAGE(read_all(*reader, rows, error), error.c_str());
    for (std::size_t i = 0; i < rows.poses.size(); i++) {
        TEST_ASSERT_EQUAL_UINT64(i + 1, rows.poses[i].number);
        TEST_ASSERT_EQUAL_MEMORY(made::pose(i + 1, 30)->edges.data(), rows.poses[i].edges.data(),
                                 30 * sizeof(opms_edge_t));
    }
    for (const PictureRow &row : rows.pictures) {
        TEST_ASSERT_TRUE_MESSAGE(picture_is_whole(row, error), error.c_str());
    }
}

void fill_up(long long bytes, int system_error, bool with_pictures, RecordingState wanted)
{
    const TemporaryFolder folder;
    Told told;
    const auto recorder = begin_scan(folder.path(), "one", options_of(told, with_pictures));
    disk_tap_limit(folder.path().c_str(), bytes, system_error);
    const std::uint64_t handed = hand_over_until_it_ends(*recorder);
    const RecordingState state = recorder->figures().state;
    hand_over(*recorder, handed + 1, handed + 5, 30); /* goes on, and does nothing */
    std::string error;
    TEST_ASSERT_FALSE(recorder->end(made::end("stop"), error));
    TEST_ASSERT_TRUE_MESSAGE(wanted == state, error.c_str());
    TEST_ASSERT_FALSE(error.empty());
    TEST_ASSERT_EQUAL(wanted == RecordingState::full ? 1 : 0, told.full.load());
    TEST_ASSERT_EQUAL(wanted == RecordingState::failed ? 1 : 0, told.failed.load());
    assert_rows_are_right(folder / "one");

    disk_tap_free();
    ScanRecovery recovery;
    TEST_ASSERT_TRUE_MESSAGE(recover_scan(folder / "one", recovery, error), error.c_str());
    TEST_ASSERT_EQUAL_UINT64(0, recovery.pictures_lost);
    assert_rows_are_right(folder / "one");
}

}  // namespace

static void test_a_full_disk_ends_the_recording_and_what_is_there_is_right(void)
{
    for (const long long bytes : {0LL, 1LL, 5000LL, 33333LL, 250000LL, 1234567LL}) {
        fill_up(bytes, ENOSPC, true, RecordingState::full);
        fill_up(bytes, ENOSPC, false, RecordingState::full);
    }
}

static void test_a_full_quota_is_a_full_disk(void)
{
    fill_up(20000, EDQUOT, true, RecordingState::full);
}

static void test_a_broken_disk_ends_the_recording_and_what_is_there_is_right(void)
{
    for (const long long bytes : {0LL, 33333LL, 250000LL}) {
        fill_up(bytes, EIO, true, RecordingState::failed);
        fill_up(bytes, EIO, false, RecordingState::failed);
    }
}

static void test_no_scan_begins_on_a_full_disk(void)
{
    const TemporaryFolder folder;
    for (const long long bytes : {0LL, 5000LL, 30000LL}) {
        disk_tap_limit(folder.path().c_str(), bytes, ENOSPC);
        RecorderOptions options;
        options.folder = folder.path();
        std::string error;
        TEST_ASSERT_TRUE(Recorder::begin(options, made::header("one"),
                                         std::make_shared<SystemClock>(), error) == nullptr);
        TEST_ASSERT_TRUE_MESSAGE(error.find("full") != std::string::npos, error.c_str());
        TEST_ASSERT_FALSE(fs::exists(folder / "one"));
        TEST_ASSERT_FALSE(fs::exists(folder / ".new-one"));
    }
    disk_tap_free();
    record_scan(folder.path(), "one", 2);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_full_disk_ends_the_recording_and_what_is_there_is_right);
    RUN_TEST(test_a_full_quota_is_a_full_disk);
    RUN_TEST(test_a_broken_disk_ends_the_recording_and_what_is_there_is_right);
    RUN_TEST(test_no_scan_begins_on_a_full_disk);
    return UNITY_END();
}
