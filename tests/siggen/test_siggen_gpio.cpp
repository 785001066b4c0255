/* SPDX-License-Identifier: Apache-2.0 */
/* libgpiod, unmodified, against a mocked chip; built once for each of its APIs. `opms siggen` runs
 * in this very process, because the mocked kernel hands out files of it. */
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <unity.h>

#include "commands.hpp"
#include "mock_gpio.hpp"

constexpr unsigned START = 2, STROBE = 3, TRIG = 4;

static UMockdevTestbed *testbed;
static MockGpio *gpio;

void setUp(void)
{
    testbed = umockdev_testbed_new();
    gpio = new MockGpio(testbed);
}

void tearDown(void)
{
    delete gpio;
    g_object_unref(testbed);
}

static std::int64_t now_ns(void)
{
    timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * 1000000000LL + t.tv_nsec;
}

struct Outcome {
    int exit_code = -1;
    std::string out;
    nlohmann::json json() const { return nlohmann::json::parse(out); }
};

/** Whatever was written to a file, from its beginning. */
static std::string contents(std::FILE *file)
{
    std::string text;
    std::rewind(file);
    for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file)) {
        text += static_cast<char>(c);
    }
    return text;
}

/** Run the command with its standard output in a file without a name: this program is built for
 * each API, and both may run at the same time in one folder. */
static Outcome siggen(std::vector<std::string> arguments)
{
    Outcome outcome;
    CLI::App app("test", "opms");
    add_cmd_siggen(app, outcome.exit_code);
    arguments.insert(arguments.begin(), "siggen");
    std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());

    std::fflush(stdout);
    const int own = dup(STDOUT_FILENO);
    std::FILE *const file = std::tmpfile();
    TEST_ASSERT_NOT_NULL_MESSAGE(file, "no temporary file");
    dup2(fileno(file), STDOUT_FILENO);
    app.parse(reversed);
    std::fflush(stdout);
    dup2(own, STDOUT_FILENO);
    close(own);
    outcome.out = contents(file);
    std::fclose(file);
    return outcome;
}

/** Answers START's first rising edge with a run of pulses, stamped as a real box would cause. */
struct PulseTrain {
    int pulses;
    std::int64_t period_ns;
    std::int64_t delay_ns = 1032;
    int missing = -1, dropped = -1; /**< pulse that the box, the kernel loses */
    bool sent = false;

    void operator()(unsigned line, int level)
    {
        if (line != START || level == 0 || sent) {
            return;
        }
        sent = true;
        const std::int64_t first_ns = now_ns() + delay_ns;
        for (int i = 0; i < pulses; ++i) {
            if (i == dropped) {
                gpio->drop_edge();
            } else if (i != missing) {
                gpio->send_edge(TRIG, first_ns + i * period_ns);
            }
        }
    }
};

static void test_the_lines_are_requested_as_they_are_used(void)
{
    siggen({"--start", "2", "--strobe", "3", "--trig", "4", "--period-ms", "5"});
    const auto &start = gpio->requests.at(START), &strobe = gpio->requests.at(STROBE);
    const auto &trig = gpio->requests.at(TRIG);
    TEST_ASSERT_TRUE(start.output && strobe.output && !trig.output);
    TEST_ASSERT_TRUE(trig.rising && !trig.falling);
    TEST_ASSERT_FALSE(start.active_low || strobe.active_low || trig.active_low);
    TEST_ASSERT_EQUAL_STRING("opms siggen", start.consumer.c_str());
    TEST_ASSERT_EQUAL_STRING("opms siggen", trig.consumer.c_str());
#if OPMS_TEST_GPIOD_API == 2
    TEST_ASSERT_GREATER_OR_EQUAL_UINT(1024, trig.kernel_edges);
#endif
    TEST_ASSERT_EQUAL(3, gpio->requests.size());
}

