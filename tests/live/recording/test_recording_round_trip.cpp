/* SPDX-License-Identifier: Apache-2.0 */
/* What is read is what was handed over, bit by bit. */
#include <cstring>
#include <limits>

#include <unity.h>

#include "made_records.hpp"
#include "made_scan.hpp"
#include "temporary_folder.hpp"

using namespace opms_host;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr std::uint64_t FRAMES = 40;

/** Bits, not values: NaN is NaN, and -0.0 is not 0.0. */
template <typename Value> void assert_bits(const Value &wanted, const Value &found)
{
    TEST_ASSERT_EQUAL_MEMORY(&wanted, &found, sizeof(Value));
}

template <typename Value>
void assert_list(const std::vector<Value> &wanted, const std::vector<Value> &found)
{
    TEST_ASSERT_EQUAL(wanted.size(), found.size());
    for (std::size_t i = 0; i < wanted.size(); i++) {
        assert_bits(wanted[i], found[i]);
    }
}

void assert_pose(const PoseRecord &wanted, const PoseRecord &found)
{
    TEST_ASSERT_EQUAL_UINT64(wanted.number, found.number);
    TEST_ASSERT_EQUAL(wanted.frame_state, found.frame_state);
    TEST_ASSERT_EQUAL_UINT32(wanted.known, found.known);
    TEST_ASSERT_EQUAL_UINT64(wanted.trigger_number, found.trigger_number);
    TEST_ASSERT_EQUAL(wanted.has_time, found.has_time);
    TEST_ASSERT_EQUAL(wanted.is_mid_exposure, found.is_mid_exposure);
    TEST_ASSERT_EQUAL_INT64(wanted.t_scan_ns, found.t_scan_ns);
    TEST_ASSERT_EQUAL_INT64(wanted.t_host_ns, found.t_host_ns);
    TEST_ASSERT_EQUAL(wanted.has_hint, found.has_hint);
    assert_bits(wanted.hint, found.hint);
    assert_bits(wanted.location, found.location);
    assert_list(wanted.squares, found.squares);
    assert_list(wanted.edges, found.edges);
    assert_list(wanted.residuals_px, found.residuals_px);
    assert_bits(wanted.light, found.light);
    assert_bits(wanted.exposure, found.exposure);
    TEST_ASSERT_TRUE(wanted.blur == found.blur);
    assert_bits(wanted.blur_px, found.blur_px);
    TEST_ASSERT_EQUAL_INT64(wanted.arrival_host_ns, found.arrival_host_ns);
    TEST_ASSERT_EQUAL_INT64(wanted.located_host_ns, found.located_host_ns);
    TEST_ASSERT_EQUAL_INT64(wanted.published_host_ns, found.published_host_ns);
}

void assert_frame(const FrameRecord &wanted, const FrameRecord &found)
{
    TEST_ASSERT_EQUAL_UINT64(wanted.number, found.number);
    TEST_ASSERT_EQUAL_UINT64(wanted.frame_id, found.frame_id);
    TEST_ASSERT_EQUAL_UINT64(wanted.camera_time_ticks, found.camera_time_ticks);
    TEST_ASSERT_EQUAL_INT64(wanted.arrival_host_ns, found.arrival_host_ns);
    TEST_ASSERT_EQUAL_UINT32(wanted.flags, found.flags);
    assert_bits(wanted.exposure_us, found.exposure_us);
    assert_bits(wanted.gain_db, found.gain_db);
    TEST_ASSERT_EQUAL_UINT16(wanted.white_level, found.white_level);
}

void assert_trigger(const TriggerRecord &wanted, const TriggerRecord &found)
{
    std::uint8_t one[OPMS_WIRE_SIZE], other[OPMS_WIRE_SIZE];
    opms_wire_write_trigger(&wanted.report, one);
    opms_wire_write_trigger(&found.report, other);
    TEST_ASSERT_EQUAL_MEMORY(one, other, OPMS_WIRE_SIZE);
    TEST_ASSERT_EQUAL(wanted.from_history, found.from_history);
    TEST_ASSERT_EQUAL_INT64(wanted.arrival_host_ns, found.arrival_host_ns);
}

