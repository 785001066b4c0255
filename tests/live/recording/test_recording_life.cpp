/* SPDX-License-Identifier: Apache-2.0 */
/* How recordings begin, share a folder, are read meanwhile, end, and are mended. */
#include <atomic>
#include <chrono>
#include <fstream>
#include <iterator>
#include <map>
#include <thread>

#include <opencv2/imgcodecs.hpp>
#include <unity.h>

#include "made_records.hpp"
#include "made_scan.hpp"
#include "scan_lock.hpp"
#include "temporary_folder.hpp"

using namespace opms_host;
namespace fs = std::filesystem;

void setUp(void) {}
void tearDown(void) {}

namespace {

void finish(Recorder &recorder)
{
    std::string error;
    TEST_ASSERT_TRUE_MESSAGE(recorder.end(made::end("stop"), error), error.c_str());
}

/** Wait for what must come some time; a machine may be slow. */
template <typename Condition> bool comes(const Condition &condition)
{
    for (int i = 0; i < 3000; i++) {
        if (condition()) {
            return true;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
}

/** As a cut leaves it: a copy of the folder while it is being recorded. */
void copy_cut_off(const std::string &from, const std::string &to)
{
    fs::copy(from, to, fs::copy_options::recursive);
    fs::remove(to + "/scan.sqlite-shm");
}

std::vector<char> bytes_of(const std::string &path)
{
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::map<std::string, std::uintmax_t> files_of(const std::string &folder)
{
    std::map<std::string, std::uintmax_t> files;
    for (const auto &entry : fs::recursive_directory_iterator(folder)) {
        files[entry.path().string()] = entry.is_regular_file() ? entry.file_size() : 0;
    }
    return files;
}

ScanSummary summary_of(const std::string &path)
{
    std::string error;
    const auto reader = ScanReader::open(path, error);
    TEST_ASSERT_TRUE_MESSAGE(reader != nullptr, error.c_str());
    return reader->summary();
}

std::unique_ptr<Recorder> try_to_begin(const std::string &folder, const std::string &name,
                                       std::string &error)
{
    RecorderOptions options;
    options.folder = folder;
    return Recorder::begin(options, made::header(name), std::make_shared<SystemClock>(), error);
}

void assert_name(const char *wanted, bool good)
{
    const TemporaryFolder folder;
    std::string error;
    const std::string name = scan_free_name(folder.path(), wanted, 0, error);
    TEST_ASSERT_EQUAL_STRING_MESSAGE(good ? wanted : "", name.c_str(), wanted);
    TEST_ASSERT_EQUAL(good, error.empty());
    const auto recorder = try_to_begin(folder.path(), wanted, error);
    TEST_ASSERT_EQUAL_MESSAGE(good, recorder != nullptr, wanted);
}

}  // namespace

static void test_names_that_a_scan_may_have(void)
{
    assert_name("2026-11-22_14-03-07", true);
    assert_name("Lane 3.b", true);
    assert_name(std::string(100, 'x').c_str(), true);
}

static void test_names_that_a_scan_may_not_have(void)
{
    for (const char *name : {"..", ".hidden", "a/b", "../a", "a\\b", "ends.", "ends ", "new\nline",
                             "caf\xc3\xa9", "a:b", "*"}) {
        assert_name(name, false);
    }
    assert_name(std::string(101, 'x').c_str(), false);
}

static void test_scans_of_the_same_second_get_names_of_their_own(void)
{
    const TemporaryFolder folder;
    const std::int64_t wall_ns = 1795356187000000000;
    std::string error;
    const std::string first = scan_free_name(folder.path(), "", wall_ns, error);
    TEST_ASSERT_EQUAL_STRING("2026-11-22_14-03-07", first.c_str());
    finish(*begin_scan(folder.path(), first));
    const std::string second = scan_free_name(folder.path(), "", wall_ns, error);
    TEST_ASSERT_EQUAL_STRING("2026-11-22_14-03-07-2", second.c_str());
    finish(*begin_scan(folder.path(), second));
    TEST_ASSERT_EQUAL_STRING("2026-11-22_14-03-07-3",
                             scan_free_name(folder.path(), "", wall_ns, error).c_str());
    std::vector<std::string> failed;
    TEST_ASSERT_EQUAL(2, list_scans(folder.path(), failed).size());
    TEST_ASSERT_EQUAL(0, failed.size());
}

static void test_a_scan_is_never_begun_over_another(void)
{
    const TemporaryFolder folder;
    record_scan(folder.path(), "one", 2);
    std::string error;
    TEST_ASSERT_TRUE(try_to_begin(folder.path(), "one", error) == nullptr);
    TEST_ASSERT_TRUE(error.find("is there already") != std::string::npos);
    TEST_ASSERT_EQUAL_UINT64(2, summary_of(folder / "one").frames);
}

static void test_what_a_killed_start_left_over_is_cleaned_by_the_next(void)
{
    const TemporaryFolder folder;
    fs::create_directories(folder / ".new-dead/pictures");
    std::ofstream(folder / ".new-dead/scan.sqlite") << "half";
    std::vector<std::string> failed;
    TEST_ASSERT_EQUAL(0, list_scans(folder.path(), failed).size());
    TEST_ASSERT_EQUAL(0, failed.size());
    finish(*begin_scan(folder.path(), "next"));
    TEST_ASSERT_FALSE(fs::exists(folder / ".new-dead"));
}

static void test_a_scan_can_be_read_while_it_is_recorded(void)
{
    const TemporaryFolder folder;
    const auto recorder = begin_scan(folder.path(), "live");
    hand_over(*recorder, 1, 5, 9);
    std::string error;
    TEST_ASSERT_TRUE(comes([&] { return summary_of(folder / "live").pictures == 5; }));
    const auto reader = ScanReader::open(folder / "live", error);
    TEST_ASSERT_TRUE(reader->summary().being_recorded);
    TEST_ASSERT_FALSE(reader->summary().ended);
    hand_over(*recorder, 6, 9, 9);
    TEST_ASSERT_TRUE(comes([&] {
        AllRows rows;
        return read_all(*reader, rows, error) && rows.poses.size() == 9;
    }));
    finish(*recorder);
    TEST_ASSERT_FALSE(summary_of(folder / "live").being_recorded);
}

static void test_pictures_are_stored_without_loss(void)
{
    const TemporaryFolder folder;
    record_scan(folder.path(), "one", 4);
    std::string error;
    const auto reader = ScanReader::open(folder / "one", error);
    int seen = 0;
    const bool read = reader->each_picture([&](const PictureRow &row) {
        const FramePtr made = made::picture(row.number, 64, 48, row.number % 2 == 0);
        const cv::Mat found = cv::imdecode(bytes_of(row.path), cv::IMREAD_UNCHANGED);
        TEST_ASSERT_EQUAL(row.number % 2 == 0 ? CV_16UC1 : CV_8UC1, found.type());
        const auto *wanted = static_cast<const std::uint8_t *>(made->image.pixels);
        for (int y = 0; y < found.rows; y++) {
            TEST_ASSERT_EQUAL_MEMORY(wanted + y * made->image.stride_bytes, found.ptr(y),
                                     static_cast<std::size_t>(found.cols) * found.elemSize());
        }
        TEST_ASSERT_TRUE_MESSAGE(picture_is_whole(row, error), error.c_str());
        seen++;
        return true;
    }, error);
    TEST_ASSERT_TRUE_MESSAGE(read, error.c_str());
    TEST_ASSERT_EQUAL(4, seen);
}

static void test_each_nth_picture_is_stored_where_that_is_asked_for(void)
{
    const TemporaryFolder folder;
    RecorderOptions options;
    options.picture_every = 3;
    const auto recorder = begin_scan(folder.path(), "third", options);
    hand_over(*recorder, 999, 1005, 1);
    finish(*recorder);
    std::vector<std::uint64_t> numbers;
    std::string error;
    ScanReader::open(folder / "third", error)->each_picture([&](const PictureRow &row) {
        numbers.push_back(row.number);
        return true;
    }, error);
    TEST_ASSERT_EQUAL(2, numbers.size());
    TEST_ASSERT_EQUAL_UINT64(1000, numbers[0]);
    TEST_ASSERT_EQUAL_UINT64(1003, numbers[1]);
    TEST_ASSERT_TRUE(fs::exists(folder / "third/pictures/001/001003.png"));
}

static void test_pictures_that_find_no_place_are_counted_and_told(void)
{
    const TemporaryFolder folder;
    std::atomic<int> told{0};
    RecorderOptions options;
    options.picture_queue = 1;
    options.on_event = [&](const EventRecord &event) {
        told += event.code == "recording.pictures_not_stored";
    };
    const auto recorder = begin_scan(folder.path(), "fast", options);
    hand_over(*recorder, 1, 200, 0);
    finish(*recorder);
    const RecorderFigures figures = recorder->figures();
    TEST_ASSERT_GREATER_THAN_UINT64(0, figures.pictures_not_stored);
    TEST_ASSERT_EQUAL_UINT64(200, figures.pictures_stored + figures.pictures_not_stored);
    TEST_ASSERT_GREATER_THAN(0, told.load());
    const ScanSummary found = summary_of(folder / "fast");
    TEST_ASSERT_EQUAL_UINT64(200, found.poses);
    TEST_ASSERT_EQUAL_UINT64(figures.pictures_stored, found.pictures);
    TEST_ASSERT_EQUAL_UINT64(200 + static_cast<std::uint64_t>(told.load()), found.events);
}

static void test_a_number_that_is_there_already_costs_only_itself(void)
{
    const TemporaryFolder folder;
    std::atomic<int> refused{0};
    RecorderOptions options;
    options.on_event = [&](const EventRecord &event) {
        refused += event.code == "recording.row_refused";
    };
    const auto recorder = begin_scan(folder.path(), "twice", options);
    recorder->add(made::frame(1), nullptr);
    recorder->add(made::frame(1), nullptr);
    recorder->add(made::frame(2), nullptr);
    finish(*recorder);
    TEST_ASSERT_EQUAL(1, refused.load());
    TEST_ASSERT_EQUAL_UINT64(2, summary_of(folder / "twice").frames);
    TEST_ASSERT_EQUAL_UINT64(1, summary_of(folder / "twice").events);
}

static void test_a_recorder_that_is_dropped_says_so_and_loses_nothing(void)
{
    const TemporaryFolder folder;
    {
        const auto recorder = begin_scan(folder.path(), "dropped");
        hand_over(*recorder, 1, 3, 1);
    }
    TEST_ASSERT_EQUAL_STRING("abandoned", summary_of(folder / "dropped").end.reason.c_str());
    TEST_ASSERT_EQUAL_UINT64(3, summary_of(folder / "dropped").pictures);
}

static void test_what_comes_after_the_end_does_nothing(void)
{
    const TemporaryFolder folder;
    const auto recorder = begin_scan(folder.path(), "over");
    finish(*recorder);
    hand_over(*recorder, 1, 3, 1);
    std::string error;
    TEST_ASSERT_FALSE(recorder->end(made::end("again"), error));
    TEST_ASSERT_EQUAL_STRING("the recording has ended already", error.c_str());
    TEST_ASSERT_EQUAL_UINT64(0, summary_of(folder / "over").frames);
}

static void test_a_live_scan_is_not_mended(void)
{
    const TemporaryFolder folder;
    const auto recorder = begin_scan(folder.path(), "live");
    ScanRecovery recovery;
    std::string error;
    TEST_ASSERT_FALSE(recover_scan(folder / "live", recovery, error));
    TEST_ASSERT_TRUE(error.find("is being recorded") != std::string::npos);
    finish(*recorder);
    TEST_ASSERT_TRUE_MESSAGE(recover_scan(folder / "live", recovery, error), error.c_str());
    TEST_ASSERT_FALSE(recovery.needed);
}

static void test_a_cut_off_scan_is_read_and_mended(void)
{
    const TemporaryFolder folder;
    const auto recorder = begin_scan(folder.path(), "live");
    hand_over(*recorder, 1, 6, 9);
    TEST_ASSERT_TRUE(comes([&] { return summary_of(folder / "live").pictures == 6; }));
    const std::string cut = folder / "cut";
    copy_cut_off(folder / "live", cut);
    finish(*recorder);
    const auto files = files_of(cut);
    TEST_ASSERT_EQUAL_UINT64(6, summary_of(cut).poses);
    TEST_ASSERT_FALSE(summary_of(cut).ended);
    TEST_ASSERT_TRUE_MESSAGE(files == files_of(cut), "reading has changed the folder");

    fs::resize_file(cut + "/pictures/000/000004.png", 50); /* torn */
    std::ofstream(cut + "/pictures/000/000007.png") << "not in the books";
    std::ofstream(cut + "/pictures/000/000008.png.part") << "half";
    ScanRecovery recovery;
    std::string error;
    TEST_ASSERT_TRUE_MESSAGE(recover_scan(cut, recovery, error), error.c_str());
    TEST_ASSERT_TRUE(recovery.needed);
    TEST_ASSERT_EQUAL_UINT64(1, recovery.pictures_lost);
    TEST_ASSERT_EQUAL_UINT64(1, recovery.pictures_loose);
    TEST_ASSERT_EQUAL_UINT64(9 * 6 + 5, recovery.rows);
    TEST_ASSERT_EQUAL_INT64(6 * 16000000 + 1, recovery.last_host_ns);
    TEST_ASSERT_TRUE(summary_of(cut).recovered);
    TEST_ASSERT_EQUAL_UINT64(5, summary_of(cut).pictures);
    TEST_ASSERT_FALSE(fs::exists(cut + "/pictures/000/000008.png.part"));
    TEST_ASSERT_TRUE_MESSAGE(recover_scan(cut, recovery, error), error.c_str());
    TEST_ASSERT_FALSE(recovery.needed);
}

static void test_options_out_of_range_are_refused(void)
{
    const TemporaryFolder folder;
    RecorderOptions options;
    options.folder = folder.path();
    options.commit_ms = 5;
    std::string error;
    TEST_ASSERT_TRUE(Recorder::begin(options, made::header("x"), std::make_shared<SystemClock>(),
                                     error) == nullptr);
    TEST_ASSERT_EQUAL_STRING("commits are 20 to 900 ms apart", error.c_str());
    TEST_ASSERT_FALSE(fs::exists(folder / "x"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_names_that_a_scan_may_have);
    RUN_TEST(test_names_that_a_scan_may_not_have);
    RUN_TEST(test_scans_of_the_same_second_get_names_of_their_own);
    RUN_TEST(test_a_scan_is_never_begun_over_another);
    RUN_TEST(test_what_a_killed_start_left_over_is_cleaned_by_the_next);
    RUN_TEST(test_a_scan_can_be_read_while_it_is_recorded);
    RUN_TEST(test_pictures_are_stored_without_loss);
    RUN_TEST(test_each_nth_picture_is_stored_where_that_is_asked_for);
    RUN_TEST(test_pictures_that_find_no_place_are_counted_and_told);
    RUN_TEST(test_a_number_that_is_there_already_costs_only_itself);
    RUN_TEST(test_a_recorder_that_is_dropped_says_so_and_loses_nothing);
    RUN_TEST(test_what_comes_after_the_end_does_nothing);
    RUN_TEST(test_a_live_scan_is_not_mended);
    RUN_TEST(test_a_cut_off_scan_is_read_and_mended);
    RUN_TEST(test_options_out_of_range_are_refused);
    return UNITY_END();
}
