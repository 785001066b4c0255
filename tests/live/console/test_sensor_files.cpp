/* SPDX-License-Identifier: Apache-2.0 */
/* Samples of sensors from files, also such that are still written. */
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include <unity.h>

#include "fake_control.hpp"
#include "sensor_csv.hpp"
#include "sensor_feeder.hpp"

using namespace opms_host;

static const char FILE_NAME[] = "test_sensor_files.csv";

void setUp(void)
{
    std::remove(FILE_NAME);
}

void tearDown(void)
{
    std::remove(FILE_NAME);
}

static SensorCsv table(const char *names)
{
    SensorCsv csv("md");
    SensorSample sample;
    std::string error;
    TEST_ASSERT_TRUE_MESSAGE(csv.take(names, sample, error) == CsvLine::nothing, error.c_str());
    return csv;
}

static void test_a_table_gives_samples_with_time_number_and_values(void)
{
    SensorCsv csv = table(" t_scan_s , number,left,t_bound_s,right\r");
    SensorSample sample;
    std::string error;
    TEST_ASSERT_TRUE(csv.take("-0.25, 7, 1e3, 0.002, -2.5\r", sample, error) == CsvLine::sample);
    TEST_ASSERT_EQUAL_STRING("md", sample.record.sensor.c_str());
    TEST_ASSERT_EQUAL_INT64(-250'000'000, sample.record.t_scan_ns);
    TEST_ASSERT_EQUAL_INT64(2'000'000, sample.record.t_bound_ns);
    TEST_ASSERT_EQUAL_UINT64(7, sample.record.number);
    TEST_ASSERT_EQUAL_INT(2, static_cast<int>(sample.record.values.size()));
    TEST_ASSERT_EQUAL_DOUBLE(1000, sample.record.values[0]);
    TEST_ASSERT_EQUAL_DOUBLE(-2.5, sample.record.values[1]);
    TEST_ASSERT_EQUAL_STRING("right", csv.value_names()[1].c_str());
}

static void test_a_table_may_have_the_time_of_the_world(void)
{
    SensorCsv csv = table("t_unix_s,a,b");
    SensorSample sample;
    std::string error;
    TEST_ASSERT_TRUE(csv.take("1800000000.5,-1,2", sample, error) == CsvLine::sample);
    TEST_ASSERT_TRUE(sample.time == SampleTime::unix_utc);
    TEST_ASSERT_EQUAL_INT64(1'800'000'000'500'000'000, sample.t_unix_ns);
    TEST_ASSERT_EQUAL_DOUBLE(-1, sample.record.values[0]);
    for (const char *wrong : {",1,2", "1800000000.5,,2", "1800000000.5,1,inf", "-1,1,2"}) {
        TEST_ASSERT_TRUE_MESSAGE(csv.take(wrong, sample, error) == CsvLine::error, wrong);
    }
}

static void test_wrong_lines_are_told_by_number_and_the_next_is_taken(void)
{
    SensorCsv csv = table("t_scan_s,a");
    SensorSample sample;
    std::string error;
    for (const char *wrong : {"1", "1,2,3", "x,1", "1,x", "1e9,1", "nan,1", "1,1x", "0x1,1"}) {
        TEST_ASSERT_TRUE_MESSAGE(csv.take(wrong, sample, error) == CsvLine::error, wrong);
    }
    TEST_ASSERT_EQUAL_STRING("line 9: '0x1' is no t_scan_s", error.c_str());
    TEST_ASSERT_TRUE(csv.take("# a remark", sample, error) == CsvLine::nothing);
    TEST_ASSERT_TRUE(csv.take(" \t", sample, error) == CsvLine::nothing);
    TEST_ASSERT_TRUE(csv.take("1,2", sample, error) == CsvLine::sample);
    TEST_ASSERT_TRUE(csv.take(std::string(SENSOR_LINE_BYTES_MAX + 1, '1'), sample, error) ==
                     CsvLine::error);
}

static void test_a_first_line_must_name_one_time_and_values(void)
{
    for (const char *wrong : {"a,b", "t_scan_s", "t_scan_s,t_unix_s,a", "t_scan_s,a,a",
                              "t_scan_s,,a", "t_scan_s,t_scan_s,a", "0.1,2"}) {
        SensorCsv csv("md");
        SensorSample sample;
        std::string error;
        TEST_ASSERT_TRUE_MESSAGE(csv.take(wrong, sample, error) == CsvLine::error, wrong);
        TEST_ASSERT_TRUE(csv.take("t_scan_s,a", sample, error) == CsvLine::nothing);
    }
}

/** Collects what a feed hands over. */
struct Basket {
    std::vector<SensorRecord> records;
    SensorFeed::Take take = [this](const SensorRecord &record, std::string &) {
        records.push_back(record);
        return true;
    };
};

