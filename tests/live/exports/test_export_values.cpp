/* SPDX-License-Identifier: Apache-2.0 */
/* Numbers and texts of the exports, by themselves. */
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <unity.h>

#include "base64_text.hpp"
#include "crc32_sum.hpp"
#include "csv_row.hpp"
#include "pose_track.hpp"
#include "scan_times.hpp"

using namespace opms_host;

extern "C" {
void setUp(void) {}
void tearDown(void) {}
}

namespace {

constexpr double RAD = 3.14159265358979323846 / 180;

/** About z. */
void turn(double angle_deg, double R[9])
{
    const double c = std::cos(angle_deg * RAD), s = std::sin(angle_deg * RAD);
    const double values[9] = {c, -s, 0, s, c, 0, 0, 0, 1};
    std::copy(values, values + 9, R);
}

PoseRecord pose_at(std::int64_t t_ns, double x_m, double angle_deg)
{
    PoseRecord pose;
    pose.has_time = true;
    pose.t_scan_ns = t_ns;
    pose.location.state = OPMS_BAR_LOCATED;
    pose.location.has_ground_detector = 1;
    pose.location.ground_detector.transform.t_m[0] = x_m;
    turn(angle_deg, pose.location.ground_detector.transform.R);
    return pose;
}

void test_fields_with_commas_quotes_and_line_ends_stand_in_quotes()
{
    const std::string line =
        CsvRow().text("plain").text("a,b").text("say \"so\"").text("two\nlines").text("").line();
    TEST_ASSERT_EQUAL_STRING("plain,\"a,b\",\"say \"\"so\"\"\",\"two\nlines\",\r\n", line.c_str());
}

void test_numbers_read_back_as_they_were_and_what_is_none_is_empty()
{
    const double third = 1.0 / 3, nan = std::numeric_limits<double>::quiet_NaN();
    const double infinite = std::numeric_limits<double>::infinity();
    TEST_ASSERT_TRUE(std::stod(CsvRow().number(third).line()) == third);
    TEST_ASSERT_EQUAL_STRING(",,0\r\n",
                             CsvRow().number(nan).number(infinite).number(0).line().c_str());
}

void test_seconds_keep_every_nanosecond_at_both_borders()
{
    TEST_ASSERT_EQUAL_STRING("-0.000000001\r\n", CsvRow().seconds(-1).line().c_str());
    TEST_ASSERT_EQUAL_STRING("1.000000000\r\n", CsvRow().seconds(1000000000).line().c_str());
    TEST_ASSERT_EQUAL_STRING(
        "-9223372036.854775808\r\n",
        CsvRow().seconds(std::numeric_limits<std::int64_t>::min()).line().c_str());
}

void test_the_crc_is_that_of_the_standards_check_word_in_any_pieces()
{
    Crc32Sum whole, pieces;
    whole.add("123456789", 9);
    pieces.add("1234", 4);
    pieces.add("56789", 5);
    TEST_ASSERT_EQUAL_HEX32(0xCBF43926, whole.value());
    TEST_ASSERT_EQUAL_HEX32(0xCBF43926, pieces.value());
}

void test_base64_is_that_of_the_standards_examples()
{
    const std::string words[] = {"", "f", "fo", "foo", "foob", "fooba", "foobar"};
    const char *texts[] = {"", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"};
    for (int i = 0; i < 7; i++) {
        TEST_ASSERT_EQUAL_STRING(texts[i], base64_text(words[i]).c_str());
    }
    TEST_ASSERT_EQUAL_STRING("/wD+", base64_text(std::string("\xff\x00\xfe", 3)).c_str());
}

void test_quaternions_give_back_the_matrix_for_half_turns_about_each_axis_too()
{
    const double signs[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    for (const auto &sign : signs) {
        double R[9], back[9];
        turn(1e-9, R);
        for (int i = 0; i < 9; i++) {
            R[i] *= sign[i % 3];
        }
        quaternion_to_matrix(quaternion_from_matrix(R), back);
        for (int i = 0; i < 9; i++) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-15, R[i], back[i]);
        }
    }
}

void test_the_angle_between_two_rotations_is_exact_down_to_a_billionth_of_a_degree()
{
    for (const double angle : {1e-9, 0.5, 90.0, 179.0}) {
        double a[9], b[9];
        turn(10, a);
        turn(10 + angle, b);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12 + 1e-12 * angle, angle, angle_between_deg(a, b));
    }
}