void assert_sensor(const SensorRecord &wanted, const SensorRecord &found)
{
    TEST_ASSERT_EQUAL_STRING(wanted.sensor.c_str(), found.sensor.c_str());
    TEST_ASSERT_EQUAL_UINT64(wanted.number, found.number);
    TEST_ASSERT_EQUAL(wanted.has_time, found.has_time);
    TEST_ASSERT_EQUAL_INT64(wanted.t_scan_ns, found.t_scan_ns);
    TEST_ASSERT_EQUAL_INT64(wanted.t_bound_ns, found.t_bound_ns);
    TEST_ASSERT_EQUAL_INT64(wanted.arrival_host_ns, found.arrival_host_ns);
    assert_list(wanted.values, found.values);
    TEST_ASSERT_EQUAL_STRING(wanted.data_json.c_str(), found.data_json.c_str());
}

AllRows read_scan(const std::string &path)
{
    std::string error;
    AllRows rows;
    const auto reader = ScanReader::open(path, error);
    TEST_ASSERT_TRUE_MESSAGE(reader != nullptr, error.c_str());
    TEST_ASSERT_TRUE_MESSAGE(read_all(*reader, rows, error), error.c_str());
    return rows;
}

}  // namespace

static void test_every_record_comes_back_as_it_was(void)
{
    const TemporaryFolder folder;
    record_scan(folder.path(), "one", FRAMES);
    const AllRows rows = read_scan(folder / "one");
    TEST_ASSERT_EQUAL(FRAMES, rows.frames.size());
    TEST_ASSERT_EQUAL(FRAMES, rows.triggers.size());
    TEST_ASSERT_EQUAL(FRAMES, rows.pairs.size());
    TEST_ASSERT_EQUAL(FRAMES, rows.poses.size());
    TEST_ASSERT_EQUAL(FRAMES, rows.events.size());
    TEST_ASSERT_EQUAL(FRAMES, rows.clock.size());
    TEST_ASSERT_EQUAL(FRAMES, rows.box_reports.size());
    TEST_ASSERT_EQUAL(FRAMES, rows.sensors.size());
    for (std::uint64_t n = 1; n <= FRAMES; n++) {
        const std::size_t i = n - 1;
        assert_frame(made::frame(n), rows.frames[i]);
        assert_trigger(made::trigger(n), rows.triggers[i]);
        assert_bits(made::pair(n), rows.pairs[i]);
        assert_pose(*made::pose(n, 9), rows.poses[i]);
        TEST_ASSERT_TRUE(made::event(n).severity == rows.events[i].severity);
        TEST_ASSERT_EQUAL_STRING(made::event(n).text.c_str(), rows.events[i].text.c_str());
        TEST_ASSERT_EQUAL_STRING(made::event(n).data_json.c_str(),
                                 rows.events[i].data_json.c_str());
        assert_bits(made::clock(n), rows.clock[i]);
        assert_bits(made::box_report(n), rows.box_reports[i]);
        assert_sensor(made::sensor(n), rows.sensors[i]);
    }
}

static void test_minus_zero_infinity_and_not_a_number_stay_what_they_are(void)
{
    const TemporaryFolder folder;
    const auto recorder = begin_scan(folder.path(), "odd");
    auto odd = std::make_shared<PoseRecord>(*made::pose(1, 3));
    const double infinity = std::numeric_limits<double>::infinity();
    odd->location.pose.bar_camera.transform.R[0] = -0.0;
    odd->location.ground_detector.covariance[5] = infinity;
    odd->location.bar.noise = std::numeric_limits<double>::quiet_NaN();
    odd->edges[1].px[0] = -0.0;
    odd->residuals_px[2] = -infinity;
    recorder->add(std::shared_ptr<const PoseRecord>(odd));
    std::string error;
    TEST_ASSERT_TRUE_MESSAGE(recorder->end(made::end("stop"), error), error.c_str());

    const AllRows rows = read_scan(folder / "odd");
    TEST_ASSERT_EQUAL(1, rows.poses.size());
    assert_pose(*odd, rows.poses[0]);
}