static void test_start_pulses_and_glitches_reach_the_wire_in_order(void)
{
    std::vector<int> levels;
    gpio->on_level = [&](unsigned line, int level) {
        TEST_ASSERT_EQUAL(START, line);
        levels.push_back(level);
    };
    const Outcome outcome = siggen({"--start", "2", "--count", "4", "--period-ms", "8",
                                    "--width-us", "900", "--glitch-us", "50", "--json"});
    TEST_ASSERT_EQUAL(0, outcome.exit_code);
    TEST_ASSERT_EQUAL(4, outcome.json()["start"]["pulses"].get<int>());
    TEST_ASSERT_EQUAL(4, outcome.json()["start"]["glitches"].get<int>());
    /* Low at first, then eight pulses. */
    TEST_ASSERT_EQUAL(1 + 2 * 8, levels.size());
    for (std::size_t i = 0; i < levels.size(); ++i) {
        TEST_ASSERT_EQUAL(i % 2, levels[i]);
    }
    TEST_ASSERT_TRUE(outcome.json()["start"]["late_us"]["min"].get<double>() >= 0);
}

static void test_no_start_pulse_comes_before_its_time(void)
{
    std::vector<std::int64_t> rises;
    gpio->on_level = [&](unsigned, int level) {
        if (level) {
            rises.push_back(now_ns());
        }
    };
    const std::int64_t began_ns = now_ns();
    siggen({"--start", "2", "--count", "3", "--period-ms", "10"});
    TEST_ASSERT_EQUAL(3, rises.size());
    for (std::size_t i = 0; i < rises.size(); ++i) {
        TEST_ASSERT_TRUE(rises[i] - began_ns >= static_cast<std::int64_t>(i) * 10000000);
    }
}

static void test_a_line_that_is_active_low_rests_high(void)
{
    std::vector<int> levels;
    gpio->on_level = [&](unsigned, int level) { levels.push_back(level); };
    siggen({"--start", "2", "--trig", "4", "--period-ms", "2", "--active-low", "start,trig"});
    TEST_ASSERT_EQUAL(3, levels.size());
    TEST_ASSERT_TRUE(levels[0] == 1 && levels[1] == 0 && levels[2] == 1);
    TEST_ASSERT_TRUE(gpio->requests.at(TRIG).active_low);
}

static void test_edges_are_counted_and_timed_by_the_kernels_stamps(void)
{
    gpio->on_level = PulseTrain{61, 1000000};
    const Outcome outcome = siggen({"--start", "2", "--trig", "4", "--period-ms", "60", "--json",
                                    "--expect-period-us", "1000", "--max-jitter-us", "0.001"});
    const nlohmann::json trig = outcome.json()["trig"];
    TEST_ASSERT_EQUAL_MESSAGE(0, outcome.exit_code, outcome.out.c_str());
    TEST_ASSERT_EQUAL_STRING("opms.siggen/1",
                             outcome.json()["schema"].get<std::string>().c_str());
    TEST_ASSERT_EQUAL(61, trig["edges"].get<int>());
    TEST_ASSERT_EQUAL(0, trig["before_start"].get<int>());
    TEST_ASSERT_EQUAL(60, trig["period_us"]["count"].get<int>());
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1000, trig["period_us"]["mean"].get<double>());
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, trig["period_us"]["sd"].get<double>());
    TEST_ASSERT_EQUAL(0, trig["missed"].get<int>() + trig["extra"].get<int>());
    /* START was driven after the program looked at its clock, and the box took 1.032 us. */
    TEST_ASSERT_TRUE(trig["first_edge_delay_us"].get<double>() >= 1.032);
    TEST_ASSERT_EQUAL_STRING("monotonic", trig["clock"].get<std::string>().c_str());
}

static void test_a_pulse_that_the_box_loses_is_missed(void)
{
    PulseTrain train{61, 1000000};
    train.missing = 30;
    gpio->on_level = train;
    const Outcome outcome =
        siggen({"--start", "2", "--trig", "4", "--period-ms", "60", "--json"});
    TEST_ASSERT_EQUAL(5, outcome.exit_code);
    TEST_ASSERT_EQUAL(60, outcome.json()["trig"]["edges"].get<int>());
    TEST_ASSERT_EQUAL(1, outcome.json()["trig"]["missed"].get<int>());
    TEST_ASSERT_TRUE(outcome.json()["lost"].get<bool>());
}

