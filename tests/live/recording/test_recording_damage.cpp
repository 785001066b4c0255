/* SPDX-License-Identifier: Apache-2.0 */
/* Files with bytes that are wrong, by seed: an error for people or rows, never more than that. */
#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>
#include <random>
#include <thread>

#include <unity.h>

#include "made_scan.hpp"
#include "temporary_folder.hpp"

using namespace opms_host;
namespace fs = std::filesystem;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr std::uint64_t FRAMES = 12;
constexpr int FILES = 200;

using Bytes = std::vector<char>;
using Random = std::mt19937_64;

Bytes read_file(const std::string &path)
{
    std::ifstream in(path, std::ios::binary);
    return Bytes(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
}

void write_file(const std::string &path, const Bytes &bytes)
{
    std::ofstream(path, std::ios::binary).write(bytes.data(),
                                                static_cast<std::streamsize>(bytes.size()));
}

std::size_t below(Random &random, std::size_t end)
{
    return static_cast<std::size_t>(random() % end);
}

/** A few bytes, a stretch, a page in another's place, or an end that is missing. */
void damage(Bytes &bytes, Random &random)
{
    const std::size_t kind = below(random, 4);
    if (kind == 0) {
        for (std::size_t i = 0; i <= below(random, 20); i++) {
            bytes[below(random, bytes.size())] = static_cast<char>(random());
        }
    } else if (kind == 1) {
        const std::size_t first = below(random, bytes.size());
        const std::size_t last = std::min(bytes.size(), first + below(random, 3000));
        std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(first),
                  bytes.begin() + static_cast<std::ptrdiff_t>(last), static_cast<char>(random()));
    } else if (kind == 2) {
        const std::size_t pages = bytes.size() / 4096;
        const std::size_t from = below(random, pages) * 4096, to = below(random, pages) * 4096;
        std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(from), 4096,
                    bytes.begin() + static_cast<std::ptrdiff_t>(to));
    } else {
        bytes.resize(below(random, bytes.size()));
    }
}

struct Outcome {
    int refused = 0, read = 0;
};

/** Open and read all. Rows that are there cannot be more than there were. */
void look_at(const std::string &folder, Outcome &outcome)
{
    std::string error;
    AllRows rows;
    const auto reader = ScanReader::open(folder, error);
    const bool good = reader && read_all(*reader, rows, error);
    TEST_ASSERT_TRUE_MESSAGE(good || error.rfind(folder, 0) == 0, error.c_str());
    TEST_ASSERT_TRUE(good || error.size() > folder.size() + 5);
    TEST_ASSERT_LESS_OR_EQUAL(10000, rows.frames.size());
    (good ? outcome.read : outcome.refused)++;
}

}  // namespace

static void test_a_damaged_database_is_refused_or_read(void)
{
    const TemporaryFolder folder;
    record_scan(folder.path(), "whole", FRAMES);
    const Bytes whole = read_file(folder / "whole/scan.sqlite");
    Outcome outcome;
    for (int seed = 1; seed <= FILES; seed++) {
        Random random(static_cast<std::uint64_t>(seed));
        Bytes bytes = whole;
        damage(bytes, random);
        fs::create_directories(folder / "damaged");
        write_file(folder / "damaged/scan.sqlite", bytes);
        look_at(folder / "damaged", outcome);
    }
    TEST_ASSERT_GREATER_THAN(FILES / 10, outcome.refused);
    TEST_ASSERT_GREATER_THAN(FILES / 10, outcome.read);
}

static void test_a_cut_off_scan_with_a_damaged_log_is_refused_or_read(void)
{
    const TemporaryFolder folder;
    const auto recorder = begin_scan(folder.path(), "live");
    hand_over(*recorder, 1, FRAMES, 9);
    while (recorder->figures().rows < 9 * FRAMES) { /* until the last picture is in the books */
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    const Bytes database = read_file(folder / "live/scan.sqlite");
    const Bytes log = read_file(folder / "live/scan.sqlite-wal");
    TEST_ASSERT_GREATER_THAN(10000, log.size());
    Outcome outcome;
    for (int seed = 1; seed <= FILES / 2; seed++) {
        Random random(static_cast<std::uint64_t>(seed));
        Bytes bytes = log;
        damage(bytes, random);
        fs::remove_all(folder / "damaged");
        fs::create_directories(folder / "damaged");
        write_file(folder / "damaged/scan.sqlite", database);
        write_file(folder / "damaged/scan.sqlite-wal", bytes);
        look_at(folder / "damaged", outcome);
    }
    TEST_ASSERT_GREATER_THAN(FILES / 4, outcome.read); /* what is before the damage is good */
}

static void test_a_value_that_cannot_be_is_told_by_its_name(void)
{
    const TemporaryFolder folder;
    record_scan(folder.path(), "one", 2);
    Bytes bytes = read_file(folder / "one/scan.sqlite");
    const std::string word = "motion", other = "notion";
    for (auto at = bytes.begin();;) {
        at = std::search(at, bytes.end(), word.begin(), word.end());
        if (at == bytes.end()) {
            break;
        }
        at = std::copy(other.begin(), other.end(), at);
    }
    write_file(folder / "one/scan.sqlite", bytes);
    std::string error;
    const auto reader = ScanReader::open(folder / "one", error);
    TEST_ASSERT_TRUE_MESSAGE(reader != nullptr, error.c_str());
    TEST_ASSERT_FALSE(reader->each_pose([](const PoseRecord &) { return true; }, error));
    TEST_ASSERT_TRUE_MESSAGE(error.find("a blur cannot be right") != std::string::npos,
                             error.c_str());
}

static void test_a_torn_picture_is_found(void)
{
    const TemporaryFolder folder;
    record_scan(folder.path(), "one", 2);
    std::string error;
    const auto reader = ScanReader::open(folder / "one", error);
    std::vector<PictureRow> pictures;
    reader->each_picture([&](const PictureRow &row) {
        pictures.push_back(row);
        return true;
    }, error);
    TEST_ASSERT_TRUE_MESSAGE(picture_is_whole(pictures[0], error), error.c_str());
    Bytes bytes = read_file(pictures[0].path);
    bytes[bytes.size() / 2] ^= 1;
    write_file(pictures[0].path, bytes);
    TEST_ASSERT_FALSE(picture_is_whole(pictures[0], error));
    TEST_ASSERT_TRUE(error.find("its sum differs") != std::string::npos);
    fs::resize_file(pictures[1].path, 10);
    TEST_ASSERT_FALSE(picture_is_whole(pictures[1], error));
    TEST_ASSERT_TRUE(error.find("has 10 bytes") != std::string::npos);
    fs::remove(pictures[1].path);
    TEST_ASSERT_FALSE(picture_is_whole(pictures[1], error));
    TEST_ASSERT_TRUE(error.find("is missing") != std::string::npos);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_damaged_database_is_refused_or_read);
    RUN_TEST(test_a_cut_off_scan_with_a_damaged_log_is_refused_or_read);
    RUN_TEST(test_a_value_that_cannot_be_is_told_by_its_name);
    RUN_TEST(test_a_torn_picture_is_found);
    return UNITY_END();
}