static void test_header_and_end_come_back_as_they_were(void)
{
    const TemporaryFolder folder;
    record_scan(folder.path(), "one", 3);
    std::string error;
    const auto reader = ScanReader::open(folder / "one/scan.sqlite", error);
    TEST_ASSERT_TRUE_MESSAGE(reader != nullptr, error.c_str());
    TEST_ASSERT_FALSE(std::filesystem::exists(folder / "one/scan.sqlite-wal")); /* one file */
    TEST_ASSERT_FALSE(std::filesystem::exists(folder / "one/scan.lock"));
    const ScanSummary &found = reader->summary();
    const ScanHeader wanted = made::header("one");
    TEST_ASSERT_EQUAL_STRING((folder / "one").c_str(), found.folder.c_str());
    TEST_ASSERT_EQUAL_STRING(wanted.camera_file_text.c_str(),
                             found.header.camera_file_text.c_str());
    assert_bits(wanted.box_settings, found.header.box_settings);
    assert_bits(wanted.camera_profile, found.header.camera_profile);
    TEST_ASSERT_EQUAL_MEMORY(wanted.box_identity.unique_id, found.header.box_identity.unique_id, 8);
    TEST_ASSERT_EQUAL_STRING(wanted.box_identity.git_hash, found.header.box_identity.git_hash);
    TEST_ASSERT_EQUAL_UINT32(wanted.boot_id, found.header.boot_id);
    TEST_ASSERT_TRUE(wanted.bar_tilt_rad == found.header.bar_tilt_rad);
    TEST_ASSERT_TRUE(found.ended);
    TEST_ASSERT_FALSE(found.being_recorded);
    TEST_ASSERT_FALSE(found.recovered);
    TEST_ASSERT_EQUAL_STRING("stop", found.end.reason.c_str());
    assert_bits(made::end("stop").summary, found.end.summary);
    TEST_ASSERT_EQUAL_UINT64(43, found.end.source.delivered);
    TEST_ASSERT_EQUAL_UINT64(3, found.frames);
    TEST_ASSERT_EQUAL_UINT64(3, found.poses_with_time);
    TEST_ASSERT_EQUAL_UINT64(3, found.pictures);
    TEST_ASSERT_TRUE(std::abs(found.duration_s - 0.032) < 1e-12);
}

static void test_one_pose_is_found_by_its_number_and_a_missing_one_is_told(void)
{
    const TemporaryFolder folder;
    record_scan(folder.path(), "one", 8);
    std::string error;
    const auto reader = ScanReader::open(folder / "one", error);
    PoseRecord pose;
    TEST_ASSERT_TRUE_MESSAGE(reader->pose(5, pose, error), error.c_str());
    assert_pose(*made::pose(5, 9), pose);
    TEST_ASSERT_FALSE(reader->pose(9, pose, error));
    TEST_ASSERT_EQUAL_STRING("there is no pose of picture 9", error.c_str());
}

static void test_reading_ends_when_the_taker_has_enough(void)
{
    const TemporaryFolder folder;
    record_scan(folder.path(), "one", 8);
    std::string error;
    const auto reader = ScanReader::open(folder / "one", error);
    int taken = 0;
    TEST_ASSERT_TRUE(reader->each_frame([&](const FrameRecord &) { return ++taken < 3; }, error));
    TEST_ASSERT_EQUAL(3, taken);
}

static void test_without_edges_the_rest_of_a_pose_is_there(void)
{
    const TemporaryFolder folder;
    RecorderOptions options;
    options.edges = false;
    options.picture_every = 0;
    const auto recorder = begin_scan(folder.path(), "thin", options);
    hand_over(*recorder, 1, 2, 9);
    std::string error;
    TEST_ASSERT_TRUE_MESSAGE(recorder->end(made::end("stop"), error), error.c_str());
    const AllRows rows = read_scan(folder / "thin");
    TEST_ASSERT_EQUAL(0, rows.pictures.size());
    TEST_ASSERT_EQUAL(0, rows.poses[1].edges.size());
    assert_bits(made::pose(2, 9)->location, rows.poses[1].location);
    assert_list(made::pose(2, 9)->squares, rows.poses[1].squares);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_record_comes_back_as_it_was);
    RUN_TEST(test_minus_zero_infinity_and_not_a_number_stay_what_they_are);
    RUN_TEST(test_header_and_end_come_back_as_they_were);
    RUN_TEST(test_one_pose_is_found_by_its_number_and_a_missing_one_is_told);
    RUN_TEST(test_reading_ends_when_the_taker_has_enough);
    RUN_TEST(test_without_edges_the_rest_of_a_pose_is_there);
    return UNITY_END();
}