static void test_an_edge_that_the_kernel_loses_is_told_where_it_says_so(void)
{
    PulseTrain train{61, 1000000};
    train.dropped = 30;
    gpio->on_level = train;
    const nlohmann::json trig =
        siggen({"--start", "2", "--trig", "4", "--period-ms", "60", "--json"}).json()["trig"];
    TEST_ASSERT_EQUAL(1, trig["missed"].get<int>());
#if OPMS_TEST_GPIOD_API == 2
    TEST_ASSERT_EQUAL(1, trig["dropped_by_kernel"].get<int>());
#else
    TEST_ASSERT_TRUE(trig["dropped_by_kernel"].is_null());
#endif
}

static void test_another_period_and_no_edge_fail_with_their_codes(void)
{
    gpio->on_level = PulseTrain{61, 1005000};
    TEST_ASSERT_EQUAL(1, siggen({"--start", "2", "--trig", "4", "--period-ms", "60",
                                 "--expect-period-us", "1000"})
                             .exit_code);
    gpio->on_level = [](unsigned, int) {};
    TEST_ASSERT_EQUAL(5, siggen({"--start", "2", "--trig", "4", "--period-ms", "5"}).exit_code);
}

static void test_each_trig_is_answered_with_an_exposure(void)
{
    PulseTrain train{3, 15000000};
    int exposures = 0;
    gpio->on_level = [&](unsigned line, int level) {
        train(line, level);
        exposures += line == STROBE && level;
    };
    const Outcome outcome =
        siggen({"--start", "2", "--trig", "4", "--strobe", "3", "--period-ms", "400", "--json",
                "--strobe-delay-us", "200", "--strobe-width-us", "3000"});
    TEST_ASSERT_EQUAL(3, exposures);
    TEST_ASSERT_EQUAL(3, outcome.json()["strobe"]["pulses"].get<int>());
    TEST_ASSERT_EQUAL(0, gpio->levels.at(STROBE));
}

static void test_a_chip_or_line_that_is_not_there_is_no_device(void)
{
    TEST_ASSERT_EQUAL(3, siggen({"--chip", "gpiochip7", "--start", "2"}).exit_code);
    TEST_ASSERT_EQUAL(3, siggen({"--chip", "/dev/mockline1", "--start", "2"}).exit_code);
    TEST_ASSERT_EQUAL(3, siggen({"--start", "6"}).exit_code);
    TEST_ASSERT_EQUAL(3, siggen({"--start", "2", "--trig", "6"}).exit_code);
    gpio->busy_line = 4;
    TEST_ASSERT_EQUAL(3, siggen({"--start", "2", "--trig", "4"}).exit_code);
    TEST_ASSERT_EQUAL(0, siggen({"--chip", "0", "--start", "2", "--period-ms", "2"}).exit_code);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_lines_are_requested_as_they_are_used);
    RUN_TEST(test_start_pulses_and_glitches_reach_the_wire_in_order);
    RUN_TEST(test_no_start_pulse_comes_before_its_time);
    RUN_TEST(test_a_line_that_is_active_low_rests_high);
    RUN_TEST(test_edges_are_counted_and_timed_by_the_kernels_stamps);
    RUN_TEST(test_a_pulse_that_the_box_loses_is_missed);
    RUN_TEST(test_an_edge_that_the_kernel_loses_is_told_where_it_says_so);
    RUN_TEST(test_another_period_and_no_edge_fail_with_their_codes);
    RUN_TEST(test_each_trig_is_answered_with_an_exposure);
    RUN_TEST(test_a_chip_or_line_that_is_not_there_is_no_device);
    return UNITY_END();
}