static void test_a_file_is_followed_while_it_grows_line_by_line(void)
{
    StillClock clock;
    Basket basket;
    std::ofstream file(FILE_NAME);
    file << "t_scan_s,a\n1,10\n2,2" << std::flush;
    SensorFeed feed("md", FILE_NAME, 0);
    TEST_ASSERT_EQUAL_UINT64(1, feed.poll(clock, 100, basket.take));
    TEST_ASSERT_EQUAL_UINT64(0, feed.poll(clock, 100, basket.take));
    file << "0\n3,30\n4,40\n" << std::flush;
    TEST_ASSERT_EQUAL_UINT64(2, feed.poll(clock, 2, basket.take));
    TEST_ASSERT_EQUAL_UINT64(1, feed.poll(clock, 2, basket.take));
    TEST_ASSERT_EQUAL_DOUBLE(20, basket.records[1].values[0]);
    TEST_ASSERT_EQUAL_STRING(R"({"columns":["a"]})", basket.records[0].data_json.c_str());
    TEST_ASSERT_EQUAL_STRING("", basket.records[1].data_json.c_str());
    TEST_ASSERT_EQUAL_STRING("", feed.problem().c_str());
}

static void test_samples_from_before_the_scan_are_passed_over(void)
{
    StillClock clock;
    Basket basket;
    std::ofstream(FILE_NAME) << "t_unix_s,a\n1799999998,1\n1799999999.5,2\n";
    SensorFeed feed("md", FILE_NAME, clock.wall_ns() - 1'000'000'000);
    TEST_ASSERT_EQUAL_UINT64(1, feed.poll(clock, 100, basket.take));
    TEST_ASSERT_EQUAL_UINT64(1, feed.too_old());
    TEST_ASSERT_EQUAL_INT64(4'500'000'000, basket.records[0].arrival_host_ns);
}

static void test_a_line_without_end_does_not_fill_the_memory(void)
{
    StillClock clock;
    Basket basket;
    std::ofstream file(FILE_NAME);
    file << "t_scan_s,a\n" << std::string(10 * SENSOR_LINE_BYTES_MAX, '1') << "\n5,50\n"
         << std::flush;
    SensorFeed feed("md", FILE_NAME, 0);
    TEST_ASSERT_EQUAL_UINT64(1, feed.poll(clock, 100, basket.take));
    TEST_ASSERT_EQUAL_UINT64(1, feed.refused());
    TEST_ASSERT_EQUAL_DOUBLE(50, basket.records[0].values[0]);
}

static void test_each_scan_reads_its_files_anew_and_troubles_are_told_once(void)
{
    StillClock clock;
    Basket basket;
    std::ofstream(FILE_NAME) << "t_scan_s,a\n1,10\n2,x\n";
    SensorFeeder feeder({{"md", FILE_NAME}, {"gpr", "no such file"}});
    TEST_ASSERT_TRUE(feeder.step("", clock, basket.take).empty());
    TEST_ASSERT_EQUAL_INT(2, static_cast<int>(feeder.step("one", clock, basket.take).size()));
    TEST_ASSERT_TRUE(feeder.step("one", clock, basket.take).empty());
    TEST_ASSERT_EQUAL_INT(1, static_cast<int>(basket.records.size()));
    TEST_ASSERT_EQUAL_INT(2, static_cast<int>(feeder.step("two", clock, basket.take).size()));
    TEST_ASSERT_EQUAL_INT(2, static_cast<int>(basket.records.size()));
}

static void test_an_option_is_a_name_and_a_file(void)
{
    std::string name, path;
    TEST_ASSERT_EQUAL_STRING("", sensor_option_problem("md=a=b.csv", name, path).c_str());
    TEST_ASSERT_EQUAL_STRING("md", name.c_str());
    TEST_ASSERT_EQUAL_STRING("a=b.csv", path.c_str());
    for (const char *wrong : {"", "md", "md=", "=a.csv", "a b=c.csv"}) {
        TEST_ASSERT_NOT_EQUAL(0, sensor_option_problem(wrong, name, path).size());
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_table_gives_samples_with_time_number_and_values);
    RUN_TEST(test_a_table_may_have_the_time_of_the_world);
    RUN_TEST(test_wrong_lines_are_told_by_number_and_the_next_is_taken);
    RUN_TEST(test_a_first_line_must_name_one_time_and_values);
    RUN_TEST(test_a_file_is_followed_while_it_grows_line_by_line);
    RUN_TEST(test_samples_from_before_the_scan_are_passed_over);
    RUN_TEST(test_a_line_without_end_does_not_fill_the_memory);
    RUN_TEST(test_each_scan_reads_its_files_anew_and_troubles_are_told_once);
    RUN_TEST(test_an_option_is_a_name_and_a_file);
    return UNITY_END();
}