void test_between_two_poses_place_and_angle_move_evenly_across_the_half_turn()
{
    PoseTrack track;
    track.add(pose_at(1000, 1, 170));
    track.add(pose_at(0, 0, -170)); /* the later one was added first */
    TrackPose pose;
    TEST_ASSERT_TRUE(track.at(250, 1000, pose));
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.25, pose.t_m[0]);
    TEST_ASSERT_EQUAL(1000, pose.gap_ns);
    double R[9], expected[9];
    quaternion_to_matrix(pose.rotation, R);
    turn(-175, expected);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, angle_between_deg(R, expected));
}

void test_outside_the_poses_and_across_a_long_gap_there_is_none()
{
    PoseTrack track;
    TrackPose pose;
    TEST_ASSERT_FALSE(track.at(0, 1000, pose));
    track.add(pose_at(0, 0, 0));
    track.add(pose_at(1000, 1, 0));
    PoseRecord absent = pose_at(500, 9, 0);
    absent.location.state = OPMS_BAR_ABSENT;
    track.add(absent);
    PoseRecord untimed = pose_at(500, 9, 0);
    untimed.has_time = false;
    track.add(untimed);
    TEST_ASSERT_EQUAL(2, track.size());
    TEST_ASSERT_FALSE(track.at(-1, 1000, pose));
    TEST_ASSERT_FALSE(track.at(1001, 1000, pose));
    TEST_ASSERT_FALSE(track.at(500, 999, pose));
    TEST_ASSERT_TRUE(track.at(0, 0, pose));
    TEST_ASSERT_TRUE(track.at(1000, 0, pose));
    TEST_ASSERT_EQUAL(0, pose.gap_ns);
}

void test_times_of_the_day_count_from_the_beginning_and_never_fall_below_zero()
{
    ScanHeader header;
    header.begun_wall_ns = 1000000;
    header.begun_host_ns = 400000;
    const ScanTimes times(header);
    TEST_ASSERT_EQUAL_UINT64(1000001, times.wall_ns(static_cast<std::int64_t>(400001)));
    TEST_ASSERT_EQUAL_UINT64(0, times.wall_ns(static_cast<std::int64_t>(-700000)));
    TEST_ASSERT_EQUAL_STRING("2026-11-22T14:03:07Z",
                             wall_time_text(1795356187LL * 1000000000).c_str());
    TEST_ASSERT_EQUAL_STRING("1969-12-31T23:59:59Z", wall_time_text(-1).c_str());
}

}  // namespace

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_fields_with_commas_quotes_and_line_ends_stand_in_quotes);
    RUN_TEST(test_numbers_read_back_as_they_were_and_what_is_none_is_empty);
    RUN_TEST(test_seconds_keep_every_nanosecond_at_both_borders);
    RUN_TEST(test_the_crc_is_that_of_the_standards_check_word_in_any_pieces);
    RUN_TEST(test_base64_is_that_of_the_standards_examples);
    RUN_TEST(test_quaternions_give_back_the_matrix_for_half_turns_about_each_axis_too);
    RUN_TEST(test_the_angle_between_two_rotations_is_exact_down_to_a_billionth_of_a_degree);
    RUN_TEST(test_between_two_poses_place_and_angle_move_evenly_across_the_half_turn);
    RUN_TEST(test_outside_the_poses_and_across_a_long_gap_there_is_none);
    RUN_TEST(test_times_of_the_day_count_from_the_beginning_and_never_fall_below_zero);
    return UNITY_END();
}
